"""Low-passes of several speeds side by side."""

from collections.abc import Sequence

import numpy as np

from fprc.models.features import FeatureMap
from fprc.models.kernels import follow, follow_log
from fprc.models.limits import Each, Limit


class LowpassBank(FeatureMap):
    """Every column, low-passed with several filter factors.

    x~(k) = epsilon x(k) + (1 - epsilon) x~(k-1), from x~(-1) = x(0)      (6)

    The time constant is about 1 / epsilon samples.

    Parameters
    ----------
    epsilons : sequence of float, default=(0.03, 0.01, 0.003)
        Filter factors, in (0, 1]; 1 is the column itself.

    References
    ----------
    Paper, Sec. III-B, Eq. (6), which has one factor.
    """

    def __init__(self, epsilons: Sequence[float] = (0.03, 0.01, 0.003)):
        self.epsilons = epsilons

    LIMITS = {"epsilons": Each(Limit(0, 1, low_open=True), most=1000)}

    def count_features(self) -> int:
        """Return the number of low-passes of all columns."""
        return self.n_features_in_ * len(self.epsilons)

    def _factors(self) -> np.ndarray:
        return np.array(self.epsilons, dtype=np.float64)

    def _transform(self, X: np.ndarray) -> np.ndarray:
        # not ``lowpass``: it rounds differently from ``step``, and a tree may split between.
        # a copy: numba would compile again for another layout or a read-only array
        return follow_log(np.array(X, order="C"), self._factors())

    def _start(self, x: np.ndarray) -> None:
        self._epsilons = self._factors()
        self._row = np.repeat(x, len(self._epsilons))

    def _step(self, x: np.ndarray) -> np.ndarray:
        follow(self._row, x, self._epsilons)
        return self._row
