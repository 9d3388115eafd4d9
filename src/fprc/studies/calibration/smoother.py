"""Ensemble smoother with multiple data assimilation (Emerick and Reynolds 2013).

An ensemble of points is moved towards what was observed, a few times with the tolerances widened,
by the regression of points on numbers over the ensemble. No slopes are needed, and every member
may have noise of its own.
"""

import math

import numpy as np

#: Numbers further from the median than so many robust standard deviations are moved there.
_FAR = 6.0

#: A correlation below so many times 1 / sqrt(members) is tapered: it may be chance.
_CHANCE = 2.0


def assimilate(
    points: np.ndarray,
    numbers: np.ndarray,
    low: np.ndarray,
    high: np.ndarray,
    tolerance: np.ndarray,
    *,
    widened: float,
    rng: np.random.Generator,
) -> np.ndarray:
    """Return the points of an ensemble after one assimilation.

    x' = x + C_xy (C_yy + a R)^-1 (clip(y + e, low, high) - y - e), e ~ N(0, a R)

    Parameters
    ----------
    points : ndarray of shape (n_members, n_parameters)
        Normally distributed.
    numbers : ndarray of shape (n_members, n_numbers)
        What each member gives.
    low, high, tolerance : ndarray of shape (n_numbers,)
        Where the numbers should lie; R has the squares of the tolerances.
    widened : float
        The factor a on R; over all assimilations the sum of 1 / a should be 1.

    References
    ----------
    Emerick and Reynolds, Computers & Geosciences 55 (2013), 3-15.
    """
    members = len(points)
    middle = np.median(numbers, axis=0)
    spread = 1.4826 * np.median(np.abs(numbers - middle), axis=0) + 1e-9
    numbers = np.clip(numbers, middle - _FAR * spread, middle + _FAR * spread)
    noisy = numbers + math.sqrt(widened) * tolerance * rng.standard_normal(numbers.shape)
    away_x, away_y = points - points.mean(axis=0), numbers - numbers.mean(axis=0)
    with_y = away_y.T @ away_y / (members - 1) + widened * np.diag(tolerance**2)
    of_x = away_x.T @ away_y / (members - 1)
    scale = np.outer(away_x.std(axis=0, ddof=1), away_y.std(axis=0, ddof=1)) + 1e-12
    tapered = np.minimum(np.abs(of_x / scale) * math.sqrt(members) / _CHANCE, 1.0) ** 2 * of_x
    missing = np.clip(noisy, low, high) - noisy
    return points + np.linalg.solve(with_y, missing.T).T @ tapered.T
