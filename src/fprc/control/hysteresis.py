"""Control law of the hysteresis experiments: prescribed P_exp; P_i follows theta."""

import numpy as np

from fprc.channels import Readings
from fprc.control.loop import Law


def hysteresis_law(
    p_exp_kpa: np.ndarray, k_in_kpa_per_deg: float, reservoir_limit_kpa: float
) -> Law:
    """Return the law with setpoints P_exp(k) and P_i(k) = K_in theta(k).

    P_i is clamped between 0 and the reservoir's limit (Sec. II-B, Eq. 1). ``p_exp_kpa`` has one
    number per sample.
    """
    commands = np.asarray(p_exp_kpa, dtype=float).tolist()

    def law(k: int, now: Readings) -> tuple[float, float]:
        p_i = min(max(k_in_kpa_per_deg * now.theta_deg, 0.0), reservoir_limit_kpa)
        return commands[k], p_i

    return law
