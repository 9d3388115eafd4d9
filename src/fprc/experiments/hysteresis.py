"""Run an experiment on the rig and keep its raw log."""

import logging
from collections.abc import Mapping
from typing import Any

import numpy as np

from fprc import __version__
from fprc.control import PressurePI, hysteresis_law, run
from fprc.devices import SimulatedRig
from fprc.logs import write_raw
from fprc.signals import pressure_command

log = logging.getLogger(__name__)

#: Number of each experiment; with the seed it decides the noise of the run.
RUNS = {"sweep": 0, "complex": 1}


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
    channels = acquire(experiment, signal, control, rig, seed, report=True)
    write_raw(
        raw,
        channels,
        experiment=experiment,
        source="sim",
        sample_rate_hz=control["sample_rate_hz"],
        seed=seed,
        software=f"fprc {__version__}",
        rig={"rig": rig, "control": control, "signal": signal},
    )
    log.info("simulated %d samples, wrote %s", len(channels["time_s"]), raw)


def acquire(
    experiment: str,
    signal: Mapping[str, Any],
    control: Mapping[str, Any],
    rig: Mapping[str, Any],
    seed: int,
    *,
    report: bool = False,
) -> dict[str, np.ndarray]:
    """Return the channels of one hysteresis experiment on the simulated rig.

    Raises
    ------
    SimulationError
        The simulation diverges.
    """
    rate_hz = control["sample_rate_hz"]
    device = SimulatedRig(rig, seed=seed, run=RUNS[experiment], sample_rate_hz=rate_hz)
    p_exp_kpa = pressure_command(signal, rate_hz)
    law = hysteresis_law(p_exp_kpa, control["k_in_kpa_per_deg"], control["reservoir_limit_kpa"])
    tenth = max(len(p_exp_kpa) // 10, 1)

    def progress(done: int) -> None:
        if report and done % tenth == 0:
            log.info("%3.0f of %3.0f s", done / rate_hz, len(p_exp_kpa) / rate_hz)

    return run(
        device,
        device,
        law,
        len(p_exp_kpa),
        main_loop=PressurePI(**control["main_loop"], period_s=1.0 / rate_hz),
        reservoir_loop=PressurePI(**control["reservoir_loop"], period_s=1.0 / rate_hz),
        progress=progress,
    )
