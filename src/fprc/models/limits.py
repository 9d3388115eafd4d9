"""Limits of the models' parameters and learned numbers, declared as data.

``fit`` checks the parameters, ``fprc.models.learned`` both, of a model from a file.
"""

from collections.abc import Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike
from sklearn.base import BaseEstimator
from sklearn.utils.validation import validate_data

from fprc.limits import Limit, Whole

#: Smallest number by which samples are divided. The tenth power of the largest quotient, times the
#: largest weight and summed over all features, is within the range of double.
SMALLEST_SCALE = 1e-12

#: Most features of a map, and most columns of its input.
MOST_FEATURES = 100_000


class Each(NamedTuple):
    """Range of every number of a list, and its greatest length; it must not be empty."""

    limit: Limit
    most: int

    def allows(self, value: Any) -> bool:
        """Return whether ``value`` is a list of numbers within."""
        is_list = isinstance(value, Sequence | np.ndarray) and not isinstance(value, str)
        return is_list and 0 < len(value) <= self.most and all(map(self.limit.allows, value))

    def __str__(self) -> str:  # noqa: D105
        return f"a list of 1 to {self.most} numbers in {self.limit.interval()}"


class Array(NamedTuple):
    """Shape of an array of double, and range of each number.

    By default a trained model is far from the range; beyond it, sums over the features could exceed
    that of double.
    """

    shape: tuple[int, ...]
    each: Limit = Limit(-1e30, 1e30)

    def allows(self, value: Any) -> bool:
        """Return whether ``value`` is such an array."""
        if not isinstance(value, np.ndarray) or value.dtype != np.float64:
            return False
        return value.shape == self.shape and all(map(self.each.allows, (value.min(), value.max())))

    def __str__(self) -> str:  # noqa: D105
        return f"float64 of shape {self.shape} in {self.each.interval()}"


class Words(NamedTuple):
    """Length of an array of words; None is any."""

    length: int | None

    def allows(self, value: Any) -> bool:
        """Return whether ``value`` is such an array."""
        words = value.tolist() if isinstance(value, np.ndarray) else [None]
        return self.length in (None, len(words)) and all(isinstance(word, str) for word in words)


#: What ``random_state`` may be.
SEED = Whole(0, 2**32 - 1, or_none=True)

#: What tells whether a parameter is allowed; as text, what it must be.
Allows = Limit | Each


def check_limits(estimator: BaseEstimator, limits: Mapping[str, Allows]) -> None:
    """Check the parameters of an estimator.

    Raises
    ------
    ValueError
        Lists every parameter of the wrong type or out of range, with its value and limit.
    """
    problems = [
        f"{type(estimator).__name__}: {name} = {value!r:.60}; must be {limits[name]}"
        for name, value in estimator.get_params(deep=False).items()
        if name in limits and not limits[name].allows(value)
    ]
    if problems:
        raise ValueError("\n".join(problems))


def training_data(
    estimator: BaseEstimator, X: ArrayLike, y: ArrayLike
) -> tuple[np.ndarray, np.ndarray]:
    """Return what ``fit`` is given, as scikit-learn checks it; numbers in ``y`` may be text.

    Raises
    ------
    ValueError
        ``y`` is missing or holds something else than numbers, such as words or durations.
    """
    values = np.asarray(y)
    if values.dtype.kind in "mM":
        raise ValueError(f"y: holds {values.dtype}; must be numbers")
    if y is not None and values.dtype.kind in "SUO":
        try:
            y = values.astype(np.float64)
        except (TypeError, ValueError) as error:
            raise ValueError(f"y: {error}; must be numbers") from error
    return validate_data(estimator, X, y, dtype=np.float64)
