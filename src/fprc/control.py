"""Controllers, and the sampled control loop: wait, read, compute, write, record."""

import math
from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING

import numpy as np

from fprc.channels import NEEDED_SENSORS, RAW_CHANNELS, Readings
from fprc.control_laws import NEUTRAL_V, clamp, pd_step, pressure_step
from fprc.devices import Clock, Device
from fprc.errors import ControlError, FprcError

if TYPE_CHECKING:  # the real rig's loop starts sooner without scikit-learn
    from fprc.config.settings import Control
    from fprc.models import Online, SequenceModel

#: Returns the setpoints P_exp and P_i of sample k in kPa, then any further values to record.
Law = Callable[[int, Readings], Sequence[float]]


class RunAbortedError(ControlError):
    """A run ended early; ``channels`` holds the samples recorded until then."""

    def __init__(self, message: str, channels: dict[str, np.ndarray]):
        super().__init__(message)
        self.channels = channels


def run(
    device: Device,
    clock: Clock,
    law: Law,
    samples: int,
    control: "Control",
    *,
    neutral_v: float = NEUTRAL_V,
    extra: tuple[str, ...] = (),
    keep: Callable[[int, Sequence[float]], None] = lambda k, row: None,
    stop: Callable[[], str] = lambda: "",
) -> dict[str, np.ndarray]:
    """Run ``law`` for a number of samples and return the recorded channels.

    ``law(k, readings)`` returns the setpoints of both chambers in kPa; the two PI loops convert
    them to valve voltages. The device is made safe at the end, however the run ends.

    Parameters
    ----------
    control : Control
        Sample rate, and gains of the PI loops.
    neutral_v : float
        Voltage that closes a valve.
    extra : tuple of str
        Names of the values that the law returns after the two setpoints.
    keep, stop : callable
        Called with each tick and its row as soon as the row is complete; called at every tick,
        and returns a reason to stop, or an empty text.

    Returns
    -------
    dict of ndarray
        One array for each of ``fprc.channels.RAW_CHANNELS`` and of ``extra``: readings at a tick,
        and what was computed from them; fewer than ``samples`` if the clock missed ticks.

    Raises
    ------
    RunAbortedError
        The law, the device or a loop failed, a stop was requested, or the rig could not be made
        safe; holds the rows recorded until then.
    """
    names = (*RAW_CHANNELS, *extra)
    rows = np.empty((samples, len(names)))
    done = k = 0
    period_s = 1.0 / control.sample_rate_hz
    loops, integrals = (control.main_loop, control.reservoir_loop), [0.0, 0.0]
    ended, problem, cause = "run finished", "", None
    try:
        while k < samples and (k := clock.wait_for(k)) < samples:
            if reason := stop():
                raise ControlError(reason)
            now = device.read()
            needed = ("time_s", *NEEDED_SENSORS)  # the other readings are only recorded
            if gone := [name for name in needed if not math.isfinite(getattr(now, name))]:
                raise ControlError(f"no reading of {', '.join(gone)}; check the sensor")
            p_exp, p_i, *more = law(k, now)
            errors = p_exp - now.p_exp_kpa, p_i - now.p_i_kpa
            if not all(map(math.isfinite, errors)):
                raise ControlError(
                    f"the control law gave P_exp = {p_exp}, P_i = {p_i} kPa; both must be finite"
                )
            volts = [0.0, 0.0]
            for i, loop in enumerate(loops):
                gains = loop.kp_v_per_kpa, loop.ki_v_per_kpa_s, period_s
                volts[i], integrals[i] = pressure_step(errors[i], integrals[i], *gains, neutral_v)
            device.write(*volts)
            sample = now._asdict() | {
                "p_exp_command_kpa": p_exp,
                "p_i_command_kpa": p_i,
                "valve_main_v": volts[0],
                "valve_reservoir_v": volts[1],
            }
            rows[done] = row = (*(sample[name] for name in RAW_CHANNELS), *more)
            done += 1
            keep(k, row)
            k += 1
    except Exception as error:
        what = error if isinstance(error, FprcError) else f"{type(error).__name__}: {error}"
        ended, problem, cause = f"run stopped at sample {k}", f": {what}", error
    except BaseException:
        device.safe()
        raise
    try:
        device.safe()
    except Exception as error:
        problem += f"\nthe rig could not be made safe: {error}"
    recorded = dict(zip(names, rows[:done].T.copy(), strict=True))
    if problem:
        raise RunAbortedError(ended + problem, recorded) from cause
    return recorded


def hysteresis_law(p_exp_kpa: np.ndarray, control: "Control") -> Law:
    """Return the law with setpoints P_exp(k), one number per sample, and P_i(k) = K_in theta(k).

    P_i is Eq. (1), clamped between 0 and the reservoir's limit (Sec. II-B).
    """
    commands = np.asarray(p_exp_kpa, dtype=float).tolist()

    def law(k: int, now: Readings) -> tuple[float, float]:
        p_i = clamp(control.k_in_kpa_per_deg * now.theta_deg, 0.0, control.reservoir_limit_kpa)
        return commands[k], p_i

    return law


def tracking_law(
    theta_d_deg: np.ndarray,
    control: "Control",
    pressure_limit_kpa: float,
    *,
    model: "SequenceModel | None" = None,
    online: "Online | None" = None,
    feedback: bool = False,
) -> Law:
    """Return the law P_d = P_ff + P_fb with P_i = K_in theta_d (Sec. IV).

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
    gains = control.pd.kp_kpa_per_deg, control.pd.kd_kpa_s_per_deg, 1.0 / control.sample_rate_hz
    memory, incremental = [math.nan, 0.0], control.feedback == "incremental"
    p_o_shift_kpa = control.feedforward.p_o_shift_kpa
    reads_p_o = source is not None and source.n_features_in_ > 1

    def law(k: int, now: Readings) -> Sequence[float]:
        theta_d, p_fb = references[k], 0.0
        error_deg = theta_d - now.theta_deg
        if online is not None:
            online.learn(error_deg, now.theta_deg)
        inputs = (theta_d, now.p_o_kpa + p_o_shift_kpa) if reads_p_o else (theta_d,)
        p_ff = 0.0 if source is None else source.step(inputs)
        if feedback:
            p_fb = pd_step(
                memory, error_deg, now.theta_deg, p_ff, incremental, *gains, 0.0, pressure_limit_kpa
            )
        if not math.isfinite(p_ff + p_fb):
            raise ControlError(
                f"the controller gave P_ff = {p_ff}, P_fb = {p_fb} kPa at theta_d = "
                f"{theta_d:.2f} deg; both must be finite, check model and gains"
            )
        p_d = clamp(p_ff + p_fb, 0.0, pressure_limit_kpa)
        row = p_d, control.k_in_kpa_per_deg * theta_d, theta_d, p_ff, p_fb
        if online is None:
            return row
        online.sent(p_fb)
        return *row, online.p_learned_kpa, float(np.linalg.norm(online.learned))

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
