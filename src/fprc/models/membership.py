"""Gaussian memberships of the Takagi-Sugeno rules."""

import numpy as np
from scipy.spatial.distance import cdist


def gaussian_memberships(X: np.ndarray, centers: np.ndarray, sigma: float) -> np.ndarray:
    """Normalised memberships beta_bar of each row (Eqs. 10, 11).

    beta_i = exp(-||x - c_i||^2 / (2 sigma^2)), divided by their sum. The
    largest exponent is subtracted first, which changes nothing in exact
    arithmetic and keeps a sample far from every centre from becoming 0 / 0.

    Returns
    -------
    ndarray of shape (n_samples, n_clusters)
        Rows sum to 1.
    """
    # one row per cluster, in place: NumPy is slow along short rows and with new arrays
    beta = cdist(centers, X, "sqeuclidean")
    beta /= -2.0 * sigma**2
    beta -= beta.max(axis=0)
    np.exp(beta, out=beta)
    beta /= beta.sum(axis=0)
    return beta.T
