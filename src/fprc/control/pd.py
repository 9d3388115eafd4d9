"""Proportional-differential feedback of the bending angle."""


class PD:
    """P_fb = kp e + kd de/dt, with e = theta_d - theta (Sec. III-A).

    The derivative is the backward difference over one period; it is zero at
    the first sample.

    Parameters
    ----------
    kp_kpa_per_deg, kd_kpa_s_per_deg : float
        Gains, paper Sec. IV.
    period_s : float
        Time between two calls.
    """

    def __init__(self, kp_kpa_per_deg: float, kd_kpa_s_per_deg: float, period_s: float):
        self.kp_kpa_per_deg = kp_kpa_per_deg
        self.kd_kpa_s_per_deg = kd_kpa_s_per_deg
        self.period_s = period_s
        self._last: float | None = None

    def step(self, theta_d_deg: float, theta_deg: float) -> float:
        """Return P_fb for this sample, kPa."""
        error = theta_d_deg - theta_deg
        rate = 0.0 if self._last is None else (error - self._last) / self.period_s
        self._last = error
        return self.kp_kpa_per_deg * error + self.kd_kpa_s_per_deg * rate
