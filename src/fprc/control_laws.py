"""One step of each controller, in plain Python that also compiles.

The loop that drives a real rig runs these functions as they are; ``fprc.rig.closed_loop``
compiles them together with the simulated rig. They import nothing that takes time, so that a loop
starts fast.
"""

import math
from typing import Any

#: Voltage that closes a proportional valve, V.
NEUTRAL_V = 5.0
#: Highest voltage of a valve, V; the lowest is 0.
HIGHEST_V = 10.0

#: Largest angle that can be true, deg; largest error that teaches, deg; and fastest bending, deg/s,
#: ten times that of the paper's sweep. What is beyond is a fault of the sensor or, with an error, a
#: step of the reference: nothing is learned from it.
FARTHEST_DEG, LARGEST_ERROR_DEG, FASTEST_DEG_S = 360.0, 45.0, 1000.0


def clamp(value: float, low: float, high: float) -> float:
    """Return a pressure within its limits: P_i and P_d = P_ff + P_fb, and what was learned."""
    return min(max(value, low), high)


def pressure_step(
    error_kpa: float, integral_kpa_s: float, kp: float, ki: float, period_s: float, neutral_v: float
) -> tuple[float, float]:
    """Return the voltage of a valve, and the integral of its pressure error.

    V = V_neutral + kp e + ki integral(e), from 0 to ``HIGHEST_V``; at either end the integral stays
    as it is (Sec. IV, gains in V/kPa and V/(kPa s)).
    """
    summed = integral_kpa_s + error_kpa * period_s
    volts = neutral_v + kp * error_kpa + ki * summed
    if volts < 0.0:
        return 0.0, integral_kpa_s
    if volts > HIGHEST_V:
        return HIGHEST_V, integral_kpa_s
    return volts, summed


def believe(belief: Any, theta_deg: float, fastest_deg: float) -> bool:
    """Return whether an angle can be true: in range, and no faster than the actuator can be.

    ``belief``, changed in place, are the last angle that could be true, NaN before the first, and
    the samples since then: readings that stay away from it for long are believed. ``fastest_deg``
    is the most that the angle changes in a sample.
    """
    belief[1] += 1.0
    if not abs(theta_deg) <= FARTHEST_DEG:
        return False
    if abs(theta_deg - belief[0]) > fastest_deg * belief[1]:
        return False
    belief[0], belief[1] = theta_deg, 0.0
    return True


def learn_step(
    weights: Any,
    covariance: Any,
    prior: Any,
    regressors: Any,
    base_kpa: float,
    error_deg: float,
    theta_deg: float,
    p_ff_kpa: float,
    p_fb_kpa: float,
    high: float,
    kpa_per_deg: float,
    stop_deg: float,
    limit_kpa: float,
    mixing: float,
    gains: Any,
) -> None:
    """Make one step of recursive least squares, in place; see ``fprc.models.Online``.

    ``weights``, added to the trained ones, are what was learned. ``covariance`` and ``prior`` are
    symmetric: after the update the covariance moves towards the prior by the share ``mixing``, so
    that it and the gains stay below it. Regressors, ``base_kpa`` (P_ff as trained), ``p_ff_kpa``
    and ``p_fb_kpa`` are of the sample some time ago which this sample's angle follows from; error
    and angle are of this one. ``gains`` is overwritten.

    Nothing is learned where the actuator is at its stop, up to ``stop_deg``: there its angle does
    not depend on the pressure. A command that was at a limit, 0 or ``high``, and a learned part
    that has reached its own, ``limit_kpa``, are only led back: the command, also from the stop, by
    an error of more than ``stop_deg``. A degree needs ``kpa_per_deg``.
    """
    if not abs(error_deg) <= LARGEST_ERROR_DEG:
        return
    p_d = p_ff_kpa + p_fb_kpa
    if p_d <= 0.0:
        teaches = error_deg > stop_deg
    elif p_d >= high:
        teaches = error_deg < -stop_deg
    else:
        teaches = theta_deg > stop_deg
    if not teaches:
        return
    size = len(weights)
    given = 0.0
    for i in range(size):
        given += weights[i] * regressors[i]
    innovation = p_ff_kpa + kpa_per_deg * error_deg - base_kpa - given
    if not (abs(given) < limit_kpa or given * innovation < 0.0):
        return
    for i in range(size):
        gains[i] = 0.0
    for j in range(size):  # columns outside: the inner loop needs no sum, and is vectorised
        for i in range(size):
            gains[i] += covariance[j, i] * regressors[j]
    scale = 1.0
    for i in range(size):
        scale += regressors[i] * gains[i]
    inverse = 1.0 / scale
    for i in range(size):
        weights[i] += gains[i] * inverse * innovation
    for j in range(size):
        for i in range(size):
            updated = covariance[j, i] - gains[j] * gains[i] * inverse
            covariance[j, i] = updated + mixing * (prior[j, i] - updated)


def pd_step(
    memory: Any,
    error_deg: float,
    theta_deg: float,
    p_ff_kpa: float,
    incremental: bool,
    kp: float,
    kd: float,
    period_s: float,
    low: float,
    high: float,
) -> float:
    """Return P_fb of a sample, kPa, by the authors' incremental law or by a positional one.

    The paper does not say which form its PD controller has. The public code of the authors' next
    paper on the same actuator (arXiv 2503.15819) computes each command from the last one:

        u(k) = u(k-1) + u_ff(k) - u_ff(k-1) + kp e(k) + kd (e(k) - e(k-1)) / T

    Hence P_fb is the sum of kp e + kd de/dt over the samples: a PI controller with an integral gain
    of kp / T and a proportional gain of kd / T, at the printed gains (Sec. IV) 100 kPa/(deg s) and
    1 kPa/deg. A positional controller has P_fb(k) = kp e(k) + kd (e(k) - e(k-1)) / T instead.

    Where P_d = P_ff + P_fb would be below ``low`` or above ``high``, kp e does not add to the sum
    unless it leads back, so that the sum does not wind up; the authors' code has no limits. An
    angle beyond ``FARTHEST_DEG`` is a fault of the sensor and changes nothing: as the first one of
    a run it would leave the sum at a limit for good. ``fprc.control.tracking_law`` takes this step
    at each sample.

    Parameters
    ----------
    memory : list or ndarray of two floats
        e and P_fb of the sample before, changed in place. Begin with ``[math.nan, 0.0]``: at the
        first sample the derivative is zero.
    error_deg, theta_deg, p_ff_kpa : float
        e = theta_d - theta, theta and P_ff of this sample.
    incremental : bool
        Whether the law is the incremental one.
    kp, kd, period_s : float
        Gains in kPa/deg and kPa s/deg, and T, the time between samples.
    low, high : float
        Limits of P_d, kPa; only the incremental law needs them.
    """
    if abs(theta_deg) > FARTHEST_DEG:
        return memory[1]
    rate = 0.0 if math.isnan(memory[0]) else (error_deg - memory[0]) / period_s
    p_fb = kp * error_deg + kd * rate
    if incremental:
        p_fb = memory[1] + kd * rate + kp * error_deg
        p_d = p_ff_kpa + p_fb
        # beyond a limit, kp e would wind up the sum: it is added only if it reduces the excess
        if error_deg > 0.0 and p_d > high or error_deg < 0.0 and p_d < low:
            p_fb = memory[1] + kd * rate
    memory[0], memory[1] = error_deg, p_fb
    return p_fb
