"""What a model learns, declared by its class, and a model that is made again from it.

Each class of this package has a method ``learned`` that yields pairs: the name of a learned
attribute, and its ``Array``, the ``LearnedPart`` that it holds, or a list of these.
A class from outside, which may learn anything, is not checked; its parts of this package are.
"""

from collections.abc import Iterator
from typing import Any, NamedTuple

import numpy as np
from sklearn.base import BaseEstimator, clone

from fprc.limits import Limit, Whole
from fprc.models.limits import MOST_FEATURES, Array, Words, check_limits


class LearnedPart(NamedTuple):
    """A part of a model: as it is before ``fit``, and the columns that it gets; None is any."""

    unfitted: BaseEstimator
    n_features_in: int | None


#: What ``learned`` yields beside a name.
Learned = Array | LearnedPart | list[LearnedPart]

#: What a model may know, or not.
_OPTIONAL = {"feature_names_in_", "information_", "sample_rate_hz_", "units_"}


def is_built_in(model: BaseEstimator) -> bool:
    """Return whether the class of a model is of this package."""
    return type(model).__module__.startswith(f"{__package__}.")


def is_learned(key: str) -> bool:
    """Return whether an attribute of this name is learned."""
    return key.isidentifier() and key.endswith("_") and not key.startswith("_")


def features_of(features: Any) -> int | None:
    """Return the number of features of a fitted map; None if its class is from outside."""
    return features.count_features() if is_built_in(features) else None


def rows_of(features: Any) -> Any:
    """Return the rows of a fitted map; None if its class is from outside and may change them."""
    return features.rows() if is_built_in(features) else None


def restore(
    unfitted: BaseEstimator, values: dict[str, Any], place: str = "", columns: int | None = None
) -> Any:
    """Return a fitted copy of an estimator, whose parts are made as ``fit`` makes them.

    Parameters
    ----------
    values : dict
        Learned attributes, by their place in the model, such as ``readout_.W_out_``; those of this
        estimator, whose place is ``place``, and of its parts are taken out.
    columns : int, optional
        Columns that it gets; by default any number.
    """
    model, ours = clone(unfitted), is_built_in(unfitted)
    keys = [name.removeprefix(place) for name in values if name.startswith(place)]
    own = {key: values.pop(place + key) for key in keys if is_learned(key)}
    if ours:
        check_limits(model, getattr(model, "LIMITS", {}))
    else:
        vars(model).update(own)
    for key, expected in _declared(model, columns):
        if isinstance(expected, LearnedPart):
            setattr(model, key, restore(expected[0], values, f"{place}{key}.", expected[1]))
        elif isinstance(expected, list):
            parts = [
                restore(p, values, f"{place}{key}.{i}.", n) for i, (p, n) in enumerate(expected)
            ]
            setattr(model, key, parts)
        elif key in own or key not in _OPTIONAL:
            value = own.pop(key, None)
            if not expected.allows(value):
                found = f"{value!r:.60}"
                if isinstance(value, np.ndarray):
                    found = f"{value.dtype} of shape {value.shape}, such as {value.ravel()[:1]}"
                raise ValueError(f"{place}{key}: {found}; must be {expected}")
            setattr(model, key, value)
    if ours and own:
        raise ValueError(f"{place}: {type(model).__name__} learns no {', '.join(own)}")
    return model


def _declared(model: Any, columns: int | None) -> Iterator[tuple[str, Any]]:
    """Yield what a model learns; the next thing only after the one before is set."""
    ours = is_built_in(model)
    if ours:
        yield "n_features_in_", Whole(columns or 1, columns or MOST_FEATURES)
        yield "feature_names_in_", Words(model.n_features_in_)
    yield "units_", Words(1 + model.n_features_in_ if ours else None)
    yield "sample_rate_hz_", Limit(1e-3, 1e6)
    for key, expected in model.learned() if hasattr(model, "learned") else ():
        if ours or not isinstance(expected, Array):
            yield key, expected
