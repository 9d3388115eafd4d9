"""Cross-validation of models whose rows are time by scikit-learn's own tools."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import ArrayLike
from sklearn.base import BaseEstimator


@dataclass
class TimeBlocks:
    """Folds of samples in time: each tests one stretch and trains on the longer one beside it.

    Both are whole stretches of the log, so that taps, filters and states are those of the log.
    A fold of ``KFold(shuffle=True)``, in contrast, gives a model rows with gaps as if they
    were one sample apart.

    Parameters
    ----------
    n_splits : int, default=5
        Folds, at least 2; the tested stretches make up the log.
    gap : int, default=0
        Samples left out between training and test.
    """

    n_splits: int = 5
    gap: int = 0

    def get_n_splits(self, X: Any = None, y: Any = None, groups: Any = None) -> int:
        """Return the number of folds."""
        return self.n_splits

    def split(
        self, X: Any, y: Any = None, groups: Any = None
    ) -> Iterator[tuple[np.ndarray, np.ndarray]]:
        """Yield the rows of training and test of each fold.

        Raises
        ------
        ValueError
            Fewer than two folds, or fewer samples than the folds and gaps need.
        """
        samples = len(X)
        if not 2 <= self.n_splits <= samples:
            raise ValueError(f"n_splits = {self.n_splits}; must be from 2 to n_samples = {samples}")
        rows, edges = np.arange(samples), np.linspace(0, samples, self.n_splits + 1).astype(int)
        for first, last in pairwise(edges):
            train = max(rows[: max(first - self.gap, 0)], rows[last + self.gap :], key=len)
            if not len(train):
                raise ValueError(
                    f"gap = {self.gap} leaves no sample to train on; use a smaller one"
                )
            yield train, rows[first:last]


def settled_rmse(settle: int) -> Callable[[BaseEstimator, ArrayLike, ArrayLike], float]:
    """Return a scorer: minus the RMSE, kPa, without the first samples of a test.

    Before the first sample of a test, a model takes its inputs as constant; the ``settle`` samples
    in which its filters and states are still affected do not count.
    """

    def score(model: BaseEstimator, X: ArrayLike, y: ArrayLike) -> float:
        errors = model.predict(X)[settle:] - np.asarray(y, dtype=float)[settle:]
        return -float(np.sqrt(np.mean(errors**2)))

    return score
