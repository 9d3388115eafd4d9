"""Fuzzy c-means clustering (Bezdek 1984) with fuzzifier 2."""

import warnings
from typing import NamedTuple

import numpy as np
from scipy.spatial.distance import cdist
from sklearn.cluster import kmeans_plusplus
from sklearn.exceptions import ConvergenceWarning

#: A sample within this share of the largest number counts as lying on a centre:
#: below it a distance is rounding of the centre.
NEAR = 64.0 * np.finfo(float).eps


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
    ``coarse``-th row, which leaves few iterations to do on all of them.

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
    memberships, distances = _memberships(X, centers)
    for _ in range(limit):
        shares = memberships**2
        centers = shares @ X / shares.sum(axis=1)[:, None]
        before = memberships
        memberships, distances = _memberships(X, centers)
        if np.abs(memberships - before).max() < tolerance:
            break
    else:
        warnings.warn(
            f"fuzzy c-means did not settle to {tolerance:g} in {limit} iterations",
            ConvergenceWarning,
            stacklevel=3,
        )
    return Clusters(centers, memberships.T, float((memberships**2 * distances).sum()))


def _memberships(X: np.ndarray, centers: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return memberships and squared distances, a row a cluster.

    Sums over the few clusters then run along the long rows, several times faster.
    """
    floor = max((NEAR * np.abs(X).max()) ** 2, np.finfo(float).tiny ** 0.5)
    distances = np.maximum(cdist(centers, X, "sqeuclidean"), floor)
    closeness = 1.0 / distances
    return closeness / closeness.sum(axis=0), distances
