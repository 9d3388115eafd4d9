"""t intervals of means."""

from typing import Any

import numpy as np


def half_interval(std: Any, count: Any, level: float = 0.95) -> Any:
    """Return half the length of the t interval of a mean, given ``count`` values' ``std``."""
    from scipy.special import stdtrit  # slow to import, and most commands do not need it

    return stdtrit(count - 1, 0.5 + level / 2) * std / np.sqrt(count)


def interval_of_mean(
    values: np.ndarray, level: float = 0.95, widened: float = 1.0
) -> tuple[float, float, float]:
    """Return the mean and the ends of its t interval; those of a single value are the value.

    ``widened`` is a factor on the interval's length, for values that are not independent.
    """
    mean, half = float(values.mean()), 0.0
    if values.size > 1:
        half = float(half_interval(values.std(ddof=1), values.size, level)) * widened
    return mean, mean - half, mean + half
