"""States of an echo state network, for one sample or for a whole log."""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np
from sklearn.utils import check_random_state

from fprc.limits import MODEL
from fprc.models.features import FeatureMap, refuse_shorter, table, tap_rows
from fprc.models.kernels import LANES, advance, advance_log, excite, excite_lanes
from fprc.models.limits import Array

#: Shortest segment, samples: almost three times what the paper's network needs to forget its
#: initial state.
SHORTEST = 600

#: States, in [-1, 1], that differ by less than this count as equal.
EQUAL = 64 * np.finfo(float).eps

#: W_r, w_in and gamma of Eq. (3).
Network = tuple[np.ndarray, np.ndarray, float]


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

    r: int = MODEL["r"].default
    f_input: float = MODEL["f_input"].default
    gamma: float = MODEL["gamma"].default
    rho: float = MODEL["rho"].default
    n_y: int = MODEL["n_y"].default
    washout: int = MODEL["washout"].default
    random_state: int | None = None

    def prepare(self, X: np.ndarray) -> None:
        rng = check_random_state(self.random_state)
        self.w_in_ = self.f_input * rng.standard_normal((self.r, X.shape[1]))
        dense = rng.standard_normal((self.r, self.r))
        dense *= self.rho / np.abs(np.linalg.eigvals(dense)).max()
        # random numbers need no more than float32, of which a step reads half the bytes
        self.W_r_ = dense.astype(np.float32).astype(np.float64)

    def count_features(self) -> int:
        return self.n_features_in_ * self.n_y + self.r

    def learned(self) -> dict[str, Any]:
        weights = {"w_in_": Array((self.r, self.n_features_in_)), "W_r_": Array((self.r, self.r))}
        return super().learned() | weights

    def map_recording(self, X: np.ndarray) -> np.ndarray:
        return next(self._blocks(X, len(X)))

    def _blocks(self, X: np.ndarray, most: int) -> Iterator[np.ndarray]:
        refuse_shorter(X, self.n_y)
        X = np.array(X, order="C")  # a copy, as in FeatureMap
        references = advance_log(X, *self._taps())
        free = references.shape[1]
        state, network = self._settled(X[0])
        rows = np.empty((min(most, len(X)), free + self.r))
        for start in range(0, len(X), most):
            inputs = X[start : start + most]
            block = rows[: len(inputs)]
            echo_states(inputs, state, network, block[:, free:])
            block[:, :free] = references[start : start + most]
            yield block

    def _taps(self) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        return table([row for i in range(self.n_features_in_) for row in tap_rows(i, self.n_y)])

    def _settled(self, x: np.ndarray) -> tuple[np.ndarray, Network]:
        """Return the state after the washout, see ``echo_states``, and what moves it on."""
        # a step reads all of W_r: float32, if that changes no number, has half the bytes
        state, single = np.zeros((2, self.r)), self.W_r_.astype(np.float32)
        W_r = single if np.array_equal(single, self.W_r_) else self.W_r_
        network = W_r, self.w_in_, float(self.gamma)
        for _ in range(self.washout):
            update(state, x, network)
        return state, network

    def begin(self, x: np.ndarray) -> None:
        self._state, self._network = self._settled(x)
        self._row = np.concatenate([np.repeat(x, self.n_y), self._state[0]])
        self._table = self._taps()

    def map_sample(self, x: np.ndarray) -> np.ndarray:
        free = len(self._row) - self.r
        advance(self._row[:free], x, *self._table)
        update(self._state, x, self._network)
        self._row[free:] = self._state[0]
        return self._row


def echo_states(X: np.ndarray, state: np.ndarray, network: Network, states: np.ndarray) -> None:
    """Compute x(k) of Eq. (3) for each sample of a log, into the rows of ``states``.

    A step reads all of W_r and is limited by memory bandwidth. The log is therefore cut into
    segments that advance together and share each read of W_r. All but the first segment start
    from a wrong state, which an echo state network forgets: they run again, from the end state
    of their predecessor, until their states equal those of the first run. A network that does
    not forget within a segment is run sample by sample.

    ``state``, of shape (2, r), has x and tanh(w_in theta + W_r x) of the sample before, zeros
    before the first one; it is moved on, in place, to those of the last sample.
    """
    done = len(X) // LANES * LANES
    if done < SHORTEST * LANES or not _side_by_side(X[:done], state, network, states[:done]):
        done = 0
    for u, row in zip(X[done:], states[done:], strict=True):
        update(state, u, network)
        row[:] = state[0]


def update(state: np.ndarray, u: np.ndarray, network: Network) -> None:
    """Advance a state, see ``echo_states``, by one sample with input ``u``, in place (Eq. 3)."""
    x, target = state
    excite(x, target, u, *network)
    np.tanh(target, out=target)


def _side_by_side(X: np.ndarray, state: np.ndarray, network: Network, states: np.ndarray) -> bool:
    """Run all segments, and again until their states are the same; return whether they became so.

    If not, ``state`` is as before.
    """
    inputs, rows = (part.reshape(LANES, len(X) // LANES, -1) for part in (X, states))
    lanes = np.zeros((2, LANES, state.shape[1]))
    lanes[:, 0] = end = state
    for again in (False, True):
        x, target = lanes
        for k in range(inputs.shape[1]):
            excite_lanes(x, target, inputs[:, k], *network)
            np.tanh(target, out=target)
            if again and np.abs(rows[:, k] - x).max() < EQUAL:
                state[:] = end
                return True
            rows[:, k] = x
        end = lanes[:, -1].copy()
        lanes[:, 1:] = lanes[:, :-1].copy()
        lanes[:, 0] = state
    return False
