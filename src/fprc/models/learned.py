"""What a model learns, declared by its class, and the check of a model from a file.

Each class of this package has a method ``learned`` that yields pairs: the name of a learned
attribute, and the shape of its array, the ``LearnedPart`` that it holds, or a list of these.
A class from outside, which may learn anything, is not checked; its parts of this package are.
"""

from typing import Any, NamedTuple

import numpy as np
from sklearn.base import BaseEstimator

from fprc.models.limits import MOST_FEATURES, Limit, Whole, check_limits

#: Learned numbers are within, unless the class's LIMITS have the attribute too. A trained model is
#: far from it; beyond, sums over the features could exceed the range of double.
USUAL = Limit(-1e30, 1e30)

_RATE = Limit(1e-3, 1e6)
_COLUMNS = Whole(1, MOST_FEATURES)


class LearnedPart(NamedTuple):
    """A part of a model: as it is before ``fit``, and the columns that it gets; None is any."""

    unfitted: BaseEstimator
    n_features_in: int | None


#: What ``learned`` yields beside a name.
Learned = tuple[int, ...] | LearnedPart | list[LearnedPart]


def is_built_in(model: BaseEstimator) -> bool:
    """Return whether the class of a model is of this package."""
    return type(model).__module__.startswith(f"{__package__}.")


def is_learned(key: str) -> bool:
    """Return whether an attribute of this name is learned."""
    return key.endswith("_") and not key.startswith("_")


def features_of(features: Any) -> int | None:
    """Return the number of features of a fitted map; None if its class is from outside."""
    return features.count_features() if is_built_in(features) else None


def describe(value: Any, *, seeds: bool = True) -> Any:
    """Return an estimator as a dict of class and parameters, at any depth.

    Arrays and tuples become lists, numbers of NumPy become Python's; two estimators are equal
    if their descriptions are. Any other value stays as it is.

    Parameters
    ----------
    seeds : bool, default=True
        Whether the parameters include ``random_state``.
    """
    if isinstance(value, BaseEstimator):
        parameters = value.get_params(deep=False)
        kept = {key: value for key, value in parameters.items() if seeds or key != "random_state"}
        return {"class": type(value), "parameters": describe(kept, seeds=seeds)}
    if isinstance(value, dict):
        return {key: describe(part, seeds=seeds) for key, part in value.items()}
    if isinstance(value, list | tuple):
        return [describe(part, seeds=seeds) for part in value]
    return value.tolist() if isinstance(value, np.ndarray | np.generic) else value


def check_learned(model: Any) -> None:
    """Check parameters and learned attributes of a fitted model and of its parts.

    Raises
    ------
    ValueError
        Names part and attribute.
    """
    has = {key: value for key, value in vars(model).items() if is_learned(key)}
    if not _RATE.allows(rate := has.pop("sample_rate_hz_", 200.0)):
        raise ValueError(f"sample_rate_hz_ = {rate!r:.60}; must be {_RATE}")
    units = has.pop("units_", None)
    if not is_built_in(model):
        _check_words("units_", units, np.size(units))
        for key, value in has.items():
            parts = enumerate(value) if isinstance(value, list) else []
            for place, part in [(key, value), *((f"{key}.{i}", element) for i, element in parts)]:
                if isinstance(part, BaseEstimator):
                    _check_within(place, part)
        return
    limits = getattr(model, "LIMITS", {})
    check_limits(model, limits)
    columns, names = has.pop("n_features_in_", None), has.pop("feature_names_in_", None)
    if not _COLUMNS.allows(columns):
        raise ValueError(f"n_features_in_ = {columns!r:.60}; must be {_COLUMNS}")
    _check_words("feature_names_in_", names, columns)
    _check_words("units_", units, 1 + columns)
    for key, expected in model.learned():
        found = has.pop(key, None)
        if isinstance(expected, LearnedPart):
            _check_part(key, found, expected)
        elif isinstance(expected, list):
            if not isinstance(found, list) or len(found) != len(expected):
                raise ValueError(f"{key}: must be {len(expected)} parts")
            for i, (part, wanted) in enumerate(zip(found, expected, strict=True)):
                _check_part(f"{key}.{i}", part, wanted)
        else:
            _check_array(key, found, expected, limits.get(key, USUAL))
    if has:
        raise ValueError(f"{', '.join(has)}: {type(model).__name__} learns no such attribute")


def _check_words(key: str, words: Any, count: int) -> None:
    listed = words.tolist() if isinstance(words, np.ndarray) else []
    if words is not None and [isinstance(word, str) for word in listed] != [True] * count:
        raise ValueError(f"{key}: must be {count} words")


def _check_within(place: str, part: BaseEstimator) -> None:
    try:
        check_learned(part)
    except ValueError as error:
        raise ValueError(f"{place}.{error}") from error


def _check_part(place: str, found: Any, expected: LearnedPart) -> None:
    unfitted, columns = expected
    if type(found) is not type(unfitted):
        raise ValueError(f"{place}: is {type(found).__name__}; must be {type(unfitted).__name__}")
    # a cross-validation gives the readout of every fold another seed
    if describe(found, seeds=False) != describe(unfitted, seeds=False):
        raise ValueError(f"{place}: its parameters are not those that the model gives it")
    if columns is not None and getattr(found, "n_features_in_", columns) != columns:
        raise ValueError(
            f"{place}: is trained on {found.n_features_in_!r:.60} columns, but gets {columns}"
        )
    _check_within(place, found)


def _check_array(place: str, found: Any, shape: tuple[int, ...], limit: Limit) -> None:
    if not isinstance(found, np.ndarray) or found.dtype != np.float64 or found.shape != shape:
        kind = getattr(found, "dtype", type(found).__name__)
        raise ValueError(
            f"{place}: is {kind} of shape {np.shape(found)}; must be float64 of shape {shape}"
        )
    if not (limit.allows(found.min()) and limit.allows(found.max())):  # NaN is neither
        raise ValueError(f"{place}: holds {found.min():g} to {found.max():g}; each must be {limit}")
