"""Controllers, and the sampled control loop: wait, read, compute, write, record."""

import math
from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING

import numpy as np

from fprc.channels import NEEDED_SENSORS, RAW_CHANNELS, Readings
from fprc.control_laws import FARTHEST_DEG, NEUTRAL_V, clamp, pd_step, pressure_step
from fprc.devices import Clock, Device
from fprc.errors import ControlError, FprcError

if TYPE_CHECKING:  # the real rig's loop starts sooner without scikit-learn
    from fprc.config.settings import Control
    from fprc.models import Online, SequenceModel

#: Returns the setpoints P_exp and P_i of sample k in kPa, then any further values to record.
Law = Callable[[int, Readings], Sequence[float]]

#: Readings that every run needs; the others are only recorded.
_NEEDED = ("time_s", *NEEDED_SENSORS)


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

    ``law(k, readings)`` returns the setpoints of both chambers in kPa; the two
    PI loops convert them to valve voltages. The device is made safe at the end,
    however the run ends.

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
        The law, the device or a loop failed, a stop was requested, or the rig
        could not be made safe; holds the rows recorded until then.
    """
    names = (*RAW_CHANNELS, *extra)
    rows = np.empty((samples, len(names)))
    done = k = 0
    period_s = 1.0 / control.sample_rate_hz
    loops = (control.main_loop, control.reservoir_loop)
    gains = [(loop.kp_v_per_kpa, loop.ki_v_per_kpa_s) for loop in loops]
    integrals: Sequence[float] = (0.0, 0.0)
    ended, problem, cause = "run finished", "", None
    try:
        while k < samples and (k := clock.wait_for(k)) < samples:
            if reason := stop():
                raise ControlError(reason)
            now = device.read()
            if gone := [name for name in _NEEDED if not math.isfinite(getattr(now, name))]:
                raise ControlError(f"no reading of {', '.join(gone)}; check the sensor")
            p_exp, p_i, *more = law(k, now)
            errors = p_exp - now.p_exp_kpa, p_i - now.p_i_kpa
            if not all(map(math.isfinite, errors)):
                raise ControlError(
                    f"the control law gave P_exp = {p_exp}, P_i = {p_i} kPa; both must be finite"
                )
            steps = [
                pressure_step(error, integral, *of_loop, period_s, neutral_v)
                for error, integral, of_loop in zip(errors, integrals, gains, strict=True)
            ]
            (main_v, reservoir_v), integrals = zip(*steps, strict=True)
            device.write(main_v, reservoir_v)
            sample = now._asdict() | {
                "p_exp_command_kpa": p_exp,
                "p_i_command_kpa": p_i,
                "valve_main_v": main_v,
                "valve_reservoir_v": reservoir_v,
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
    k_in_kpa_per_deg, limit_kpa = control.k_in_kpa_per_deg, control.reservoir_limit_kpa

    def law(k: int, now: Readings) -> tuple[float, float]:
        return commands[k], clamp(k_in_kpa_per_deg * now.theta_deg, 0.0, limit_kpa)

    return law


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
        gains = control.pd.kp_kpa_per_deg, control.pd.kd_kpa_s_per_deg
        period_s = 1.0 / control.sample_rate_hz
        self._settings = control.feedback == "incremental", *gains, period_s, 0.0, highest_kpa
        self._last: float | None = None
        self._p_fb_kpa = 0.0

    def step(self, theta_d_deg: float, theta_deg: float, p_ff_kpa: float = 0.0) -> float:
        """Return P_fb for this sample, kPa."""
        if abs(theta_deg) > FARTHEST_DEG:
            return self._p_fb_kpa
        error = theta_d_deg - theta_deg
        last = error if self._last is None else self._last
        self._last = error
        self._p_fb_kpa = pd_step(error, last, self._p_fb_kpa, p_ff_kpa, *self._settings)
        return self._p_fb_kpa


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
