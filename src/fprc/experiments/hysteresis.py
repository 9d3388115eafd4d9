"""The hysteresis experiments on the simulated rig (Sec. II-B)."""

from collections.abc import Mapping
from typing import Any, Literal

import numpy as np

from fprc.channels import TARGETS
from fprc.config.section import Section
from fprc.config.settings import Control, Signal
from fprc.devices.sim import SimulatedRig
from fprc.experiments.data import Data
from fprc.signals import pressure_command

#: Run number of each experiment; with the seed it sets the noise of the run.
RUNS = {"sweep": 0, "complex": 1}


class RigSettings(Section):
    """Settings for the simulation of the hysteresis experiments."""

    rig: dict[str, Any]  #: section of the configuration, or a rig of a search
    control: Control
    signals: dict[str, Signal]  #: pressure signal of each experiment
    target: Literal["command", "measured"]  #: P_exp that the models learn


def simulate(settings: RigSettings, seed: int) -> dict[str, Data]:
    """Return both hysteresis experiments as preprocessed logs."""
    data = {}
    for experiment, signal in settings.signals.items():
        channels = acquire(experiment, signal, settings.control, settings.rig, seed)
        channels["p_target_kpa"] = channels[TARGETS[settings.target]]
        attributes = {"experiment": experiment, "source": "sim", "target": settings.target}
        data[experiment] = Data(channels, {**attributes, "seed": seed})
    return data


def acquire(
    experiment: str, signal: Signal, control: Control, rig: Mapping[str, Any], seed: int
) -> dict[str, np.ndarray]:
    """Return the channels of one hysteresis experiment on the simulated rig."""
    rate_hz = control.sample_rate_hz
    device = SimulatedRig(rig, seed=seed, run=RUNS[experiment], sample_rate_hz=rate_hz)
    return device.follow(control, pressure_command(signal, rate_hz))
