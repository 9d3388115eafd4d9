"""Limits of the models' parameters, which ``fit`` checks, and of the numbers that they learn.

Both are checked of a model from a file. The parameters have the limits of ``fprc.limits.MODEL``. A
method ``learned`` declares what a class learns: of each attribute, its ``Array`` or its type.
"""

import inspect
from collections.abc import Set
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike
from sklearn.base import BaseEstimator
from sklearn.utils.validation import validate_data

from fprc.limits import MODEL, Limit, Whole

#: Smallest number by which samples are divided. The tenth power of the largest quotient, times the
#: largest weight and summed over all features, is within the range of double.
SMALLEST_SCALE = 1e-12
#: Most features of a map, and most columns of its input.
MOST_FEATURES = 100_000


class Array(NamedTuple):
    """Shape of an array of double, and range of each number; no range: an array of words.

    By default a trained model is far from the range; beyond it, sums over the features could exceed
    that of double.
    """

    shape: tuple[int, ...]
    each: Limit | None = Limit(-1e30, 1e30)

    def allows(self, value: Any) -> bool:
        """Return whether ``value`` is such an array."""
        kind = np.float64 if self.each else object
        if not isinstance(value, np.ndarray) or (value.shape, value.dtype) != (self.shape, kind):
            return False
        return not self.each or all(map(self.each.allows, (value.min(), value.max())))

    def __str__(self) -> str:  # noqa: D105
        return f"of shape {self.shape}, {self.each or 'words'}"


def is_built_in(model: Any) -> bool:
    """Return whether the class of a model is of this package."""
    return type(model).__module__.startswith(f"{__package__}.")


def check_limits(estimator: Any) -> None:
    """Raise ValueError, with values and limits, if parameters are not within their limits.

    A class from outside that derives from one of this package has the limits of that one. A map
    that knows its columns may not have too many features.
    """
    bases = (cls for cls in type(estimator).__mro__ if cls.__module__.startswith(__package__))
    names = inspect.signature(next(bases, object)).parameters.keys() & MODEL.keys()
    limits = {name: MODEL[name] for name in names}
    columns = getattr(estimator, "n_features_in_", None)
    values = estimator.get_params(deep=False) | {"n_features_in_": columns}
    limits["n_features_in_"] = Whole(1, MOST_FEATURES, or_none=True)
    problems = [
        f"{type(estimator).__name__}: {name} = {value!r:.60}; must be {limits[name]}"
        for name, value in values.items()
        if name in limits and not limits[name].allows(value)
    ]
    if problems:
        raise ValueError("\n".join(problems))
    if columns is not None and hasattr(estimator, "count_features"):
        count = estimator.count_features(columns)
        if count > MOST_FEATURES:
            raise ValueError(
                f"{type(estimator).__name__}: {count} features of {values!r:.100}; use fewer, at "
                f"most {MOST_FEATURES}"
            )


def check_learned(model: Any, learned: Set[str]) -> None:
    """Raise ValueError if a model of this package, from a file, is not as its class declares it.

    ``learned`` are the names of what the file says that it learned.
    """
    check_limits(model)
    columns = model.n_features_in_
    known = {
        "feature_names_in_": Array((columns,), None),
        "units_": Array((1 + columns,), None),
        "sample_rate_hz_": Limit(1e-3, 1e6),
    }
    declared: dict[str, Any] = {key: known[key] for key in known.keys() & learned}
    declared |= getattr(model, "learned", dict)()
    for key, expected in declared.items():
        value = getattr(model, key, None)
        fits = isinstance(value, expected) if isinstance(expected, type) else expected.allows(value)
        if not fits:
            found = f"{value!r:.60}"
            if isinstance(value, np.ndarray):
                found = f"{value.dtype} of shape {value.shape}, such as {value.ravel()[:1]}"
            raise ValueError(f"{type(model).__name__}: {key}: {found}; must be {expected}")
    if others := learned - declared.keys() - {"n_features_in_"}:
        raise ValueError(f"{type(model).__name__} learns no {', '.join(others)}")


def training_data(
    estimator: BaseEstimator, X: ArrayLike, y: ArrayLike
) -> tuple[np.ndarray, np.ndarray]:
    """Return what ``fit`` is given, as scikit-learn checks it; ``y`` may be numbers as text."""
    if y is not None and np.asarray(y).dtype.kind in "mMSUO":
        try:
            y = np.asarray(y).astype(str).astype(np.float64)
        except ValueError as error:
            raise ValueError(f"y: {error}; must be numbers") from error
    return validate_data(estimator, X, y, dtype=np.float64)
