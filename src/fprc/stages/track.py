"""Closed-loop runs of Sec. IV."""

import logging
from collections.abc import Mapping, Sequence
from typing import Any

from fprc.experiments.tracking import Track, describe_model, tracking_rmse
from fprc.logs import write_raw
from fprc.models import load_model
from fprc.registry import feedforward_of, outside_classes

log = logging.getLogger(__name__)


def track(
    models: Sequence[str],
    raw: Sequence[str],
    *,
    reference: str,
    names: Sequence[str],
    controllers: Sequence[str],
    tracking: Mapping[str, Any],
    control: Mapping[str, Any],
    rig: Mapping[str, Any],
    seed: int,
    classes: Mapping[str, Any] | None = None,
) -> None:
    """Follow one reference with every controller, and write one raw log per controller.

    Parameters
    ----------
    models, names : sequences of str
        Files of the feedforward models, and their names.
    classes : Mapping, optional
        The section ``models`` of the configuration, for models from outside this package.

    Raises
    ------
    ControlError
        The reference is impossible, or a model gives no finite P_ff.
    """
    bench = Track(tracking, control, rig, seed)
    files = dict(zip(names, models, strict=True))
    outside = outside_classes(classes or {})
    fitted = {name: load_model(path, outside) for name, path in files.items()}
    for path, (controller, channels) in zip(
        raw, bench.follow(reference, controllers, fitted).items(), strict=True
    ):
        described = bench.describe(reference, controller)
        described |= {"source": "sim", "rig": {"rig": rig, **described["rig"]}}
        if feedforward := feedforward_of(controller):
            described |= describe_model(fitted[feedforward], files[feedforward])
        write_raw(path, channels, **described)
        log.info("%s: RMSE %.3f deg", controller, tracking_rmse(channels, described["settle_s"]))
