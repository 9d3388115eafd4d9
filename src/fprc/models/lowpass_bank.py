"""Low-passes of several speeds side by side."""

from collections.abc import Sequence

from fprc.models.features import FeatureMap, Row
from fprc.models.kernels import LOWPASS
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

    def rows(self) -> list[Row]:
        """Return the low-passes of every column."""
        columns = range(self.n_features_in_)
        return [(i, LOWPASS, float(epsilon)) for i in columns for epsilon in self.epsilons]
