"""Gaussian memberships of the Takagi-Sugeno rules."""

import numpy as np
from scipy.spatial.distance import cdist


def gaussian_memberships(X: np.ndarray, centers: np.ndarray, sigma: float) -> np.ndarray:
    """Normalised memberships beta_bar of each row (Eqs. 10, 11).

    beta_i = exp(-||x - c_i||^2 / (2 sigma^2)), divided by the sum over i. The largest exponent is
    subtracted first: the result is the same, but a sample far from every centre is not 0 / 0.

    Returns
    -------
    ndarray of shape (n_samples, n_clusters)
        Rows sum to 1.
    """
    # one row per cluster, and in place: NumPy is slow with short rows and new arrays
    beta = cdist(centers, X, "sqeuclidean")
    beta /= -2.0 * sigma**2
    beta -= beta.max(axis=0)
    np.exp(beta, out=beta)
    beta /= beta.sum(axis=0)
    return beta.T
