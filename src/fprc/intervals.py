"""Means, their spread, and their t intervals."""

import math
from typing import Any

import numpy as np

#: Confidence of every interval.
LEVEL = 0.95


def half_interval(std: Any, count: Any, level: float = LEVEL) -> Any:
    """Return half the length of the t interval of a mean, given ``count`` values' ``std``."""
    from scipy.special import stdtrit  # slow to import, and most commands do not need it

    return stdtrit(count - 1, 0.5 + level / 2) * std / np.sqrt(count)


def interval_of_mean(
    values: np.ndarray, level: float = LEVEL, widened: float = 1.0
) -> tuple[float, float, float]:
    """Return the mean and the ends of its t interval; those of a single value are the value.

    ``widened`` is a factor on the interval's length, for values that are not independent.
    """
    mean, half = float(values.mean()), 0.0
    if values.size > 1:
        half = float(half_interval(values.std(ddof=1), values.size, level)) * widened
    return mean, mean - half, mean + half


def mean_and_std(values: Any) -> tuple[float, float]:
    """Return mean and sample standard deviation; NaN where the values are too few."""
    sample = np.atleast_1d(np.asarray(values, dtype=float))
    mean = sample.mean() if sample.size else math.nan
    return mean, sample.std(ddof=1) if sample.size > 1 else math.nan
