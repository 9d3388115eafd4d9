"""The hysteresis experiments on the simulated rig (Sec. II-B)."""

import logging
from collections.abc import Mapping
from typing import Any

import numpy as np

from fprc.control import PressurePI, hysteresis_law, run
from fprc.devices import SimulatedRig
from fprc.experiments.data import TARGETS, Data
from fprc.experiments.settings import RigSettings
from fprc.signals import pressure_command

log = logging.getLogger(__name__)

#: Run number of each experiment; with the seed it sets the noise of the run.
RUNS = {"sweep": 0, "complex": 1}


def simulate(settings: RigSettings, seed: int) -> dict[str, Data]:
    """Return both hysteresis experiments as preprocessed logs."""
    data = {}
    for experiment, signal in settings.signals.items():
        channels = acquire(experiment, signal, settings.control, settings.rig, seed)
        channels["p_target_kpa"] = channels[TARGETS[settings.target]]
        attributes = {
            "experiment": experiment,
            "source": "sim",
            "target": settings.target,
            "seed": seed,
        }
        data[experiment] = Data(channels, attributes)
    return data


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
