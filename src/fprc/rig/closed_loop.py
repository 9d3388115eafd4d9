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
    """Run both pressure loops, and the PD feedback if it acts, for ``len(rows)`` samples.

    The first sample is ``reading`` as given; the rig advances before each of the others. Return 0
    or a key of ``DIVERGED``, and the sample at which it occurred.

    ``settings`` are a record of the section ``control``, with ``p_exp_limits_kpa``, whether the PD
    ``acts`` and is ``incremental``, and ``learning`` (see ``fprc.models.Online``). ``setpoints``
    has, for each sample, feedforward pressure, reference angle (NaN: none, and the pressure of PAM
    A follows the measured angle), and push on the reservoir. ``regressors`` of the readout have no
    columns if nothing is learned; else ``learned`` and ``covariance`` change in place, see
    ``learn_step``. ``rows``, of ``SAMPLE``, are filled, the first of number ``tick``. The other
    arguments are those of ``advance``.
    """
    control = settings[0]
    low, high = control.p_exp_limits_kpa
    main, reservoir, learning = control.main_loop, control.reservoir_loop, control.learning
    summed_main = summed_reservoir = p_fb = 0.0
    memory = np.array([math.nan, 0.0])
    size, delay = regressors.shape[1], int(learning.delay_samples)
    gains = np.empty(size)
    for k in range(len(rows)):
        p_ff, theta_d = setpoints[k, 0], setpoints[k, 1]
        if k > 0:
            failed = advance(
                states, rigs, instruments, valve_v, setpoints[k, 2], noise[k - 1], period_s,
                substeps, reading,
            )  # fmt: skip
            if failed:
                return failed, k
        now = reading[0]
        theta = now.theta_deg
        p_i = control.k_in_kpa_per_deg * theta_d
        if math.isnan(theta_d):
            p_i = _clamp(control.k_in_kpa_per_deg * theta, 0.0, control.reservoir_limit_kpa)
        p_learned = squared = 0.0
        if size and k >= delay:
            then = k - delay
            _learn_step(
                learned, covariance, prior, regressors[then], setpoints[then, 0],
                theta_d - theta, theta, rows[then].p_ff_kpa, rows[then].p_fb_kpa, high,
                learning.kpa_per_deg, learning.stop_deg, learning.limit_kpa, learning.mixing,
                gains,
            )  # fmt: skip
        for i in range(size):
            p_learned += learned[i] * regressors[k, i]
            squared += learned[i] * learned[i]
        p_learned = _clamp(p_learned, -learning.limit_kpa, learning.limit_kpa)
        p_ff += p_learned
        if control.acts:
            p_fb = _pd_step(
                memory, theta_d - theta, theta, p_ff, control.incremental != 0.0,
                control.pd.kp_kpa_per_deg, control.pd.kd_kpa_s_per_deg, period_s, low, high,
            )  # fmt: skip
        p_exp = _clamp(p_ff + p_fb, low, high)
        valve_v[0], summed_main = _pressure_step(
            p_exp - now.p_exp_kpa, summed_main, main.kp_v_per_kpa, main.ki_v_per_kpa_s, period_s,
            control_laws.NEUTRAL_V,
        )  # fmt: skip
        valve_v[1], summed_reservoir = _pressure_step(
            p_i - now.p_i_kpa, summed_reservoir, reservoir.kp_v_per_kpa, reservoir.ki_v_per_kpa_s,
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
