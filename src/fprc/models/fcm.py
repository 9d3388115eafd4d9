"""Fuzzy c-means clustering (Bezdek 1984) with fuzzifier 2."""

import warnings
from collections import deque
from typing import NamedTuple

import numpy as np
from sklearn.cluster import kmeans_plusplus
from sklearn.exceptions import ConvergenceWarning
from sklearn.utils import check_random_state

from fprc.models.kernels import alternate

#: Distances below this fraction of the largest absolute number in the data are rounding errors.
NEAR = 64.0 * np.finfo(float).eps
#: Extrapolate only when no membership changes by more than this: further from an optimum, an
#: extrapolation could lead to another one.
SMALL = 0.1
#: Largest number whose squares, summed over samples and features, are within the range of double.
LARGEST = 1e100
#: Earlier iterations that an extrapolation uses.
DEPTH = 10
#: Singular values of the steps' differences below this fraction of the largest are rounding errors.
RANK = 1e-10
#: A relative increase of the objective below this is a rounding error.
ROUNDING = 1e-13
#: Objectives that differ by less than this fraction belong to one optimum. Its first start is kept,
#: so that rounding does not decide on the order of the clusters.
SAME = 1e-6


class Clusters(NamedTuple):
    """Result of the clustering."""

    centers: np.ndarray  #: (n_clusters, n_features)
    memberships: np.ndarray  #: (n_samples, n_clusters), rows sum to 1
    objective: float  #: sum over samples and clusters of u^2 d^2
    passes: float  #: iterations on all rows that take as long as those of all starts


def fuzzy_c_means(
    X: np.ndarray,
    n_clusters: int,
    *,
    random_state: int | np.random.RandomState | None = None,
    restarts: int = 1,
    init: np.ndarray | None = None,
    tolerance: float = 1e-5,
    max_iterations: int = 1000,
    coarse: int = 10,
) -> Clusters:
    """Cluster the rows of ``X``, finite numbers, by alternating memberships and centres.

    The centres start at k-means++ samples and first converge on every ``coarse``-th row, so that
    few iterations on all rows remain. Each iteration extrapolates the earlier ones (Anderson 1965):
    tens of iterations where plain alternation takes hundreds. If an extrapolation raises the
    objective, a longer step and then the plain step replace it. The iterations end when no
    membership changes by more than ``tolerance``.

    Of ``restarts`` starts the one with the lowest objective is kept; ``init``, of shape
    (n_clusters, n_features), is the only start instead, and converges on all rows at once.
    """
    if not 1 <= n_clusters <= len(X):
        raise ValueError(
            f"n_clusters = {n_clusters}, but n_samples = {len(X)}; use fewer clusters, or a longer "
            "log"
        )
    if (largest := np.abs(X).max()) > LARGEST:
        raise ValueError(f"X has numbers up to {largest:g}; scale it to within {LARGEST:g}")
    if init is not None:
        return _converge(X, init, tolerance, max_iterations)
    thinned = X[::coarse]
    if len(thinned) < 10 * n_clusters:
        thinned = X
    rng = check_random_state(random_state)
    starts = [kmeans_plusplus(thinned, n_clusters, random_state=rng)[0] for _ in range(restarts)]
    found = [_converge(thinned, centers, tolerance, max_iterations) for centers in starts]
    passes = sum(clusters.passes for clusters in found) * len(thinned) / len(X)
    lowest = min(clusters.objective for clusters in found)
    best = next(clusters for clusters in found if (1.0 - SAME) * clusters.objective <= lowest)
    if thinned is not X:
        best = _converge(X, best.centers, tolerance, max_iterations)
        passes += best.passes
    return best._replace(passes=passes)


def _converge(X: np.ndarray, centers: np.ndarray, tolerance: float, limit: int) -> Clusters:
    columns = np.ascontiguousarray(X.T)
    lowest, highest = X.min(axis=0), X.max(axis=0)
    floor = max((NEAR * np.abs(X).max()) ** 2, np.finfo(float).tiny ** 0.5)
    best = Clusters(centers, np.zeros((len(centers), len(X))), np.inf, 0.0)
    spare = np.empty_like(best.memberships)
    past: deque[np.ndarray] = deque(maxlen=DEPTH + 1)  # end points and steps
    tries, stretch = [centers], 1.0  # the last try, a plain step, never raises the objective
    for passes in range(1, limit + 1):
        centers = np.clip(tries.pop(0), lowest, highest)
        objective, change, means = alternate(columns, centers, best.memberships, spare, floor)
        if tries and objective > best.objective * (1.0 + ROUNDING):
            stretch = 1.0 if len(tries) == 1 else 2.0 * stretch
            past.clear()
            continue
        best, spare = Clusters(centers, spare, objective, passes), best.memberships
        if change < tolerance:
            break
        if change > SMALL:
            past.clear()
        step = means - centers
        past.append(np.array([means, step]))
        # growing steps lead away from a saddle; an extrapolation would lead back, so step further
        tries = [means]
        if len(past) > 1:
            # the centres at which the step would be zero if steps were linear in the centres
            ends, steps = np.array(past).reshape(len(past), 2, -1).swapaxes(0, 1)
            factors = np.linalg.lstsq(np.diff(steps, axis=0).T, steps[-1], rcond=RANK)[0]
            extrapolated = (ends[-1] - factors @ np.diff(ends, axis=0)).reshape(means.shape)
            tries = [extrapolated, means + 2.0 * stretch * step, means]
    else:
        warnings.warn(
            f"fuzzy c-means did not converge to {tolerance:g} in {limit} iterations",
            ConvergenceWarning,
            stacklevel=4,
        )
    return best._replace(memberships=best.memberships.T)
