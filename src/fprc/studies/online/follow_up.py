"""The scheme of the authors' next paper, learned from nothing while it controls.

At sample t, recursive least squares learns the command u(t - d) from the state of a reservoir at
t - d and the measured angles y(t - d + 1) ... y(t). With the same weights, the state at t and the
references r(t + 1) ... r(t + d) give the feedforward: the wanted angles stand where learning had
the measured ones. The reservoir is driven by the reference d samples ahead. The feedback is the
incremental PD controller of ``fprc.control.PD``; for the first d samples it acts alone.

References
----------
J. Shen et al., RoboSoft 2025, arXiv 2503.15819, and its public scripts, which have these settings:
d = 5, forgetting 1 - 1e-6, weights from 0 and covariance from 1; an echo state network of 50
nodes, spectral radius 0.8, rate 0.8 on the new state, input weights uniform in -1 to 1. Ours are
the units: angles over 60 deg and pressures over 100 kPa, since the covariance has none.
"""

from collections import deque
from collections.abc import Sequence
from typing import Any

import numpy as np

from fprc.channels import TRACKING_CHANNELS, Readings
from fprc.compiled import kernel
from fprc.control import PD, run
from fprc.control_laws import clamp
from fprc.devices.sim import SimulatedRig
from fprc.experiments.tracking import TRACKING_RUNS, Track

#: State beside the angles: none, the sealed chamber, or a simulated network.
STATES = ("linear", "p_o", "esn")

_DELAY, _FORGETTING = 5, 1.0 - 1e-6
_ANGLE, _PRESSURE = 60.0, 100.0
_NODES, _RADIUS, _RATE = 50, 0.8, 0.8


@kernel
def _update(weights: Any, covariance: Any, x: np.ndarray, target: float, forgetting: float) -> None:
    """Make one step of recursive least squares with forgetting, in place."""
    gain = covariance @ x
    gain /= forgetting + x @ gain
    weights += gain * (target - weights @ x)
    covariance[:] = (covariance - np.outer(gain, x @ covariance)) / forgetting


class _Network:
    """Echo state network, driven by one input."""

    def __init__(self, seed: int):
        rng = np.random.default_rng([seed, 2503])
        w_r = rng.standard_normal((_NODES, _NODES))
        self._w_r = w_r * (_RADIUS / np.abs(np.linalg.eigvals(w_r)).max())
        self._w_in = rng.uniform(-1.0, 1.0, _NODES)
        self.state = np.zeros(_NODES)

    def drive(self, u: float) -> np.ndarray:
        new = np.tanh(self._w_r @ self.state + self._w_in * u)
        self.state = (1.0 - _RATE) * self.state + _RATE * new
        return self.state


def follow_up(bench: Track, reference: str, state: str) -> dict[str, np.ndarray]:
    """Follow a reference; return the channels of the run.

    Parameters
    ----------
    state : {"linear", "p_o", "esn"}
        What the angles are joined by: nothing, three taps of the filtered P_o, or a network.
    """
    control, theta_d = bench.control, bench.reference(reference)
    limit_kpa = bench.tracking["pressure_limit_kpa"]
    ahead = np.append(theta_d, np.repeat(theta_d[-1], _DELAY))
    network, pd = _Network(bench.seed), PD(control, limit_kpa)
    filtered: deque[float] = deque(maxlen=3)
    states: deque[np.ndarray] = deque(maxlen=_DELAY + 1)
    commands: deque[float] = deque(maxlen=_DELAY + 1)
    angles: deque[float] = deque(maxlen=_DELAY)
    beside = {"linear": 0, "p_o": 3, "esn": _NODES}[state]
    weights = np.zeros(1 + beside + _DELAY)
    covariance = np.eye(weights.size)

    def state_of(k: int, now: Readings) -> np.ndarray:
        if state == "esn":
            return network.drive(ahead[k + _DELAY] / _ANGLE).copy()
        if state == "p_o":
            last = filtered[0] if filtered else now.p_o_kpa
            # the factor of FPRC's filter
            filtered.appendleft(last + 0.01 * (now.p_o_kpa - last))
            return np.array([*filtered, *[filtered[-1]] * (3 - len(filtered))]) / _PRESSURE
        return np.zeros(0)

    def law(k: int, now: Readings) -> Sequence[float]:
        states.append(np.append(1.0, state_of(k, now)))
        angles.append(now.theta_deg / _ANGLE)
        p_ff = 0.0
        if k >= _DELAY:
            learned = np.append(states[0], angles)
            _update(weights, covariance, learned, commands[-_DELAY] / _PRESSURE, _FORGETTING)
            wanted = ahead[k + 1 : k + 1 + _DELAY] / _ANGLE
            p_ff = _PRESSURE * float(weights @ np.append(states[-1], wanted))
        p_fb = pd.step(theta_d[k], now.theta_deg, p_ff)
        p_d = clamp(p_ff + p_fb, 0.0, limit_kpa)
        commands.append(p_d)
        p_i = control["k_in_kpa_per_deg"] * ahead[k + _DELAY]
        return p_d, p_i, theta_d[k], p_ff, p_fb

    number, rate_hz = TRACKING_RUNS[reference], control["sample_rate_hz"]
    rig = SimulatedRig(bench.rig, seed=bench.seed, run=number, sample_rate_hz=rate_hz)
    return run(rig, rig, law, len(theta_d), control, extra=TRACKING_CHANNELS)
