"""Feature map of the ESN: taps of theta_d and the states of its network."""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from sklearn.utils import check_random_state

from fprc.limits import limits_of
from fprc.models.echo import echo_states, narrowed, update
from fprc.models.features import FeatureMap, refuse_shorter, table, tap_rows, taps
from fprc.models.kernels import advance
from fprc.models.learned import Learned
from fprc.models.limits import SEED, Array

#: Samples of a block: with 800 states its features take 52 MB.
BLOCK = 8_000


@dataclass(eq=False, repr=False)
class EchoStates(FeatureMap):
    """Taps of the input beside the state of a leaky echo state network.

    x(k+1) = gamma x(k) + (1 - gamma) tanh(w_in theta(k) + W_r x(k))     (3)
    features(k) = [theta(k), ..., theta(k-n_y+1), x(k)]

    The leak rate of other libraries is 1 - gamma.

    Parameters
    ----------
    r : int, default=800
        Reservoir size, at most 4,000: W_r then takes 128 MB.
    f_input : float, default=0.02
        Factor on the N(0, 1) input weights.
    gamma : float, default=0.8
        Leaky rate, in [0, 1).
    rho : float, default=0.4
        Spectral radius: largest absolute eigenvalue of W_r before its rounding to float32.
    n_y : int, default=5
        Taps of every input, >= 1.
    washout : int, default=100
        Steps with the first sample as constant input, in which x settles before the log begins.
    random_state : int or None, default=None
        Source of the random weights.

    Attributes
    ----------
    w_in_ : ndarray of shape (r, n_inputs)
    W_r_ : ndarray of shape (r, r)
    """

    r: int = 800
    f_input: float = 0.02
    gamma: float = 0.8
    rho: float = 0.4
    n_y: int = 5
    washout: int = 100
    random_state: int | None = None

    LIMITS = {
        **limits_of("r", "f_input", "gamma", "rho", "n_y", "washout"),
        "random_state": SEED,
    }

    def prepare(self, X: np.ndarray) -> None:
        """See ``FeatureMap``."""
        rng = check_random_state(self.random_state)
        self.w_in_ = self.f_input * rng.standard_normal((self.r, X.shape[1]))
        dense = rng.standard_normal((self.r, self.r))
        dense *= self.rho / np.abs(np.linalg.eigvals(dense)).max()
        # random numbers need no more than float32, of which a step reads half the bytes
        self.W_r_ = dense.astype(np.float32).astype(np.float64)

    def count_features(self) -> int:
        """Return the number of taps and states."""
        return self.n_features_in_ * self.n_y + self.r

    def learned(self) -> Iterator[tuple[str, Learned]]:
        """Check the parameters, and yield the shapes of both matrices."""
        yield from super().learned()
        yield "w_in_", Array((self.r, self.n_features_in_))
        yield "W_r_", Array((self.r, self.r))

    def map_recording(self, X: np.ndarray) -> np.ndarray:
        """See ``FeatureMap``."""
        (rows,) = self._blocks(X, len(X))
        return rows

    def _blocks(self, X: np.ndarray, size: int = BLOCK) -> Iterator[np.ndarray]:
        refuse_shorter(X, self.n_y)
        X = np.array(X, order="C")  # a copy, as in FeatureMap
        references = np.hstack([taps(column, self.n_y) for column in X.T])
        free = references.shape[1]
        state, W_r = self._settled(X[0])
        rows = np.empty((min(size, len(X)), free + self.r))
        for start in range(0, len(X), size):
            inputs = X[start : start + size]
            block = rows[: len(inputs)]
            echo_states(inputs, state, self.w_in_, W_r, self.gamma, block[:, free:])
            block[:, :free] = references[start : start + size]
            yield block

    def _settled(self, x: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return the state after the washout, see ``echo_states``, and W_r in a narrower type."""
        state, W_r = np.zeros((2, self.r)), narrowed(self.W_r_)
        for _ in range(self.washout):
            update(state[0], state[1], x, self.w_in_, W_r, self.gamma)
        return state, W_r

    def begin(self, x: np.ndarray) -> None:
        """See ``FeatureMap``."""
        (self._state, self._target), self._W_r = self._settled(x)
        self._row = np.concatenate([np.repeat(x, self.n_y), self._state])
        self._table = table([row for i in range(len(x)) for row in tap_rows(i, self.n_y)])

    def map_sample(self, x: np.ndarray) -> np.ndarray:
        """See ``FeatureMap``."""
        free = len(self._row) - len(self._state)
        advance(self._row[:free], x, *self._table)
        update(self._state, self._target, x, self.w_in_, self._W_r, self.gamma)
        self._row[free:] = self._state
        return self._row
