"""Run a hysteresis experiment on the simulated rig and write its raw log."""

import logging
from collections.abc import Mapping
from typing import Any

from fprc.config.settings import Control, Signal
from fprc.experiments.hysteresis import acquire
from fprc.logs import write_raw

log = logging.getLogger(__name__)


def record(
    raw: str,
    *,
    experiment: str,
    signal: Mapping[str, Any],
    control: Mapping[str, Any],
    rig: Mapping[str, Any],
    seed: int,
) -> None:
    """Record one hysteresis experiment (Sec. II-B) on the simulated rig."""
    channels = acquire(experiment, Signal(**signal), Control(**control), rig, seed)
    write_raw(
        raw,
        channels,
        experiment=experiment,
        source="sim",
        sample_rate_hz=control["sample_rate_hz"],
        seed=seed,
        rig={"rig": rig, "control": control, "signal": signal},
    )
    log.info("simulated %d samples, wrote %s", len(channels["time_s"]), raw)
