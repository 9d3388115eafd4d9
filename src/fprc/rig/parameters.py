"""Nested settings as one NumPy record that compiled code can read by name."""

from collections.abc import Mapping
from functools import cache
from typing import Any

import numpy as np


def record(settings: Mapping[str, Any]) -> np.ndarray:
    """Pack nested numbers into a structured array of shape (1,).

    Numbers become float64 fields, sequences fixed-length arrays, mappings nested records; names
    and order are kept, in Python and in compiled code.
    """
    return np.array([_values(settings)], dtype=_layout(_fields(settings)))


@cache
def _layout(fields: tuple[Any, ...]) -> np.dtype:
    # one object per layout: numba compares two equal dtypes for longer than a tick takes
    return np.dtype(
        [(name, np.float64 if of is None else _layout(of), shape) for name, of, shape in fields]
    )


def _fields(settings: Mapping[str, Any]) -> tuple[Any, ...]:
    """Return the name of each entry, its fields if it has any, and its shape."""
    return tuple(
        (name, _fields(value), ()) if isinstance(value, Mapping) else (name, None, np.shape(value))
        for name, value in settings.items()
    )


def _values(value: Any) -> Any:
    if isinstance(value, Mapping):
        return tuple(map(_values, value.values()))
    return tuple(map(float, value)) if isinstance(value, (list, tuple)) else float(value)
