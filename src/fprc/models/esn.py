"""Echo state network: its states, for one sample or for a whole log, and the model."""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np
from sklearn.utils import check_random_state

from fprc.limits import MODEL
from fprc.models.features import FeatureMap, TapFeatures
from fprc.models.kernels import LANES, excite, excite_lanes
from fprc.models.limits import Array
from fprc.models.ridge import RidgeReadout
from fprc.models.sequence import SequenceModel

#: Shortest segment, samples: almost three times what the paper's network needs to forget its
#: initial state. States, in [-1, 1], that differ by less than EQUAL count as equal.
SHORTEST, EQUAL = 600, 64 * np.finfo(float).eps

#: W_r, w_in and gamma of Eq. (3).
Network = tuple[np.ndarray, np.ndarray, float]


@dataclass(eq=False, repr=False)
class EchoStates(FeatureMap):
    """Taps of the input beside the state of an echo state network.

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
        Leaky rate, in [0, 0.999999].
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
        Numbers of float32, of which a step reads half the bytes; others are rounded to them.
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
        self.W_r_ = dense.astype(np.float32).astype(np.float64)

    def count_features(self, columns: int) -> int:
        return columns * self.n_y + self.r

    def learned(self) -> dict[str, Any]:
        return {"w_in_": Array((self.r, self.n_features_in_)), "W_r_": Array((self.r, self.r))}

    def _blocks(self, X: np.ndarray, most: int) -> Iterator[np.ndarray]:
        X = np.array(X, order="C")  # a copy, as in FeatureMap
        taps, state, network = self._started(X[0])
        references = taps.map_recording(X)
        free = references.shape[1]
        rows = np.empty((min(most, len(X)), free + self.r))
        for start in range(0, len(X), most):
            block = rows[: len(X) - start]
            block[:, :free] = references[start : start + most]
            echo_states(X[start : start + most], state, network, block[:, free:])
            yield block

    def _started(self, x: np.ndarray) -> tuple[TapFeatures, np.ndarray, Network]:
        """Return the taps, the state after the washout, see ``echo_states``, and its network."""
        taps = TapFeatures(self.n_y, n_references=None, n_u=1)
        taps.n_features_in_ = self.n_features_in_
        taps.begin(x)
        state = np.zeros((2, self.r))
        network = self.W_r_.astype(np.float32), self.w_in_, float(self.gamma)
        for _ in range(self.washout):
            update(state, x, network)
        return taps, state, network

    def begin(self, x: np.ndarray) -> None:
        self._taps, self._state, self._network = self._started(x)

    def map_sample(self, x: np.ndarray) -> np.ndarray:
        update(self._state, x, self._network)
        return np.concatenate([self._taps.map_sample(x), self._state[0]])


def echo_states(X: np.ndarray, state: np.ndarray, network: Network, states: np.ndarray) -> None:
    """Compute x(k) of Eq. (3) for each sample of a log, into the rows of ``states``.

    A step reads all of W_r and is limited by memory bandwidth. The log is therefore cut into
    segments that advance together and share each read of W_r. All but the first start from a wrong
    state, which an echo state network forgets: they run again, from the end state of their
    predecessor, until their states equal those of the first run. A network that does not forget
    within a segment is run sample by sample.

    ``state`` has x and tanh(w_in theta + W_r x) of the sample before, zeros before the first one;
    it is moved on, in place, to those of the last sample.
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
    """Run all segments until their states stay the same; else return False, ``state`` as before."""
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


@dataclass(eq=False, repr=False)
class ESN(SequenceModel):
    """Echo state network with a ridge readout (Sec. III-A, Eqs. 3-5; Jaeger 2002).

    x(k+1) = gamma x(k) + (1 - gamma) tanh(w_in theta(k) + W_r x(k))     (3)
    P_ff(k) = w_out [1, theta(k), ..., theta(k-n_y+1), x(k)]             (4)

    ``X`` has one column, theta_d in deg; further columns are further inputs. Its rows are samples
    in time, see ``SequenceModel``.

    Parameters
    ----------
    r : int, default=800
        Reservoir size, at most 4,000: W_r then takes 128 MB.
    f_input : float, default=0.02
        Input scaling factor, on N(0, 1) weights.
    gamma : float, default=0.8
        Leaky rate, in [0, 0.999999].
    rho : float, default=0.4
        Spectral radius: largest absolute eigenvalue of W_r before its rounding to float32.
    n_y : int, default=5
        Taps of every input, >= 1.
    alpha : float, default=1e-3
        Ridge parameter; penalises the bias too.
    washout : int, default=100
        Steps with the first sample as constant input, in which x settles before the log begins.
    random_state : int or None, default=None
        Source of the random w_in and W_r.
    """

    r: int = MODEL["r"].default
    f_input: float = MODEL["f_input"].default
    gamma: float = MODEL["gamma"].default
    rho: float = MODEL["rho"].default
    n_y: int = MODEL["n_y"].default
    alpha: float = MODEL["alpha"].default
    washout: int = MODEL["washout"].default
    random_state: int | None = None

    def make_features(self) -> EchoStates:
        return self._part(EchoStates)

    def make_readout(self) -> RidgeReadout:
        return self._part(RidgeReadout)
