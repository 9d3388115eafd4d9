"""The sampled control loop: wait, read, compute, write, record."""

import math
from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING

import numpy as np

from fprc.channels import NEEDED_SENSORS, RAW_CHANNELS, Readings
from fprc.control_laws import NEUTRAL_V, clamp, pressure_step
from fprc.devices import Clock, Device
from fprc.errors import ControlError, FprcError

if TYPE_CHECKING:
    from fprc.config.settings import Control

#: Returns the setpoints P_exp and P_i of sample k in kPa, then any further values to record.
Law = Callable[[int, Readings], Sequence[float]]

#: Readings that every run needs; the others are only recorded.
_NEEDED = ("time_s", *NEEDED_SENSORS)


class RunAbortedError(ControlError):
    """A run ended early; ``channels`` holds the samples recorded until then."""

    def __init__(self, message: str, channels: dict[str, np.ndarray]):
        super().__init__(message)
        self.channels = channels


def run(
    device: Device,
    clock: Clock,
    law: Law,
    samples: int,
    control: "Control",
    *,
    neutral_v: float = NEUTRAL_V,
    extra: tuple[str, ...] = (),
    keep: Callable[[int, Sequence[float]], None] = lambda k, row: None,
    stop: Callable[[], str] = lambda: "",
) -> dict[str, np.ndarray]:
    """Run ``law`` for a number of samples and return the recorded channels.

    ``law(k, readings)`` returns the setpoints of both chambers in kPa; the two
    PI loops convert them to valve voltages. The device is made safe at the end,
    however the run ends.

    Parameters
    ----------
    control : Control
        Sample rate, and gains of the PI loops.
    neutral_v : float
        Voltage that closes a valve.
    extra : tuple of str
        Names of the values that the law returns after the two setpoints.
    keep : callable
        Called with each tick and its row as soon as the row is complete.
    stop : callable
        Called at every tick; returns a reason to stop, or an empty text.

    Returns
    -------
    dict of ndarray
        One array for each of ``fprc.channels.RAW_CHANNELS`` and of ``extra``: readings at a tick,
        and what was computed from them; fewer than ``samples`` if the clock missed ticks.

    Raises
    ------
    RunAbortedError
        The law, the device or a loop failed, a stop was requested, or the rig
        could not be made safe; holds the rows recorded until then.
    """
    names = (*RAW_CHANNELS, *extra)
    rows = np.empty((samples, len(names)))
    done = k = 0
    period_s = 1.0 / control.sample_rate_hz
    loops = (control.main_loop, control.reservoir_loop)
    gains = [(loop.kp_v_per_kpa, loop.ki_v_per_kpa_s) for loop in loops]
    integrals: Sequence[float] = (0.0, 0.0)
    ended, problem, cause = "run finished", "", None
    try:
        while k < samples and (k := clock.wait_for(k)) < samples:
            if reason := stop():
                raise ControlError(reason)
            now = device.read()
            if gone := [name for name in _NEEDED if not math.isfinite(getattr(now, name))]:
                raise ControlError(f"no reading of {', '.join(gone)}; check the sensor")
            p_exp, p_i, *more = law(k, now)
            errors = p_exp - now.p_exp_kpa, p_i - now.p_i_kpa
            if not all(map(math.isfinite, errors)):
                raise ControlError(
                    f"the control law gave P_exp = {p_exp}, P_i = {p_i} kPa; both must be finite"
                )
            steps = [
                pressure_step(error, integral, *of_loop, period_s, neutral_v)
                for error, integral, of_loop in zip(errors, integrals, gains, strict=True)
            ]
            (main_v, reservoir_v), integrals = zip(*steps, strict=True)
            device.write(main_v, reservoir_v)
            sample = now._asdict() | {
                "p_exp_command_kpa": p_exp,
                "p_i_command_kpa": p_i,
                "valve_main_v": main_v,
                "valve_reservoir_v": reservoir_v,
            }
            rows[done] = row = (*(sample[name] for name in RAW_CHANNELS), *more)
            done += 1
            keep(k, row)
            k += 1
    except Exception as error:
        what = error if isinstance(error, FprcError) else f"{type(error).__name__}: {error}"
        ended, problem, cause = f"run stopped at sample {k}", f": {what}", error
    except BaseException:
        device.safe()
        raise
    try:
        device.safe()
    except Exception as error:
        problem += f"\nthe rig could not be made safe: {error}"
    recorded = dict(zip(names, rows[:done].T.copy(), strict=True))
    if problem:
        raise RunAbortedError(ended + problem, recorded) from cause
    return recorded


def hysteresis_law(p_exp_kpa: np.ndarray, control: "Control") -> Law:
    """Return the law with setpoints P_exp(k) and P_i(k) = K_in theta(k).

    P_i is Eq. (1), clamped between 0 and the reservoir's limit (Sec. II-B). ``p_exp_kpa`` has one
    number per sample.
    """
    commands = np.asarray(p_exp_kpa, dtype=float).tolist()
    k_in_kpa_per_deg, limit_kpa = control.k_in_kpa_per_deg, control.reservoir_limit_kpa

    def law(k: int, now: Readings) -> tuple[float, float]:
        return commands[k], clamp(k_in_kpa_per_deg * now.theta_deg, 0.0, limit_kpa)

    return law
