"""Linear readout of the ESN."""

from collections.abc import Iterable, Iterator, Mapping, Sequence
from functools import reduce
from typing import ClassVar, Self

import numpy as np
from numpy.typing import ArrayLike
from sklearn.base import BaseEstimator, RegressorMixin, clone
from sklearn.utils.validation import check_is_fitted, validate_data

from fprc.limits import Limit, limits_of
from fprc.models.limits import Array, check_limits, numbers_of
from fprc.models.ridge import solve_ridge, sums_of_products, with_bias


class RidgeReadout(RegressorMixin, BaseEstimator):
    """Linear readout P_ff = w_out [1, x], trained by ridge regression (Eqs. 4, 5).

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

    LIMITS: ClassVar[Mapping[str, Limit]] = limits_of("alpha")

    def learned(self) -> Iterator[tuple[str, Array]]:
        """Yield the shape of the weights, see ``fprc.models.learned``."""
        yield "w_out_", Array((1 + self.n_features_in_,))

    def fit(self, X: ArrayLike, y: ArrayLike) -> Self:
        """Solve the normal equations for one output."""
        rows, targets = validate_data(self, X, numbers_of(y), y_numeric=True, dtype=np.float64)
        return self.fit_blocks([rows], targets)

    def fit_blocks(self, blocks: Iterable[np.ndarray], y: np.ndarray) -> Self:
        """Fit to rows that come in blocks, without checks, so that only one is in memory."""
        check_limits(self, self.LIMITS)
        gram, moments = sums_of_products(blocks, y)
        self.n_features_in_ = len(moments) - 1
        self.w_out_ = solve_ridge(gram, moments, self.alpha)
        return self

    def fit_complements(
        self, blocks: Iterable[np.ndarray], y: np.ndarray, parts: Sequence[np.ndarray]
    ) -> list[Self]:
        """Return one fitted copy per part, trained on the rows of all other parts.

        X^T X is computed once per part; each copy adds those of the other parts.

        Parameters
        ----------
        blocks : iterable of ndarray
            As ``fit_blocks`` takes them.
        parts : sequence of ndarray
            Row indices; every row is in exactly one part.
        """
        check_limits(self, self.LIMITS)
        part_of, done = np.empty(len(y), dtype=int), 0
        for i, part in enumerate(parts):
            part_of[part] = i
        sums: list[list[np.ndarray]] = [[] for _ in parts]
        for block in blocks:
            here = slice(done, done := done + len(block))
            for i, whole in enumerate(sums):
                ours = part_of[here] == i
                found = sums_of_products([block[ours]], y[here][ours])
                whole[:] = map(np.add, whole, found) if whole else found
        fitted = []
        for i in range(len(parts)):
            others = sums[:i] + sums[i + 1 :]
            gram, moments = (reduce(np.add, terms) for terms in zip(*others, strict=True))
            readout = clone(self)
            readout.n_features_in_ = len(moments) - 1
            readout.w_out_ = solve_ridge(gram, moments, self.alpha)
            fitted.append(readout)
        return fitted

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
