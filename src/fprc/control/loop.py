"""The sampled loop: wait, read, decide, write, remember."""

from collections.abc import Callable

import numpy as np

from fprc.control.pressure import PressurePI
from fprc.devices import Device, Readings
from fprc.devices.protocol import Clock
from fprc.logs import RAW_CHANNELS

Law = Callable[[int, Readings], tuple[float, float]]


def run(
    device: Device,
    clock: Clock,
    law: Law,
    samples: int,
    *,
    main_loop: PressurePI,
    reservoir_loop: PressurePI,
    progress: Callable[[int], None] = lambda k: None,
) -> dict[str, np.ndarray]:
    """Run ``law`` for a number of samples and return what happened.

    ``law(k, readings)`` gives the set-points of both chambers in kPa; the two
    PI loops turn them into valve voltages. The device is made safe at the end,
    whatever ends the run.

    Returns
    -------
    dict of ndarray
        One array of length ``samples`` for each of ``fprc.logs.RAW_CHANNELS``; row k holds
        the readings at tick k and what was commanded and written upon them.
    """
    rows = np.empty((samples, len(RAW_CHANNELS)))
    period_s = main_loop.period_s
    try:
        for k in range(samples):
            clock.wait_until(k * period_s)
            now = device.read()
            p_exp, p_i = law(k, now)
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
                main_v,
                reservoir_v,
            )
            progress(k + 1)
    finally:
        device.safe()
    return dict(zip(RAW_CHANNELS, rows.T.copy(), strict=True))
