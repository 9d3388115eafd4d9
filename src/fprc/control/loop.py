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
) -> dict[str, np.ndarray]:
    """Run ``law`` for a number of samples and return what happened.

    ``law(k, readings)`` gives the set-points of both chambers in kPa; the two
    PI loops turn them into valve voltages. The device is made safe at the end,
    whatever ends the run.

    Parameters
    ----------
    extra : tuple of str
        Names of what the law gives beyond the two set-points.

    Returns
    -------
    dict of ndarray
        One array of length ``samples`` for each of ``fprc.logs.RAW_CHANNELS``
        and of ``extra``; row k holds the readings at tick k and what was
        commanded and written upon them.

    Raises
    ------
    RunAbortedError
        The law, the device or the loops failed; holds the rows before.
    """
    names = (*RAW_CHANNELS, *extra)
    rows = np.empty((samples, len(names)))
    period_s = main_loop.period_s
    k = 0
    try:
        for k in range(samples):
            clock.wait_until(k * period_s)
            now = device.read()
            if not math.isfinite(sum(now)):
                gone = [name for name, value in now._asdict().items() if not math.isfinite(value)]
                raise ControlError(f"no reading of {', '.join(gone)}; check the sensor")
            p_exp, p_i, *more = law(k, now)
            main_v = main_loop.step(p_exp, now.p_exp_kpa)
            reservoir_v = reservoir_loop.step(p_i, now.p_i_kpa)
            device.write(main_v, reservoir_v)
            rows[k] = (
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
            progress(k + 1)
    except Exception as error:
        recorded = dict(zip(names, rows[:k].T.copy(), strict=True))
        what = error if isinstance(error, FprcError) else f"{type(error).__name__}: {error}"
        raise RunAbortedError(f"run stopped at sample {k}: {what}", recorded) from error
    finally:
        device.safe()
    return dict(zip(names, rows.T.copy(), strict=True))
