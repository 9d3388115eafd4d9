"""Whole runs on the simulated rig in compiled code: a few milliseconds instead of seconds."""

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from fprc.channels import LEARNING_CHANNELS, RAW_CHANNELS
from fprc.devices.sim import SimulatedRig
from fprc.errors import ControlError

if TYPE_CHECKING:
    from fprc.models import Online

#: Of a feedforward that does not learn.
_NO_LEARNING = dict.fromkeys(
    ("kpa_per_deg", "stop_deg", "limit_kpa", "delay_samples", "mixing"), 0.0
)


class Precomputed(NamedTuple):
    """The feedforward of a whole reference."""

    p_ff_kpa: np.ndarray  #: as the model was trained
    online: "Online | None" = None  #: learns as the run goes on, and is changed
    regressors: np.ndarray | None = None  #: those of ``online``, of shape (n_samples, n_weights)


def simulate_hysteresis(
    device: SimulatedRig,
    control: Mapping[str, Any],
    p_exp_kpa: np.ndarray,
    push_kpa: np.ndarray | None = None,
) -> dict[str, np.ndarray]:
    """Return what ``run`` with ``hysteresis_law`` returns: P_exp prescribed, P_i = K_in theta.

    Parameters
    ----------
    control : Mapping
        Section ``control`` of the configuration.
    push_kpa : ndarray of shape (n_samples,), optional
        Push on the reservoir at every sample; none by default.
    """
    nan = np.full(len(p_exp_kpa), np.nan)
    pushes = np.zeros(len(nan)) if push_kpa is None else push_kpa
    setpoints = np.column_stack([p_exp_kpa, nan, nan, pushes])
    channels = device.follow(_controllers(control, (-np.inf, np.inf)), setpoints)
    return {name: values for name, values in channels.items() if name in RAW_CHANNELS}


def simulate_tracking(
    device: SimulatedRig,
    control: Mapping[str, Any],
    theta_d_deg: np.ndarray,
    feedforward: np.ndarray | Precomputed,
    pressure_limit_kpa: float,
    *,
    feedback: bool,
    push_kpa: np.ndarray | None = None,
) -> dict[str, np.ndarray]:
    """Return what ``run`` with ``tracking_law`` returns, given P_ff of every sample.

    Parameters
    ----------
    control : Mapping
        Section ``control`` of the configuration.
    feedforward : ndarray of shape (n_samples,) or Precomputed
        P_ff in kPa; or also the model that learns.
    feedback : bool
        Whether the PD controller acts; without it P_fb = 0.
    push_kpa : ndarray of shape (n_samples,), optional
        Push on the reservoir at every sample; none by default.

    Raises
    ------
    ControlError
        P_ff is not finite.
    """
    given = feedforward if isinstance(feedforward, Precomputed) else Precomputed(feedforward)
    p_ff_kpa, online, regressors = given
    bad = np.flatnonzero(~np.isfinite(p_ff_kpa))
    if bad.size:
        raise ControlError(
            f"the model gave P_ff = {p_ff_kpa[bad[0]]} kPa at sample {bad[0]}; it must be finite"
        )
    pushes = np.zeros(len(theta_d_deg)) if push_kpa is None else push_kpa
    p_i_kpa = control["k_in_kpa_per_deg"] * theta_d_deg
    controllers = _controllers(control, (0.0, pressure_limit_kpa), feedback)
    setpoints = np.column_stack([p_ff_kpa, theta_d_deg, p_i_kpa, pushes])
    if online is None or regressors is None:
        channels = device.follow(controllers, setpoints)
        return {name: channels[name] for name in channels if name not in LEARNING_CHANNELS}
    names = ("kpa_per_deg", "stop_deg", "limit_kpa")
    controllers["learning"] = {
        **{name: getattr(online.settings, name) for name in names},
        "delay_samples": online.delay,
        "mixing": online.mixing,
    }
    learner = (regressors, online.learned, online.covariance, online.prior)
    return device.follow(controllers, setpoints, learner)


def _controllers(
    control: Mapping[str, Any], p_exp_limits_kpa: tuple[float, float], feedback: bool = False
) -> dict[str, Any]:
    incremental = feedback and control["feedback"] == "incremental"
    return {
        "main": control["main_loop"],
        "reservoir": control["reservoir_loop"],
        "feedback": {
            "kp_kpa_per_deg": control["pd"]["kp_kpa_per_deg"] if feedback else 0.0,
            "kd_kpa_s_per_deg": control["pd"]["kd_kpa_s_per_deg"] if feedback else 0.0,
            "incremental": incremental,
            "acts": feedback,
        },
        "learning": _NO_LEARNING,
        "k_in_kpa_per_deg": control["k_in_kpa_per_deg"],
        "p_i_limits_kpa": (0.0, control["reservoir_limit_kpa"]),
        "p_exp_limits_kpa": p_exp_limits_kpa,
    }
