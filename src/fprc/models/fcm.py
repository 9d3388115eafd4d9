"""Fuzzy c-means clustering (Bezdek 1984) with fuzzifier 2."""

import warnings
from collections import deque
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from sklearn.cluster import kmeans_plusplus
from sklearn.exceptions import ConvergenceWarning

from fprc.models.kernels import alternate

#: A sample within this share of the largest number counts as lying on a centre:
#: below it a distance is rounding of the centre.
NEAR = 64.0 * np.finfo(float).eps

#: Memberships that change by less are near enough to an optimum to extrapolate; before,
#: a leap could end in another one.
SMALL = 0.1

#: Steps that an extrapolation looks back on.
DEPTH = 10

#: Differences of steps below this share of the largest are rounding.
RANK = 1e-10

#: An objective that is higher by this share only is not higher.
ROUNDING = 1e-13


class Clusters(NamedTuple):
    """Result of the clustering."""

    centers: np.ndarray  #: (n_clusters, n_features)
    memberships: np.ndarray  #: (n_samples, n_clusters), rows sum to 1
    objective: float  #: sum over samples and clusters of u^2 d^2


def fuzzy_c_means(
    X: np.ndarray,
    n_clusters: int,
    *,
    random_state: int | np.random.RandomState | None = None,
    tolerance: float = 1e-5,
    max_iterations: int = 1000,
    coarse: int = 10,
) -> Clusters:
    """Cluster the rows of ``X`` by alternating memberships and centres.

    The centres start at k-means++ samples and are first settled on every
    ``coarse``-th row, which leaves few iterations to do on all of them. Each
    iteration extrapolates the last ones (Anderson 1965), which settles in tens
    of iterations where alternating takes hundreds; where that raised the
    objective, a longer step or the plain one is taken instead.

    Parameters
    ----------
    X : ndarray of shape (n_samples, n_features)
        Finite numbers.
    tolerance : float
        Stop when no membership changes by more than this.

    Raises
    ------
    ValueError
        Fewer samples than clusters.
    """
    if not 1 <= n_clusters <= len(X):
        raise ValueError(
            f"n_clusters = {n_clusters} needs as many samples, but n_samples = {len(X)}; "
            "use fewer clusters or a longer log"
        )
    thinned = X[::coarse]
    if len(thinned) < 10 * n_clusters:
        thinned = X
    centers, _ = kmeans_plusplus(thinned, n_clusters, random_state=random_state)
    if thinned is not X:
        centers = _settle(thinned, centers, tolerance, max_iterations).centers
    return _settle(X, centers, tolerance, max_iterations)


def _settle(X: np.ndarray, centers: np.ndarray, tolerance: float, limit: int) -> Clusters:
    columns = np.ascontiguousarray(X.T)
    lowest, highest = X.min(axis=0), X.max(axis=0)
    floor = max((NEAR * np.abs(X).max()) ** 2, np.finfo(float).tiny ** 0.5)
    found = Clusters(centers, np.zeros((len(centers), len(X))), np.inf)
    spare = np.empty_like(found.memberships)
    past: deque[tuple[np.ndarray, np.ndarray]] = deque(maxlen=DEPTH + 1)
    tries, stretch = [centers], 1.0  # the last try is a plain step, which raises no objective
    for _ in range(limit):
        centers = np.clip(tries.pop(0), lowest, highest)
        objective, change, means = alternate(columns, centers, found.memberships, spare, floor)
        if tries and objective > found.objective * (1.0 + ROUNDING):
            stretch = 1.0 if len(tries) == 1 else 2.0 * stretch
            past.clear()
            continue
        found, spare = Clusters(centers, spare, objective), found.memberships
        if change < tolerance:
            break
        if change > SMALL:
            past.clear()
        step = means - centers
        past.append((means, step))
        # steps that grow leave a saddle, which is where they would vanish: go on, and further
        tries = [means]
        if len(past) > 1:
            tries = [_extrapolated(past), means + 2.0 * stretch * step, means]
    else:
        warnings.warn(
            f"fuzzy c-means did not settle to {tolerance:g} in {limit} iterations",
            ConvergenceWarning,
            stacklevel=3,
        )
    return found._replace(memberships=found.memberships.T)


def _extrapolated(past: Sequence[tuple[np.ndarray, np.ndarray]]) -> np.ndarray:
    """Return where the steps so far would vanish if they were linear in the centres.

    ``past`` holds each step's end and the step, two of them or more.
    """
    ends, steps = (np.array(each).reshape(len(past), -1) for each in zip(*past, strict=True))
    along = np.linalg.lstsq(np.diff(steps, axis=0).T, steps[-1], rcond=RANK)[0]
    return (ends[-1] - along @ np.diff(ends, axis=0)).reshape(past[-1][0].shape)
