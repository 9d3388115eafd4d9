"""Attributes of HDF5 files, with a check of their types."""

import json
import math
import os
from typing import Any

import h5py
import numpy as np

from fprc.artifacts import parse_object

#: Type of each known attribute; ``dict``: a JSON object. ``units`` belongs to a channel, all others
#: to the file.
KINDS: dict[str, type] = {
    **dict.fromkeys(("experiment", "source", "software", "started", "units"), str),
    **dict.fromkeys(("controller", "reference", "model", "model_file", "model_sha256"), str),
    **dict.fromkeys(("incomplete_reason", "imported_from", "imported_sha256"), str),
    **dict.fromkeys(("sample_rate_hz", "settle_s", "imported_start_s"), float),
    **dict.fromkeys(("seed", "lost_samples"), int),
    **dict.fromkeys(("rig", "statistics", "notes", "recordings", "map"), dict),
    "complete": bool,
}
_WORDS = {
    str: "text",
    bool: "true or false",
    float: "a finite number",
    int: "a whole number",
    dict: "a JSON object",
}


def read_attributes(holder: h5py.AttributeManager) -> tuple[dict[str, Any], list[str]]:
    """Return the valid attributes of a file or dataset, and an error text for each invalid one.

    Values are Python numbers and text; JSON is parsed. Attributes that are not in ``KINDS``
    and are neither a finite number nor text are skipped.
    """
    valid, problems = {}, []
    for name in holder:
        try:
            valid[name] = _value(name, holder[name])
        except (ValueError, TypeError, RecursionError) as error:
            if name in KINDS:
                problems.append(
                    f"attribute {name}: must be {_WORDS[KINDS[name]]} ({error!s:.200}); see "
                    "data/raw/README.md"
                )
    return valid, problems


def _value(name: str, stored: Any) -> Any:
    value = np.asarray(stored).item()  # of an array of several values, an error
    if isinstance(value, str | bytes):  # of other programs also in other encodings
        value = (value if isinstance(value, bytes) else os.fsencode(value)).decode("utf-8")
    kind = KINDS.get(name, type(value))
    if kind is dict:
        value = parse_object(value)
        json.dumps(value, allow_nan=False)
        if name == "notes" and not all(isinstance(note, str) for note in value.values()):
            raise ValueError("each channel has a text")
    # not isinstance, for which a bool is an int
    elif type(value) not in ((float, int) if kind is float else (kind,)) or kind not in _WORDS:
        raise TypeError(f"is of type {type(value).__name__}")
    elif isinstance(value, float) and not math.isfinite(value):
        raise ValueError("is not finite")
    return value


def as_written(value: Any) -> Any:
    """Return the form in which HDF5 stores an attribute: a number, or text of fixed length.

    Anything but a number or text becomes JSON, in which NaN and infinity become null. Text of
    variable length would lie outside the checksums of HDF5.
    """
    if not isinstance(value, str | bool | int | float | np.generic):
        value = json.dumps(json.loads(json.dumps(value), parse_constant=lambda text: None))
    if isinstance(value, str):
        text = value.encode("utf-8", "backslashreplace")  # a name that is not UTF-8 has surrogates
        return np.array(text, dtype=h5py.string_dtype("utf-8", max(len(text), 1)))
    return value
