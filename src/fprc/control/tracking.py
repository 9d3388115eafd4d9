"""Control law of the tracking experiments: feedforward, feedback, or both (Sec. IV)."""

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from fprc.channels import Readings
from fprc.control.loop import Law
from fprc.control.pd import PD
from fprc.control_laws import clamp
from fprc.errors import ControlError

if TYPE_CHECKING:  # the real rig's loop starts sooner without scikit-learn
    from fprc.config.settings import Control
    from fprc.models import Online, SequenceModel


def tracking_law(
    theta_d_deg: np.ndarray,
    control: "Control",
    pressure_limit_kpa: float,
    *,
    model: "SequenceModel | None" = None,
    online: "Online | None" = None,
    feedback: bool = False,
) -> Law:
    """Return the law P_d = P_ff + P_fb with P_i = K_in theta_d.

    Parameters
    ----------
    theta_d_deg : ndarray of shape (n_samples,)
        Reference; see ``refuse_impossible``.
    control : Control
        K_in, gains of the feedback, shift of P_o.
    pressure_limit_kpa : float
        Highest P_d; the lowest is 0.
    model : SequenceModel, optional
        Gives P_ff from theta_d, or from theta_d and P_o; by default P_ff = 0.
    online : Online, optional
        Gives P_ff instead of ``model``, and learns in the run; the law then returns what it has
        learned too, as the channels of kind ``learning``.
    feedback : bool, default=False
        Whether a PD controller gives P_fb, within the same limits of P_d; else P_fb = 0.

    Raises
    ------
    ControlError
        Neither feedforward nor feedback is given. The law raises it if an output is not finite.
    """
    source = online or model
    if source is None and not feedback:
        raise ControlError("a control law needs feedforward, feedback, or both; both are missing")
    references = np.asarray(theta_d_deg, dtype=float).tolist()
    pd = PD(control, pressure_limit_kpa) if feedback else None
    k_in_kpa_per_deg = control.k_in_kpa_per_deg
    p_o_shift_kpa = control.feedforward.p_o_shift_kpa
    reads_p_o = source is not None and source.n_features_in_ > 1

    def law(k: int, now: Readings) -> Sequence[float]:
        theta_d = references[k]
        if online is not None:
            online.learn(theta_d - now.theta_deg, now.theta_deg)
        inputs = (theta_d, now.p_o_kpa + p_o_shift_kpa) if reads_p_o else (theta_d,)
        p_ff = 0.0 if source is None else source.step(inputs)
        p_fb = 0.0 if pd is None else pd.step(theta_d, now.theta_deg, p_ff)
        if not math.isfinite(p_ff + p_fb):
            raise ControlError(
                f"the controller gave P_ff = {p_ff}, P_fb = {p_fb} kPa at theta_d = "
                f"{theta_d:.2f} deg; both must be finite, check model and gains"
            )
        p_d = clamp(p_ff + p_fb, 0.0, pressure_limit_kpa)
        if online is None:
            return p_d, k_in_kpa_per_deg * theta_d, theta_d, p_ff, p_fb
        online.sent(p_fb)
        learned = online.p_learned_kpa, float(np.linalg.norm(online.learned))
        return p_d, k_in_kpa_per_deg * theta_d, theta_d, p_ff, p_fb, *learned

    return law


def refuse_impossible(
    theta_d_deg: np.ndarray, control: "Control", angle_range_deg: tuple[float, float]
) -> None:
    """Raise ControlError before the rig moves if a reference cannot be followed.

    It names the first time and value at which the reference leaves the actuator's range, or
    P_i = K_in theta_d exceeds its limit.
    """
    (low, high), limit_kpa = angle_range_deg, control.reservoir_limit_kpa
    p_i_kpa = control.k_in_kpa_per_deg * theta_d_deg
    problems = [
        f"{name} = {values[k]:.2f} {unit} at t = {k / control.sample_rate_hz:.3f} s {why}"
        for name, unit, values, wrong, why in (
            ("theta_d", "deg", theta_d_deg, ~((theta_d_deg >= low) & (theta_d_deg <= high)),
             f"leaves the actuator's range of {low:g} to {high:g} deg; reduce amplitude or offset"),
            ("P_i", "kPa", p_i_kpa, p_i_kpa > limit_kpa,
             f"exceeds the reservoir's limit of {limit_kpa:g} kPa; reduce theta_d or K_in"),
        )
        if wrong[k := int(wrong.argmax())]
    ]  # fmt: skip
    if problems:
        raise ControlError("\n".join(problems))
