"""Ridge regression that penalises every weight, including the bias."""

import warnings
from collections.abc import Iterable

import numpy as np
from scipy.linalg import LinAlgError, LinAlgWarning, solve

#: Rows whose products are summed at once: with 800 features their copy takes 13 MB.
ROWS = 2000


def with_bias(X: np.ndarray) -> np.ndarray:
    """Return [1, X], the extended state of Eqs. (4) and (7)."""
    return np.column_stack([np.ones(len(X)), X])


def sums_of_products(blocks: Iterable[np.ndarray], y: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return the sums of the products of [1, x] with itself and with y, of the rows of all blocks.

    Parameters
    ----------
    blocks : iterable of ndarray
        Arrays of rows x, in the order of ``y``; each may be overwritten by the next.
    """
    gram, moments, done = np.zeros(()), np.zeros(()), 0
    for block in blocks:
        for first in range(0, len(block), ROWS):
            extended = with_bias(block[first : first + ROWS])
            gram = gram + extended.T @ extended
            moments = moments + extended.T @ y[done : done + len(extended)]
            done += len(extended)
    return gram, moments


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
