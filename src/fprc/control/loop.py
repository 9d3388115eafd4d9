"""The sampled loop: wait, read, decide, write, remember."""

import math
from collections.abc import Callable, Sequence

import numpy as np

from fprc.control.pressure import PressurePI
from fprc.devices import Clock, Device, Readings
from fprc.errors import ControlError, FprcError
from fprc.logs import RAW_CHANNELS

#: Gives P_exp and P_i of sample k in kPa, then whatever else is to be remembered.
Law = Callable[[int, Readings], Sequence[float]]


class RunAbortedError(ControlError):
    """A run ended early; ``channels`` holds what was recorded before."""

    def __init__(self, message: str, channels: dict[str, np.ndarray]):
        super().__init__(message)
        self.channels = channels


def run(
    device: Device,
    clock: Clock,
    law: Law,
    samples: int,
    *,
    main_loop: PressurePI,
    reservoir_loop: PressurePI,
    extra: tuple[str, ...] = (),
    progress: Callable[[int], None] = lambda k: None,
    keep: Callable[[int, Sequence[float]], None] = lambda k, row: None,
    stop: Callable[[], str] = lambda: "",
) -> dict[str, np.ndarray]:
    """Run ``law`` for a number of samples and return what happened.

    ``law(k, readings)`` gives the set-points of both chambers in kPa; the two
    PI loops turn them into valve voltages. The device is made safe at the end,
    whatever ends the run.

    Parameters
    ----------
    extra : tuple of str
        Names of what the law gives beyond the two set-points.
    progress : callable
        Told how many samples' time has passed.
    keep : callable
        Given each tick and its row as soon as the row is complete.
    stop : callable
        Asked at every tick for a reason to stop; none if it is empty.

    Returns
    -------
    dict of ndarray
        One array for each of ``fprc.logs.RAW_CHANNELS`` and of ``extra``; a row
        holds the readings at a tick and what was commanded and written upon
        them. There are ``samples`` rows unless the clock missed ticks.

    Raises
    ------
    RunAbortedError
        The law, the device or the loops failed, a stop was asked for, or the
        rig could not be made safe; holds the rows before.
    """
    names = (*RAW_CHANNELS, *extra)
    rows = np.empty((samples, len(names)))
    done = k = 0

    def recorded() -> dict[str, np.ndarray]:
        return dict(zip(names, rows[:done].T.copy(), strict=True))

    try:
        while k < samples and (k := clock.wait_for(k)) < samples:
            if reason := stop():
                raise ControlError(reason)
            now = device.read()
            _refuse_gaps(now)
            p_exp, p_i, *more = law(k, now)
            main_v = main_loop.step(p_exp, now.p_exp_kpa)
            reservoir_v = reservoir_loop.step(p_i, now.p_i_kpa)
            device.write(main_v, reservoir_v)
            rows[done] = row = (
                now.time_s,
                p_exp,
                now.p_exp_kpa,
                now.theta_deg,
                p_i,
                now.p_i_kpa,
                now.p_o_kpa,
                now.phi_deg,
                main_v,
                reservoir_v,
                *more,
            )
            done += 1
            keep(k, row)
            k += 1
            progress(k)
    except Exception as error:
        unsafe = _make_safe(device)
        what = error if isinstance(error, FprcError) else f"{type(error).__name__}: {error}"
        raise RunAbortedError(f"run stopped at sample {k}: {what}{unsafe}", recorded()) from error
    except BaseException:
        device.safe()
        raise
    if unsafe := _make_safe(device):
        raise RunAbortedError(f"run finished{unsafe}", recorded())
    return recorded()


def _make_safe(device: Device) -> str:
    """Make safe at once, whatever else is to be told; say what stood against it."""
    try:
        device.safe()
    except Exception as error:
        return f"\nthe rig could not be made safe: {error}"
    return ""


def _refuse_gaps(now: Readings) -> None:
    # the reservoir's angle is for the record alone, and not every rig measures it
    if not math.isfinite(sum(now[:-1])):
        gone = [name for name, value in now._asdict().items() if not math.isfinite(value)]
        raise ControlError(f"no reading of {', '.join(gone)}; check the sensor")
