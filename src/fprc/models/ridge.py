"""Ridge regression that penalises every weight, including the bias, and the ESN's readout."""

import warnings
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Any, Self

import numpy as np
from numpy.typing import ArrayLike
from scipy.linalg import LinAlgError, LinAlgWarning, solve
from sklearn.base import BaseEstimator, RegressorMixin, clone
from sklearn.utils.validation import check_is_fitted, validate_data

from fprc.limits import MODEL
from fprc.models.limits import Array, check_limits, training_data

#: Rows whose products are summed at once: with 800 features their copy takes 13 MB.
ROWS = 2000


def with_bias(X: np.ndarray) -> np.ndarray:
    """Return [1, X], the extended state of Eqs. (4) and (7)."""
    return np.column_stack([np.ones(len(X)), X])


def sums_of_products(blocks: Iterable[np.ndarray], y: np.ndarray) -> Any:
    """Return the sums of the products of [1, x] with [1, x, y], over blocks of x in y's order."""
    sums: Any = 0.0
    done = 0
    for block in blocks:
        for first in range(0, len(block), ROWS):
            extended = with_bias(block[first : first + ROWS])
            moments = extended.T @ y[done : done + len(extended)]
            sums = sums + np.column_stack([extended.T @ extended, moments])
            done += len(extended)
    return sums


def solve_ridge(gram: np.ndarray, moments: np.ndarray, alpha: float) -> np.ndarray:
    """Solve the normal equations (gram + alpha I) w = moments; only alpha = 0 may be singular."""
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("error", LinAlgWarning)
            return solve(gram + alpha * np.eye(len(gram)), moments, assume_a="pos")
    except (LinAlgError, LinAlgWarning) as error:
        raise ValueError(
            f"the ridge regression is singular with alpha = {alpha}; use a larger alpha"
        ) from error


@dataclass(eq=False, repr=False)
class RidgeReadout(RegressorMixin, BaseEstimator):
    """Linear readout P_ff = w_out [1, x], trained by ridge regression (Eqs. 4, 5).

    The ridge penalises the bias too, as Eq. (5) is printed; most libraries centre the data instead.

    Parameters
    ----------
    alpha : float, default=1e-3
        Ridge parameter, >= 0.

    Attributes
    ----------
    w_out_ : ndarray of shape (1 + n_features,)
        Weights, bias first.
    """

    alpha: float = MODEL["alpha"].default

    def learned(self) -> dict[str, Array]:
        return {"w_out_": Array((1 + self.n_features_in_,))}

    def fit(self, X: ArrayLike, y: ArrayLike) -> Self:
        """Solve the normal equations for one output."""
        rows, targets = training_data(self, X, y)
        return self.fit_blocks([rows], targets)

    def fit_blocks(self, blocks: Iterable[np.ndarray], y: np.ndarray) -> Self:
        """Fit to rows that come in blocks, each of which the next may overwrite, without checks."""
        check_limits(self)
        return self.fit_sums(sums_of_products(blocks, y))

    def fit_complements(
        self, blocks: Iterable[np.ndarray], y: np.ndarray, parts: Sequence[np.ndarray]
    ) -> list[Self]:
        """Return one fitted copy per part, trained on the rows of all other parts.

        X^T X is computed once per part; each copy adds those of the other parts. The parts are
        numbers of rows, each of which is in exactly one part.
        """
        check_limits(self)
        part_of, done = np.empty(len(y), dtype=int), 0
        for i, part in enumerate(parts):
            part_of[part] = i
        sums = [0.0] * len(parts)
        for block in blocks:
            here = slice(done, done := done + len(block))
            for i in range(len(parts)):
                ours = part_of[here] == i
                sums[i] += sums_of_products([block[ours]], y[here][ours])
        return [clone(self).fit_sums(sum(sums[:i] + sums[i + 1 :])) for i in range(len(parts))]

    def fit_sums(self, sums: np.ndarray) -> Self:
        self.n_features_in_ = len(sums) - 1
        self.w_out_ = solve_ridge(sums[:, :-1], sums[:, -1], self.alpha)
        return self

    def predict(self, X: ArrayLike) -> np.ndarray:
        """Return the output of each row."""
        check_is_fitted(self)
        X = validate_data(self, X, reset=False, dtype=np.float64)
        return X @ self.w_out_[1:] + self.w_out_[0]

    def regressors(self, rows: np.ndarray) -> np.ndarray:
        """Return what multiplies the weights ``w_out_``: [1, x]."""
        return with_bias(rows)

    @property
    def weights(self) -> np.ndarray:
        """The weights, bias first; a view, which may be written to."""
        return self.w_out_

    def output(self, x: np.ndarray) -> float:
        """Return the output of one row of features, without checks."""
        return float(self.w_out_[0] + self.w_out_[1:] @ x)
