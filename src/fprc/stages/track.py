"""Closed-loop runs of Sec. IV."""

import logging
from collections.abc import Mapping, Sequence
from typing import Any

from fprc.experiments.tracking import Track, describe_model, tracking_rmse
from fprc.logs import write_raw
from fprc.models import load_model
from fprc.paper import DISTURBANCE
from fprc.registry import feedforward_of, outside_classes

log = logging.getLogger(__name__)


def track(
    models: Sequence[str],
    raw: Sequence[str],
    *,
    references: Sequence[str],
    names: Sequence[str],
    controllers: Sequence[str],
    tracking: Mapping[str, Any],
    control: Mapping[str, Any],
    rig: Mapping[str, Any],
    seed: int,
    classes: Mapping[str, Any] | None = None,
) -> None:
    """Follow every reference with every controller, and write one raw log per run.

    Parameters
    ----------
    models, names : sequences of str
        Files of the feedforward models, and their names.
    raw : sequence of str
        Logs to write: those of the first reference for each controller, then of the second, ...
    classes : Mapping, optional
        The section ``models`` of the configuration, for models from outside this package.

    Raises
    ------
    ControlError
        A reference is impossible, or a model gives no finite P_ff.
    """
    files = dict(zip(names, models, strict=True))
    outside = outside_classes(classes or {})
    fitted = {name: load_model(path, outside) for name, path in files.items()}
    runs = iter(raw)
    for reference in references:
        # a log keeps the settings of its own reference; only the disturbed one has pushes
        names_of = ("angle_range_deg", "pressure_limit_kpa", "pushes")
        own = {name: tracking[name] for name in names_of[: 2 + (reference == DISTURBANCE)]}
        own["references"] = {reference: tracking["references"][reference]}
        bench = Track(own, control, rig, seed)
        for controller, channels in bench.follow(reference, controllers, fitted).items():
            described = bench.describe(reference, controller)
            described |= {"source": "sim", "rig": {"rig": rig, **described["rig"]}}
            if feedforward := feedforward_of(controller):
                described |= describe_model(fitted[feedforward], files[feedforward])
            write_raw(next(runs), channels, **described)
            rmse_deg = tracking_rmse(channels, described["settle_s"])
            log.info("%s, %s: RMSE %.3f deg", reference, controller, rmse_deg)
