"""Arrays in MATLAB files."""

import warnings
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np

from fprc.recordings.table import Column, Table, gathered

#: Fields of a struct that name and describe the numbers beside them, as Simulink and dSPACE do.
_LABELS, _UNITS = ("label", "Label", "Name", "name", "title"), ("Unit", "unit", "units", "Units")


def read_matlab(path: Path) -> Table:
    """Read every array of a MATLAB file, any version.

    Structs, struct arrays and cell arrays are split into parts, named as in MATLAB: ``s.y``,
    ``s(2).y``, ``c{1}.y``, and so are tables and timetables: ``T.y``. Durations become seconds,
    dates seconds since 1970.
    """
    from matio import load_from_mat

    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # of objects that are not numbers
        content = load_from_mat(str(path))
    parts = (
        part
        for name, value in content.items()
        if not name.startswith("__")
        for part in _parts(name, value)
    )
    return gathered(path, "MATLAB", parts)


def _parts(name: str, thing: Any) -> Iterator[tuple[str, Column | str]]:
    """Yield the arrays in a MATLAB variable, and why its other parts cannot be channels."""
    from pandas import DataFrame

    if isinstance(thing, DataFrame):  # a table, or a timetable, whose times are the index
        table = thing.reset_index() if thing.index.name else thing
        for column in table:
            yield f"{name}.{column}", Column(table[column].to_numpy())
    elif isinstance(getattr(thing, "properties", None), dict):  # an object
        for field, value in thing.properties.items():
            yield from _parts(f"{name}.{field}", value)
    elif isinstance(thing, str) or (isinstance(thing, np.ndarray) and thing.dtype.kind == "U"):
        return
    elif not isinstance(thing, np.ndarray):
        yield name, f"MATLAB's {getattr(thing, 'classname', type(thing).__name__)}; save numbers"
    elif thing.dtype.names and thing.size:
        for index, element in enumerate(thing.ravel("F"), 1):
            place = name if thing.size == 1 else f"{name}({index})"
            label, unit = _text(element, _LABELS), _text(element, _UNITS)
            for field in thing.dtype.names:
                for part, value in _parts(f"{place}.{field}", element[field]):
                    if not isinstance(value, str):
                        value = value._replace(label=value.label or label, unit=value.unit or unit)
                    yield part, value
    elif thing.dtype == object and thing.size == 1:
        yield from _parts(f"{name}{{1}}" if thing.ndim else name, thing.ravel()[0])
    elif thing.dtype == object and thing.size:
        for index, element in enumerate(thing.ravel("F"), 1):
            yield from _parts(f"{name}{{{index}}}", element)
    else:
        yield name, Column(thing)


def _text(element: Any, fields: tuple[str, ...]) -> str:
    """Return the text of the first of these fields that a struct has; empty without one."""
    for field in fields:
        if field in element.dtype.names:
            value = np.ravel(element[field])
            if value.size == 1 and isinstance(value[0], str):
                return str(value[0])
    return ""
