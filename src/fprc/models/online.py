"""A fitted model that continues to learn while it controls."""

import math
from contextlib import suppress
from copy import deepcopy
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike
from sklearn.utils.validation import check_is_fitted

from fprc import control_laws
from fprc.compiled import kernel
from fprc.limits import LARGEST
from fprc.models.ridge import solve_ridge
from fprc.models.sequence import MOST_WEIGHTS, SequenceModel

_learn_step = kernel(control_laws.learn_step)


class Learning(NamedTuple):
    """How a model learns online; the defaults suit a rig of the paper's size.

    ``fprc.config`` checks them: none is negative, and the memory is longer than a period.
    """

    prior_s: float = 15.0  #: seconds of new data that weigh as much as the training
    memory_s: float = 60.0  #: time constant with which the weight of the training returns
    delay_s: float = 0.02  #: time from a command to the angle that follows from it
    kpa_per_deg: float = 2.0  #: pressure by which a degree of error corrects the model
    limit_kpa: float = 150.0  #: most that learning may add to P_ff, or take from it
    stop_deg: float = 0.5  #: angle up to which the actuator is at its stop


class Online:
    """A model whose readout learns from the tracking error by recursive least squares.

    P_ff(k) = w phi(k) + v(k) phi(k), with the regressors phi of the readout and its trained weights
    w; the second term, which is learned, stays within ``limit_kpa`` either way. The error of now is
    charged to the command that caused it, d samples ago:

        v <- v + G (P_ff(k-d) + S e(k) - (w + v) phi(k-d)),  G = C phi / (1 + phi^T C phi)
        C <- (1 - m) (C - G phi^T C) + m C_0,                m = T / memory

    C_0 is the inverse of the training's information, scaled to ``prior_s``. C never exceeds C_0,
    so the gains are bounded even if a weight is not excited for long; with forgetting instead, C
    and the weights can grow without limit. Nothing is learned while the actuator is at its stop, or
    the command or the learned part at a limit and asked to go further; nor from an angle that
    cannot be true, see ``fprc.control_laws.believe``.

    This is the paper's future work, by the recursive least squares of its authors' next paper
    (arXiv 2503.15819), with a prior in place of forgetting.

    Parameters
    ----------
    model : SequenceModel
        Fitted; it remembers its training data, see ``SequenceModel.remember``. It is not changed.
    learning : Learning
    period_s : float
        Time between two samples, T.
    pressure_limit_kpa : float, default=inf
        Highest P_d; the lowest is 0.

    Attributes
    ----------
    learned : ndarray of shape (n_weights,)
        v, what the weights have learned.
    p_learned_kpa : float
        v phi of the last step, within ``limit_kpa`` either way.
    """

    def __init__(
        self, model: SequenceModel, learning: Learning, period_s: float,
        pressure_limit_kpa: float = math.inf,
    ):  # fmt: skip
        check_is_fitted(model)
        if not hasattr(model, "information_"):
            raise ValueError(
                f"this {type(model).__name__} remembers no training data to learn on from; train "
                f"it again (only a readout of ours with at most {MOST_WEIGHTS} weights can learn)"
            )
        self.settings, self.limit_kpa = learning, pressure_limit_kpa
        self.n_features_in_, self._model = model.n_features_in_, deepcopy(model)
        self._features, self._readout = self._model.features_, self._model.readout_
        self.delay = max(round(learning.delay_s / period_s), 1)
        self.mixing = period_s / learning.memory_s
        self.prior = prior_of(model, learning.prior_s, period_s)
        self.learned = np.zeros(len(self.prior))
        self._gains = np.empty_like(self.learned)
        self._phi = np.zeros((self.delay, len(self.learned)))
        self.fastest_deg = control_laws.FASTEST_DEG_S * period_s
        self.reset()
        # it compiles, before the first tick of a loop; from no command, nothing is learned
        self._learn(0, 0.0, 0.0)

    def reset(self, x: ArrayLike | None = None) -> None:
        """Forget what was learned, and begin a new stream as ``SequenceModel.reset``."""
        self.learned[:] = 0.0
        self.covariance = self.prior.copy()
        self.p_learned_kpa = 0.0
        self._sent = [(0.0, 0.0)] * self.delay  # P_ff and P_fb
        self._k, self._belief = 0, [math.nan, 0.0]
        self._model.reset(x)

    def learn(self, error_deg: float, theta_deg: float) -> None:
        """Learn from the error of a sample, before its ``step``; not from a fault or NaN."""
        then = self._k % self.delay
        true = control_laws.believe(self._belief, theta_deg, self.fastest_deg)
        if true and self._k >= self.delay and abs(self._sent[then][1]) <= LARGEST:
            self._learn(then, float(error_deg), float(theta_deg))

    def step(self, x: ArrayLike) -> float:
        """Return P_ff of the next sample, kPa; see ``SequenceModel.step``."""
        row = self._features.step(x)
        now, limit = self._k % self.delay, self.settings.limit_kpa
        phi = self._phi[now]
        phi[:] = self._readout.regressors(row[None])[0]
        self.p_learned_kpa = control_laws.clamp(float(self.learned @ phi), -limit, limit)
        p_ff = float(self._readout.weights @ phi) + self.p_learned_kpa
        self._sent[now] = p_ff, 0.0
        self._k += 1
        return p_ff

    def sent(self, p_fb_kpa: float) -> None:
        """Note the feedback that was added to the last step."""
        at = (self._k - 1) % self.delay
        self._sent[at] = self._sent[at][0], p_fb_kpa

    def _learn(self, then: int, error_deg: float, theta_deg: float) -> None:
        phi, settings = self._phi[then], self.settings
        base_kpa = float(self._readout.weights @ phi)
        _learn_step(
            self.learned, self.covariance, self.prior, phi, base_kpa, error_deg, theta_deg,
            *self._sent[then], self.limit_kpa, settings.kpa_per_deg, settings.stop_deg,
            settings.limit_kpa, self.mixing, self._gains,
        )  # fmt: skip


def prior_of(model: SequenceModel, prior_s: float, period_s: float) -> np.ndarray:
    """Return the prior covariance C_0 of a model: its training, as ``prior_s`` seconds of data."""
    # the regressors of the biases sum to 1 at each sample
    biases = slice(None, None, 1 + model.readout_.n_features_in_)
    samples = float(model.information_[biases, biases].sum())
    scaled = model.information_ * (prior_s / period_s / max(samples, 1.0))
    # added to the diagonal, for directions that the training never moved; large numbers need more,
    # because of rounding: at most a share of the trace
    least = 1e-6
    while samples >= 1.0 and least <= max(1e-6, 1e-9 * np.trace(scaled)):
        with suppress(ValueError):
            prior = solve_ridge(scaled, np.eye(len(scaled)), least)
            return 0.5 * (prior + prior.T)
        least *= 100.0
    raise ValueError("information_ is of no training; train the model again")
