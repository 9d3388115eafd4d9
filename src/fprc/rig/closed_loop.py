"""The simulated rig under its controllers, many ticks in one call.

The steps of ``fprc.control_laws``, compiled together with the rig: a run takes a tenth of the time
of ``fprc.control.run``, which runs the same steps tick by tick and so can drive a real rig.
"""

import math

import numpy as np

from fprc import control_laws
from fprc.compiled import kernel
from fprc.rig.simulator import advance

_clamp = kernel(control_laws.clamp)
_pressure_step = kernel(control_laws.pressure_step)
_pd_step = kernel(control_laws.pd_step)
_learn_step = kernel(control_laws.learn_step)


@kernel
def close_loop(
    states, rigs, instruments, settings, setpoints, regressors, learned, covariance, prior,
    noise, period_s, substeps, tick, valve_v, reading, rows,
):  # fmt: skip
    """Run both pressure loops, and the PD feedback if there is one, for ``len(rows)`` samples.

    The first sample is ``reading`` as given; the rig advances before each of the others. Return 0
    or a key of ``DIVERGED``, and the sample at which it occurred.

    ``settings`` are a record of the controllers: ``main``, ``reservoir``, ``feedback``,
    ``learning`` (see ``fprc.models.Online``), ``k_in_kpa_per_deg``, ``p_i_limits_kpa`` and
    ``p_exp_limits_kpa``. ``setpoints`` has, for each sample, feedforward pressure, reference angle
    (NaN: none), pressure of PAM A (NaN: it follows the measured angle), and push on the reservoir;
    ``regressors``, those of the model's readout, without columns if nothing is learned. ``learned``
    and ``covariance`` are changed in place, see ``fprc.control_laws.learn_step``; ``rows``, of
    ``SAMPLE``, are filled. ``tick`` is the number of the first sample. The others are those of
    ``advance``.
    """
    control = settings[0]
    low, high = control.p_exp_limits_kpa
    feedback, main, reservoir = control.feedback, control.main, control.reservoir
    summed_main = summed_reservoir = p_fb = 0.0
    last_error = math.nan
    size, learning = regressors.shape[1], control.learning
    gains, delay = np.empty(size), int(learning.delay_samples)
    for k in range(len(rows)):
        p_ff, theta_d, p_i = setpoints[k, 0], setpoints[k, 1], setpoints[k, 2]
        if k > 0:
            failed = advance(
                states, rigs, instruments, valve_v, setpoints[k, 3], noise[k - 1], period_s,
                substeps, reading,
            )  # fmt: skip
            if failed:
                return failed, k
        now = reading[0]
        p_main, p_active, theta = now.p_exp_kpa, now.p_i_kpa, now.theta_deg
        if math.isnan(p_i):
            lowest, highest = control.p_i_limits_kpa
            p_i = _clamp(control.k_in_kpa_per_deg * theta, lowest, highest)
        p_learned = 0.0
        if size and k >= delay:
            then = k - delay
            _learn_step(
                learned, covariance, prior, regressors[then], setpoints[then, 0],
                theta_d - theta, theta, rows[then].p_ff_kpa, rows[then].p_fb_kpa, high,
                learning.kpa_per_deg, learning.stop_deg, learning.limit_kpa, learning.mixing,
                gains,
            )  # fmt: skip
        squared = 0.0
        for i in range(size):
            p_learned += learned[i] * regressors[k, i]
            squared += learned[i] * learned[i]
        p_learned = _clamp(p_learned, -learning.limit_kpa, learning.limit_kpa)
        p_ff += p_learned
        if feedback.acts:
            error = theta_d - theta
            last_error = error if math.isnan(last_error) else last_error
            p_fb = _pd_step(
                error, last_error, p_fb, p_ff, feedback.incremental != 0.0,
                feedback.kp_kpa_per_deg, feedback.kd_kpa_s_per_deg, period_s, low, high,
            )  # fmt: skip
            last_error = error
        p_exp = _clamp(p_ff + p_fb, low, high)
        valve_v[0], summed_main = _pressure_step(
            p_exp - p_main, summed_main, main.kp_v_per_kpa, main.ki_v_per_kpa_s, period_s,
            control_laws.NEUTRAL_V,
        )  # fmt: skip
        valve_v[1], summed_reservoir = _pressure_step(
            p_i - p_active, summed_reservoir, reservoir.kp_v_per_kpa, reservoir.ki_v_per_kpa_s,
            period_s, control_laws.NEUTRAL_V,
        )  # fmt: skip
        rows[k] = now
        row = rows[k]
        row.time_s = (tick + k) * period_s
        row.p_exp_command_kpa, row.p_i_command_kpa = p_exp, p_i
        row.valve_main_v, row.valve_reservoir_v = valve_v[0], valve_v[1]
        row.theta_d_deg, row.p_ff_kpa, row.p_fb_kpa = theta_d, p_ff, p_fb
        row.p_learned_kpa, row.learned_norm = p_learned, math.sqrt(squared)
    return 0, len(rows)
