"""Run experiments on the simulated rig and write their raw logs."""

import logging
from collections.abc import Mapping, Sequence
from typing import Any

from fprc.config.section import Section
from fprc.config.settings import Control, Signal
from fprc.config.tracking import Tracking
from fprc.experiments.hysteresis import acquire
from fprc.experiments.tracking import Track, describe_model, tracking_rmse
from fprc.logs import write_raw
from fprc.models import load_model
from fprc.registry import feedforward_of, outside_classes

log = logging.getLogger(__name__)


def record(
    raw: str,
    *,
    experiment: str,
    signal: Signal,
    control: Control,
    rig: Mapping[str, Any],
    seed: int,
) -> None:
    """Record one hysteresis experiment (Sec. II-B)."""
    channels = acquire(experiment, signal, control, rig, seed)
    write_raw(
        raw, channels, experiment=experiment, source="sim", seed=seed,
        sample_rate_hz=control.sample_rate_hz,
        rig={"rig": rig, "control": _given(control), "signal": _given(signal)},
    )  # fmt: skip
    log.info("simulated %d samples, wrote %s", len(channels["time_s"]), raw)


def _given(section: Section) -> dict[str, Any]:
    return section.model_dump(mode="json", exclude_unset=True)


def track(
    models: Sequence[str],
    raw: Sequence[str],
    *,
    references: Sequence[str],
    names: Sequence[str],
    controllers: Sequence[str],
    tracking: Tracking,
    control: Control,
    rig: Mapping[str, Any],
    seed: int,
    classes: Mapping[str, Any] | None = None,
) -> None:
    """Follow every reference with every controller (Sec. IV), and write one raw log per run.

    ``raw`` are the logs of the first reference for each controller, then of the second, and so on;
    ``classes`` is the section ``models`` of the configuration, for models from outside.

    Raises
    ------
    ControlError
        A reference is impossible, or a model gives no finite P_ff.
    """
    files = dict(zip(names, models, strict=True))
    outside = outside_classes(classes or {})
    fitted = {name: load_model(path, outside) for name, path in files.items()}
    bench, runs = Track(tracking, control, rig, seed), iter(raw)
    for reference in references:
        for controller, channels in bench.follow(reference, controllers, fitted).items():
            described = bench.describe(reference, controller)
            described |= {"source": "sim", "rig": {"rig": rig, **described["rig"]}}
            if feedforward := feedforward_of(controller):
                described |= describe_model(fitted[feedforward], files[feedforward])
            write_raw(next(runs), channels, **described)
            rmse_deg = tracking_rmse(channels, described["settle_s"])
            log.info("%s, %s: RMSE %.3f deg", reference, controller, rmse_deg)
