"""Limits of the models' parameters, declared as data and checked at ``fit``."""

from collections.abc import Mapping, Sequence
from typing import NamedTuple

from sklearn.base import BaseEstimator


class Limit(NamedTuple):
    """Range of a parameter; an open end is excluded."""

    low: float
    high: float = float("inf")
    low_open: bool = False
    high_open: bool = True

    def allows(self, value: float) -> bool:
        """Return whether ``value`` is within."""
        above = value > self.low if self.low_open else value >= self.low
        return above and (value < self.high if self.high_open else value <= self.high)

    def __str__(self) -> str:  # noqa: D105
        left, right = "(" if self.low_open else "[", ")" if self.high_open else "]"
        return f"{left}{self.low:g}, {self.high:g}{right}"


class OneOf(NamedTuple):
    """Values that a parameter may have."""

    values: tuple[str, ...]

    def allows(self, value: str) -> bool:
        """Return whether ``value`` is one of them."""
        return value in self.values

    def __str__(self) -> str:  # noqa: D105
        return f"{{{', '.join(self.values)}}}"


class Each(NamedTuple):
    """Range of every number of a list, which must not be empty."""

    limit: Limit

    def allows(self, values: Sequence[float]) -> bool:
        """Return whether all are within."""
        return len(values) > 0 and all(map(self.limit.allows, values))

    def __str__(self) -> str:  # noqa: D105
        return f"{self.limit}, each of one or more"


def check_limits(estimator: BaseEstimator, limits: Mapping[str, Limit | OneOf | Each]) -> None:
    """Check the parameters of an estimator.

    Raises
    ------
    ValueError
        Lists every parameter out of range, with its value and limit.
    """
    problems = [
        f"{type(estimator).__name__}: {name} = {value}; must be in {limits[name]}"
        for name, value in estimator.get_params(deep=False).items()
        if name in limits and value is not None and not limits[name].allows(value)
    ]
    if problems:
        raise ValueError("\n".join(problems))
