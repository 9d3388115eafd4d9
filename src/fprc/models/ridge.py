"""Linear readout with a ridge on every weight."""

import warnings
from collections.abc import Sequence
from typing import Self

import numpy as np
from numpy.typing import ArrayLike
from scipy.linalg import LinAlgError, LinAlgWarning, solve
from sklearn.base import BaseEstimator, RegressorMixin, clone
from sklearn.utils.validation import check_is_fitted, validate_data

from fprc.models.limits import Limit, check_limits


def with_bias(X: np.ndarray) -> np.ndarray:
    """Return [1, X], the extended state of Eqs. (4) and (7)."""
    return np.column_stack([np.ones(len(X)), X])


def ridge_weights(
    extended: np.ndarray, y: np.ndarray, alpha: float, weight: np.ndarray | None = None
) -> np.ndarray:
    """Weights that minimise sum_k weight_k (y_k - w x_k)^2 + alpha ||w||^2.

    Parameters
    ----------
    extended : ndarray of shape (n_samples, n_weights)
        Rows x_k. A column of ones is penalised like any other.
    weight : ndarray of shape (n_samples,), optional
        Weight of each squared error, 1 if left out.

    Raises
    ------
    ValueError
        The normal equations are singular, which happens only with ``alpha=0``.
    """
    weighted = extended if weight is None else extended * weight[:, None]
    return solve_ridge(weighted.T @ extended, weighted.T @ y, alpha)


def solve_ridge(gram: np.ndarray, moments: np.ndarray, alpha: float) -> np.ndarray:
    """Solve the normal equations (gram + alpha I) w = moments.

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


class RidgeReadout(RegressorMixin, BaseEstimator):
    """Linear readout P_ff = w_out [1, x], trained with a ridge (Eqs. 4, 5).

    The ridge penalises the bias too, as Eq. (5) is printed; most libraries
    centre the data instead.

    Parameters
    ----------
    alpha : float, default=1e-3
        Ridge parameter, >= 0.

    Attributes
    ----------
    w_out_ : ndarray of shape (1 + n_features,)
        Weights, bias first.
    """

    def __init__(self, alpha: float = 1e-3):
        self.alpha = alpha

    def fit(self, X: ArrayLike, y: ArrayLike) -> Self:
        """Solve the normal equations for one output."""
        check_limits(self, {"alpha": Limit(0)})
        rows, targets = validate_data(self, X, y, y_numeric=True, dtype=np.float64)
        self.w_out_ = ridge_weights(with_bias(rows), targets, self.alpha)
        return self

    def fit_complements(
        self, X: ArrayLike, y: ArrayLike, parts: Sequence[np.ndarray]
    ) -> list[Self]:
        """Return one fitted copy per part, trained on the rows of all other parts.

        X^T X is computed once per part; each copy adds those of the other parts.

        Parameters
        ----------
        parts : sequence of ndarray
            Row indices; every row is in exactly one part.
        """
        check_limits(self, {"alpha": Limit(0)})
        checked = clone(self)
        rows, targets = validate_data(checked, X, y, y_numeric=True, dtype=np.float64)
        sums = []
        for part in parts:
            extended = with_bias(rows[part])
            sums.append((extended.T @ extended, extended.T @ targets[part]))
        fitted = []
        for i in range(len(parts)):
            others = sums[:i] + sums[i + 1 :]
            gram, moments = (sum(each) for each in zip(*others, strict=True))
            readout = clone(self)
            readout.n_features_in_ = checked.n_features_in_
            readout.w_out_ = solve_ridge(gram, moments, self.alpha)
            fitted.append(readout)
        return fitted

    def predict(self, X: ArrayLike) -> np.ndarray:
        """Return the output of each row."""
        check_is_fitted(self)
        X = validate_data(self, X, reset=False, dtype=np.float64)
        return X @ self.w_out_[1:] + self.w_out_[0]

    def output(self, x: np.ndarray) -> float:
        """Return the output of one row of features, without checks."""
        return float(self.w_out_[0] + self.w_out_[1:] @ x)
