"""A simulated reservoir for a recording that has none: P_i follows the recorded theta."""

from collections.abc import Mapping
from typing import Any

import numpy as np

from fprc.channels import RESERVOIR
from fprc.control import pressure_loops, run
from fprc.devices.sim import SimulatedRig
from fprc.errors import LogError

#: Time for which the reservoir settles at the first angle before the recording begins, s.
_BEFORE_S = 5.0

#: Largest share of commands that may lie outside 0 to the limit by more than a margin. The margin
#: is a fraction of the limit and allows for the noise of the angle at rest.
_OUTSIDE, _MARGIN = 0.01, 0.02

#: Channels of the simulated reservoir.
CHANNELS = ("p_i_command_kpa", *RESERVOIR)


def commands_of(
    theta_deg: np.ndarray, zero_deg: float, control: Mapping[str, Any], raw: str
) -> np.ndarray:
    """Return P_i = K_in (theta - zero), kPa, clipped between 0 and the reservoir's limit.

    Raises
    ------
    LogError
        More than a hundredth of the samples are clearly outside these limits.
    """
    commands = control["k_in_kpa_per_deg"] * (theta_deg - zero_deg)
    limit = control["reservoir_limit_kpa"]
    outside = float(np.mean(np.abs(commands - 0.5 * limit) > (0.5 + _MARGIN) * limit))
    if outside > _OUTSIDE:
        raise LogError(
            f"{raw}: P_i = K_in (theta - reservoir_zero_deg) goes from "
            f"{commands.min():.0f} to {commands.max():.0f} kPa, and {100.0 * outside:.0f} % is "
            f"outside 0 to {limit:g} kPa; set evaluation.reservoir_zero_deg to the lowest theta, "
            f"{theta_deg.min():.4g}, and lower control.k_in_kpa_per_deg if that is not enough"
        )
    return np.clip(commands, 0.0, limit)


def drive(
    p_i_kpa: np.ndarray,
    sample_rate_hz: float,
    control: Mapping[str, Any],
    rig: Mapping[str, Any],
    seed: int,
    number: int,
) -> dict[str, np.ndarray]:
    """Return the channels of the simulated reservoir for these commands.

    The actuator stays vented; it does not affect the reservoir.

    Parameters
    ----------
    number : int
        Number of the run, which sets the noise together with the seed.
    """
    before = round(_BEFORE_S * sample_rate_hz)
    commands = np.concatenate([np.full(before, p_i_kpa[0]), p_i_kpa]).tolist()
    device = SimulatedRig(rig, seed=seed, run=number, sample_rate_hz=sample_rate_hz)
    channels = run(
        device,
        device,
        lambda k, now: (0.0, commands[k]),
        len(commands),
        **pressure_loops({**control, "sample_rate_hz": sample_rate_hz}),
    )
    return {name: channels[name][before:] for name in CHANNELS}
