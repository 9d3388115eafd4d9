"""One step of each controller, in plain Python that also compiles.

The loop that drives a real rig runs these functions as they are; ``fprc.rig.closed_loop``
compiles them together with the simulated rig. They import nothing, so that a loop starts fast.
"""


def pressure_step(
    error_kpa: float,
    integral_kpa_s: float,
    kp: float,
    ki: float,
    period_s: float,
    neutral_v: float,
    limit_v: float,
) -> tuple[float, float]:
    """Return the voltage of a valve, and the integral of its pressure error.

    V = V_neutral + kp e + ki integral(e), from 0 to ``limit_v``; at either end the integral stays
    as it is (Sec. IV, gains in V/kPa and V/(kPa s)).
    """
    summed = integral_kpa_s + error_kpa * period_s
    volts = neutral_v + kp * error_kpa + ki * summed
    if volts < 0.0:
        return 0.0, integral_kpa_s
    if volts > limit_v:
        return limit_v, integral_kpa_s
    return volts, summed


def pd_step(
    error_deg: float,
    last_deg: float,
    p_fb_kpa: float,
    p_ff_kpa: float,
    incremental: bool,
    kp: float,
    kd: float,
    period_s: float,
    low: float,
    high: float,
) -> float:
    """Return P_fb of a sample, kPa; see ``fprc.control.PD``.

    Parameters
    ----------
    error_deg, last_deg : float
        theta_d - theta of this sample and of the one before; at the first sample, equal.
    p_fb_kpa : float
        P_fb of the sample before; 0 at the first.
    p_ff_kpa : float
        P_ff of this sample.
    incremental : bool
        Whether P_fb is a sum or, as in a positional PD controller, depends on this error alone.
    low, high : float
        Limits of P_d = P_ff + P_fb, kPa.
    """
    rate = (error_deg - last_deg) / period_s
    if not incremental:
        return kp * error_deg + kd * rate
    p_fb = p_fb_kpa + kd * rate + kp * error_deg
    # beyond a limit, kp e would wind up the sum: it counts only if it leads back
    if error_deg > 0.0 and p_ff_kpa + p_fb > high or error_deg < 0.0 and p_ff_kpa + p_fb < low:
        return p_fb_kpa + kd * rate
    return p_fb
