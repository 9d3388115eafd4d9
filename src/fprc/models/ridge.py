"""Ridge regression that penalises every weight, including the bias."""

import warnings

import numpy as np
from scipy.linalg import LinAlgError, LinAlgWarning, solve


def with_bias(X: np.ndarray) -> np.ndarray:
    """Return [1, X], the extended state of Eqs. (4) and (7)."""
    return np.column_stack([np.ones(len(X)), X])


def solve_ridge(gram: np.ndarray, moments: np.ndarray, alpha: float) -> np.ndarray:
    """Solve the normal equations (gram + alpha I) w = moments.

    Parameters
    ----------
    gram : ndarray of shape (n_weights, n_weights)
    moments : ndarray of shape (n_weights,)

    Raises
    ------
    ValueError
        The equations are singular, which happens only with ``alpha=0``.
    """
    penalised = gram + alpha * np.eye(len(gram))
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("error", LinAlgWarning)
            return solve(penalised, moments, assume_a="pos")
    except (LinAlgError, LinAlgWarning) as error:
        raise ValueError(
            f"the ridge regression is singular with alpha = {alpha}; use a larger alpha"
        ) from error
