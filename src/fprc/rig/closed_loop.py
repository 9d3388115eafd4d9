"""The simulated rig under its controllers, many ticks in one call.

The controllers are those of ``fprc.control``, which runs tick by tick and so can drive a real rig.
Compiled together with the rig, a run takes a tenth of the time.
"""

import math

import numpy as np

from fprc.compiled import kernel
from fprc.rig.simulator import advance

#: Columns of ``setpoints``: feedforward pressure, reference angle (NaN: no feedback), pressure
#: of PAM A (NaN: it follows the measured angle), push on the reservoir.
SETPOINTS = ("p_ff_kpa", "theta_d_deg", "p_i_kpa", "push_kpa")

#: Number of columns of ``rows``: time, then command and reading of P_exp, theta, command and
#: reading of P_i, P_o, phi, both valves' voltages, theta_d, P_ff and P_fb.
RECORDED = 13


@kernel
def close_loop(
    states, rigs, instruments, controllers, setpoints, noise, period_s, substeps, tick, valve_v,
    reading, rows,
):  # fmt: skip
    """Run both pressure loops, and the PD feedback if there is one, for ``len(rows)`` samples.

    The first sample is ``reading`` as given; the rig advances before each of the others.

    Parameters
    ----------
    controllers : record of shape (1,)
        ``main``, ``reservoir`` (``kp_v_per_kpa``, ``ki_v_per_kpa_s``); ``feedback``
        (``kp_kpa_per_deg``, ``kd_kpa_s_per_deg``); ``k_in_kpa_per_deg``; ``p_i_limits_kpa``,
        ``p_exp_limits_kpa`` (lowest, highest); ``neutral_v``, ``limit_v``.
    setpoints : ndarray of shape (n_samples, 4)
        See ``SETPOINTS``.
    noise : ndarray of shape (n_samples - 1, NOISE_PER_TICK)
    tick : int
        Number of the first sample.
    valve_v, reading : ndarrays
        As in ``advance``; changed in place.
    rows : ndarray of shape (n_samples, RECORDED)
        Filled, in the order of ``RECORDED``.

    Returns
    -------
    tuple of int
        0 or a key of ``DIVERGED``, and the sample at which it occurred.
    """
    control, sensor = controllers[0], rigs[0].pressure_sensor
    kpa_per_v = sensor.full_scale_kpa / sensor.span_v
    integral = np.zeros(2)
    last_error = math.nan
    for k in range(len(rows)):
        p_ff, theta_d, p_i = setpoints[k, 0], setpoints[k, 1], setpoints[k, 2]
        if k > 0:
            failed = advance(
                states, rigs, instruments, valve_v, setpoints[k, 3], noise[k - 1], period_s,
                substeps, reading,
            )  # fmt: skip
            if failed:
                return failed, k
        p_main = (reading[0] - sensor.zero_v) * kpa_per_v
        p_active = (reading[1] - sensor.zero_v) * kpa_per_v
        theta = reading[3]
        if math.isnan(p_i):
            p_i = _within(control.k_in_kpa_per_deg * theta, control.p_i_limits_kpa)
        p_fb = 0.0
        if not math.isnan(theta_d):
            error = theta_d - theta
            rate = 0.0 if math.isnan(last_error) else (error - last_error) / period_s
            last_error = error
            feedback = control.feedback
            p_fb = feedback.kp_kpa_per_deg * error + feedback.kd_kpa_s_per_deg * rate
        p_exp = _within(p_ff + p_fb, control.p_exp_limits_kpa)
        valve_v[0] = _pressure_loop(control, control.main, integral, 0, p_exp - p_main, period_s)
        valve_v[1] = _pressure_loop(
            control, control.reservoir, integral, 1, p_i - p_active, period_s
        )
        row = rows[k]
        row[0] = (tick + k) * period_s
        row[1], row[2], row[3] = p_exp, p_main, theta
        row[4], row[5], row[6] = p_i, p_active, (reading[2] - sensor.zero_v) * kpa_per_v
        row[7], row[8], row[9] = reading[4], valve_v[0], valve_v[1]
        row[10], row[11], row[12] = theta_d, p_ff, p_fb
    return 0, len(rows)


@kernel
def _within(value, limits):
    return min(max(value, limits[0]), limits[1])


@kernel
def _pressure_loop(control, gains, integral, chamber, error, period_s):
    """Return the valve's voltage; see ``fprc.control.PressurePI``."""
    summed = integral[chamber] + error * period_s
    volts = control.neutral_v + gains.kp_v_per_kpa * error + gains.ki_v_per_kpa_s * summed
    if volts < 0.0:
        return 0.0
    if volts > control.limit_v:
        return control.limit_v
    integral[chamber] = summed
    return volts
