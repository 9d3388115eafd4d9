"""Feedback of the bending angle: the paper's PD controller."""

import math
from typing import TYPE_CHECKING

from fprc.control_laws import FARTHEST_DEG, pd_step

if TYPE_CHECKING:
    from fprc.config.settings import Control


class PD:
    """P_fb from e = theta_d - theta, by the authors' incremental law or by a positional one.

    The paper says P_d = P_ff + P_fb with a PD controller (Sec. III-A, gains in Sec. IV), and not
    which form it has. The public code of the authors' next paper on the same actuator
    (arXiv 2503.15819) computes each command from the last one, at 200 Hz:

        u(k) = u(k-1) + u_ff(k) - u_ff(k-1) + kp e(k) + kd (e(k) - e(k-1)) / T

    Hence P_d = P_ff + P_fb, where P_fb is the sum of kp e + kd de/dt over the samples. It acts as
    a PI controller with an integral gain of kp / T and a proportional gain of kd / T: at the
    printed gains, 100 kPa/(deg s) and 1 kPa/deg. A positional controller has
    P_fb(k) = kp e(k) + kd (e(k) - e(k-1)) / T instead.

    Where P_d would be below its lowest or above its highest value, kp e does not add to the sum
    unless it leads back, so that the sum does not wind up; the authors' code has no limits. The
    derivative is zero at the first sample.

    An angle beyond ``FARTHEST_DEG`` is a fault of the sensor and changes nothing: as the first one
    of a run it would leave the sum at a limit for good.

    Parameters
    ----------
    control : Control
        The gains ``pd`` (paper, Sec. IV), the law ``feedback``, and the sample rate, 1 / T.
    highest_kpa : float, default=inf
        Highest P_d; the lowest is 0.
    """

    def __init__(self, control: "Control", highest_kpa: float = math.inf):
        self._incremental = control.feedback == "incremental"
        gains = control.pd.kp_kpa_per_deg, control.pd.kd_kpa_s_per_deg
        self._settings = *gains, 1.0 / control.sample_rate_hz, 0.0, highest_kpa
        self._last: float | None = None
        self._p_fb_kpa = 0.0

    def step(self, theta_d_deg: float, theta_deg: float, p_ff_kpa: float = 0.0) -> float:
        """Return P_fb for this sample, kPa."""
        if abs(theta_deg) > FARTHEST_DEG:
            return self._p_fb_kpa
        error = theta_d_deg - theta_deg
        last = error if self._last is None else self._last
        self._last = error
        self._p_fb_kpa = pd_step(
            error, last, self._p_fb_kpa, p_ff_kpa, self._incremental, *self._settings
        )
        return self._p_fb_kpa
