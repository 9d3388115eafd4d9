"""Nonlinear vector autoregression, also called next-generation reservoir computing."""

from dataclasses import dataclass
from itertools import combinations_with_replacement
from math import comb
from typing import Any

import numpy as np

from fprc.limits import LARGEST, Limit, Whole
from fprc.models.features import FeatureMap
from fprc.models.limits import SMALLEST_SCALE, Array


@dataclass(eq=False, repr=False)
class NVAR(FeatureMap):
    """Spaced taps of every column, and their products.

    z(k) = [x(k), x(k-s), ..., x(k-(n_taps-1) s)], of every column, standardised
    features(k) = [z(k), every product of ``degree`` elements of z(k)]

    The columns are standardised by the training log's mean and standard deviation: a ridge with
    one alpha would penalise the taps of a signal of 60 deg far more than its squares of 3,600.

    Parameters
    ----------
    n_taps : int, default=5
        Taps of every column, >= 1.
    spacing : int, default=25
        Samples from one tap to the next, >= 1.
    degree : int, default=2
        Factors of each product, >= 2.

    Attributes
    ----------
    mean_, scale_ : ndarray of shape (n_inputs,)
        Mean and standard deviation of each column of the training log; the latter is 1 for a
        column that is constant but for rounding.

    References
    ----------
    Gauthier, Bollt, Griffith and Barbosa, Nature Communications 12 (2021), 5564.
    """

    n_taps: int = 5
    spacing: int = 25
    degree: int = 2

    LIMITS = {"n_taps": Whole(1, 1000), "spacing": Whole(1, 10_000), "degree": Whole(2, 10)}

    def count_features(self, columns: int) -> int:
        linear = columns * self.n_taps
        return linear + comb(linear + self.degree - 1, self.degree)

    def learned(self) -> dict[str, Any]:
        mean = Array((self.n_features_in_,), Limit(-2 * LARGEST, 2 * LARGEST))
        return {"mean_": mean, "scale_": Array(mean.shape, Limit(SMALLEST_SCALE, 1e30))}

    def prepare(self, X: np.ndarray) -> None:
        self.mean_, spread = X.mean(axis=0), X.std(axis=0)
        rounding = SMALLEST_SCALE * np.maximum(np.abs(X).max(axis=0), 1.0)
        self.scale_ = np.where(spread >= rounding, spread, 1.0)

    def begin(self, x: np.ndarray) -> None:
        linear, span = range(len(x) * self.n_taps), (self.n_taps - 1) * self.spacing + 1
        self._products = np.array(list(combinations_with_replacement(linear, self.degree)))
        self._history = np.repeat(((x - self.mean_) / self.scale_)[:, None], span, axis=1)

    def map_sample(self, x: np.ndarray) -> np.ndarray:
        self._history[:, 1:] = self._history[:, :-1]
        self._history[:, 0] = (x - self.mean_) / self.scale_
        linear = self._history[:, :: self.spacing].ravel()
        return np.concatenate([linear, linear[self._products].prod(axis=1)])
