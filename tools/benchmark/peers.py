"""The same computations with ReservoirPy, scikit-fuzzy and plain NumPy."""

from collections.abc import Sequence
from importlib.util import find_spec
from typing import TYPE_CHECKING

import numpy as np

from fprc.errors import FprcError
from fprc.evaluation.folds import Fold
from fprc.evaluation.metrics import rmse
from fprc.models import FPRC, EchoStates, RidgeReadout, taps

if TYPE_CHECKING:
    from reservoirpy.nodes import Reservoir


def refuse_missing() -> None:
    """Check that the libraries to compare with are installed.

    Raises
    ------
    FprcError
        One of them is not installed.
    """
    if not (find_spec("reservoirpy") and find_spec("skfuzzy")):
        raise FprcError("the benchmark needs reservoirpy and scikit-fuzzy; use `make benchmark`")


def reservoirpy_network(
    features: EchoStates, X: np.ndarray, dtype: type = np.float64
) -> "Reservoir":
    """Return ReservoirPy's network with the same weights, in state 0; its leak is 1 - gamma."""
    from reservoirpy.nodes import Reservoir

    network = Reservoir(
        W=features.W_r_.astype(dtype),
        Win=features.w_in_.astype(dtype),
        bias=np.zeros(features.r, dtype),
        lr=dtype(1.0 - features.gamma),
        dtype=dtype,
    )
    network.initialize(X.astype(dtype))
    # its own initial state is float64, which would make every step float64
    network.state = {"out": np.zeros(features.r, dtype)}
    return network


def reservoirpy_states(features: EchoStates, X: np.ndarray, dtype: type = np.float64) -> np.ndarray:
    """Return x(k+1) of every sample k, by ReservoirPy."""
    return reservoirpy_network(features, X, dtype).run(X.astype(dtype))


def reservoirpy_steps(features: EchoStates, X: np.ndarray) -> np.ndarray:
    """Return x after the last sample, by ReservoirPy's step."""
    network = reservoirpy_network(features, X)
    for theta in X:
        x = network.step(theta)
    return x


def numpy_states(features: EchoStates, X: np.ndarray) -> np.ndarray:
    """Return x(k) of every sample, Eq. (3) as a loop."""
    w_in, W_r, gamma = features.w_in_, features.W_r_, features.gamma
    states, x = np.empty((len(X), features.r)), np.zeros(features.r)
    for k, theta in enumerate(X):
        states[k] = x
        x = gamma * x + (1.0 - gamma) * np.tanh(w_in @ theta + W_r @ x)
    return states


def numpy_fprc_steps(model: FPRC, X: np.ndarray) -> np.ndarray:
    """Return P_ff(k) sample by sample, each formula vectorised over one row."""
    epsilon, n_y, width = model.epsilon, model.n_y, 2.0 * model.sigma**2
    centers, bias = model.readout_.centers_, model.readout_.W_out_[:, 0]
    W_out = np.ascontiguousarray(model.readout_.W_out_[:, 1:])
    filtered = X[0, 1]
    x = np.repeat(X[0], [n_y, model.n_u])
    P_ff = np.empty(len(X))
    for k, (theta, p_o) in enumerate(X):
        filtered = epsilon * p_o + (1.0 - epsilon) * filtered
        x[1:] = x[:-1]
        x[0], x[n_y] = theta, filtered
        difference = x - centers
        distance2 = (difference * difference).sum(axis=1)
        beta = np.exp((distance2.min() - distance2) / width)
        P_ff[k] = beta @ (bias + W_out @ x) / beta.sum()
    return P_ff


def recomputed_folds(
    features: EchoStates, X: np.ndarray, y: np.ndarray, folds: Sequence[Fold], alpha: float
) -> list[float]:
    """Return the ESN's validation errors; states and normal equations are recomputed per fold."""
    errors = []
    for train, validation in folds:
        rows = np.hstack([taps(X[:, 0], features.n_y), numpy_states(features, X)])
        readout = RidgeReadout(alpha).fit(rows[train], y[train])
        errors.append(rmse(y[validation], readout.predict(rows[validation])))
    return errors
