"""PI loop that sets a valve's voltage to control a chamber's pressure."""

import math
from dataclasses import KW_ONLY, dataclass, field

from fprc.control_laws import NEUTRAL_V, pressure_step


@dataclass(eq=False, repr=False)
class PressurePI:
    """V = V_neutral + kp e + ki integral(e), clamped to the board's 0-10 V.

    The integral is frozen while the output is clamped.

    Parameters
    ----------
    kp_v_per_kpa, ki_v_per_kpa_s : float
        Gains, paper Sec. IV.
    period_s : float
        Time between two calls.
    neutral_v : float
        Voltage that closes the valve.
    """

    kp_v_per_kpa: float
    ki_v_per_kpa_s: float
    period_s: float
    _: KW_ONLY
    neutral_v: float = NEUTRAL_V
    integral_kpa_s: float = field(default=0.0, init=False)

    def step(self, setpoint_kpa: float, measured_kpa: float) -> float:
        """Return the valve voltage for this sample.

        Raises
        ------
        ValueError
            Setpoint or reading is not finite; the integral is unchanged.
        """
        error = setpoint_kpa - measured_kpa
        if not math.isfinite(error):
            raise ValueError(
                f"setpoint {setpoint_kpa} kPa and reading {measured_kpa} kPa must be finite"
            )
        volts, self.integral_kpa_s = pressure_step(
            error,
            self.integral_kpa_s,
            self.kp_v_per_kpa,
            self.ki_v_per_kpa_s,
            self.period_s,
            self.neutral_v,
        )
        return volts
