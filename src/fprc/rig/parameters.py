"""Nested settings as one NumPy record that compiled code can read by name."""

from collections.abc import Mapping
from functools import cache
from typing import Any

import numpy as np


def record(settings: Mapping[str, Any]) -> np.ndarray:
    """Pack nested numbers into a structured array of shape (1,).

    Numbers become float64 fields, sequences fixed-length arrays, mappings
    nested records; names and order are kept.

    Parameters
    ----------
    settings : Mapping
        Names to numbers, sequences of numbers, or further mappings.

    Returns
    -------
    ndarray of shape (1,)
        Indexable by the same names, in Python and in compiled code.
    """
    return np.array([_values(settings)], dtype=_layout(_fields(settings)))


@cache
def _layout(fields: tuple[Any, ...]) -> np.dtype:
    # one object per layout: numba compares two equal dtypes for longer than a tick takes
    return np.dtype([(name, _type(kind), *shape) for name, kind, *shape in fields])


def _type(kind: tuple[Any, ...] | None) -> np.dtype:
    return np.dtype(np.float64) if kind is None else _layout(kind)


def _fields(settings: Mapping[str, Any]) -> tuple[Any, ...]:
    fields: list[tuple[Any, ...]] = []
    for name, value in settings.items():
        if isinstance(value, Mapping):
            fields.append((name, _fields(value)))
        elif isinstance(value, (list, tuple)):
            fields.append((name, None, (len(value),)))
        else:
            fields.append((name, None))
    return tuple(fields)


def _values(settings: Mapping[str, Any]) -> tuple[Any, ...]:
    values: list[Any] = []
    for value in settings.values():
        if isinstance(value, Mapping):
            values.append(_values(value))
        elif isinstance(value, (list, tuple)):
            values.append(tuple(float(item) for item in value))
        else:
            values.append(float(value))
    return tuple(values)
