"""Play operators, of which Prandtl-Ishlinskii models of hysteresis are sums."""

from collections.abc import Iterator

import numpy as np

from fprc.limits import Limit, Whole
from fprc.models.features import FeatureMap, Row
from fprc.models.kernels import PLAY
from fprc.models.learned import Learned
from fprc.models.limits import Array


class PlayOperators(FeatureMap):
    """Play operators of every column: backlash of several widths.

    p(k) = max(x(k) - r, min(x(k) + r, p(k-1))), from p(-1) = x(0)

    A play follows its input at the distance r; after a reversal it waits until the input has moved
    by 2 r. A ridge on plays is a Prandtl-Ishlinskii model, whose loops do not depend on the speed
    of the input.

    The half-widths r divide half the range of each column of the training log into n_plays + 1
    equal parts; a play with half the range as r would not move.

    Parameters
    ----------
    n_plays : int, default=10
        Plays of every column, >= 1.

    Attributes
    ----------
    half_widths_ : ndarray of shape (n_inputs, n_plays)
        r of each play, ascending, in the unit of its column.

    References
    ----------
    Kuhnen, European Journal of Control 9 (2003), 407-418.
    """

    def __init__(self, n_plays: int = 10):
        self.n_plays = n_plays

    LIMITS = {"n_plays": Whole(1, 10_000)}

    def count_features(self) -> int:
        """Return the number of plays of all columns."""
        return self.n_features_in_ * self.n_plays

    def learned(self) -> Iterator[tuple[str, Learned]]:
        """Check the parameters, and yield the shape of the half-widths."""
        yield from super().learned()
        yield "half_widths_", Array((self.n_features_in_, self.n_plays), Limit(0, 1e30))

    def prepare(self, X: np.ndarray) -> None:
        """See ``FeatureMap``."""
        shares = np.arange(1, self.n_plays + 1) / (self.n_plays + 1)
        self.half_widths_ = np.outer(np.ptp(X, axis=0) / 2.0, shares)

    def rows(self) -> list[Row]:
        """Return the plays of every column."""
        return [(i, PLAY, r) for i, widths in enumerate(self.half_widths_.tolist()) for r in widths]
