"""Attributes of HDF5 files, with a check of their types."""

import json
import math
import reprlib
from typing import Any

import h5py
import numpy as np

from fprc.artifacts import parse_object
from fprc.errors import LogError

#: Type of each known attribute; ``dict``: a JSON object.
KINDS = {
    "experiment": str,
    "source": str,
    "sample_rate_hz": float,
    "seed": int,
    "software": str,
    "rig": dict,
    "controller": str,
    "model": str,
    "model_file": str,
    "model_sha256": str,
    "reference": str,
    "settle_s": float,
    "complete": bool,
    "incomplete_reason": str,
    "lost_samples": int,
    "started": str,
    "statistics": dict,
    "notes": dict,
    "recordings": dict,
    "map": dict,
    "imported_from": str,
    "imported_sha256": str,
    "imported_start_s": float,
    "units": str,  # of a channel; all others belong to the file
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
    and are neither a number nor text are skipped.
    """
    valid, problems = {}, []
    for name in filter(is_text, holder):
        try:
            valid[name] = _read_attribute(holder, name)
        except (LogError, TypeError) as error:  # TypeError: no Python equivalent of its type
            if name in KINDS:
                why = str(error)
                problems.append(f"attribute {name}{' ' if why.startswith('=') else ': '}{why}")
    return valid, problems


def _read_attribute(holder: h5py.AttributeManager, name: str) -> Any:
    """Return one attribute.

    Raises
    ------
    LogError
        Its type is wrong, or it is neither a finite number nor text. The message does not
        contain the attribute's name.
    """
    # an array may be too large for memory, or empty
    if holder.get_id(name).get_space().get_simple_extent_npoints() != 1:
        raise LogError("must be one value, not an array")
    value = np.asarray(holder[name]).item()
    if isinstance(value, bytes):
        value = value.decode("utf-8", "surrogateescape")
    if isinstance(value, str) and not is_text(value):
        raise LogError(f"= {reprlib.repr(value)}: is not UTF-8; write it again")
    kind = KINDS.get(name, type(value))
    if kind is dict and isinstance(value, str):
        return _object(name, value)
    # not isinstance, for which a bool is an int
    accepted = type(value) in ((float, int) if kind is float else (kind,)) and kind in _WORDS
    if not accepted or (isinstance(value, float) and not math.isfinite(value)):
        must = _WORDS.get(kind, "text or a number")
        raise LogError(f"= {reprlib.repr(value)}: must be {must}; see data/raw/README.md")
    return value


def is_text(text: str | bytes) -> bool:
    """Return whether a name or text is UTF-8; if not, h5py returns bytes or lone surrogates."""
    return isinstance(text, str) and text == text.encode("utf-8", "replace").decode("utf-8")


def _object(name: str, text: str) -> dict[str, Any]:
    try:
        content = parse_object(text)
        # refuses NaN and lone surrogates, as \udce9
        json.dumps(content, ensure_ascii=False, allow_nan=False).encode("utf-8")
    except (ValueError, RecursionError) as error:
        raise LogError(f"= {reprlib.repr(text)}: must be a JSON object ({error})") from error
    if name == "notes" and not all(isinstance(note, str) for note in content.values()):
        raise LogError(f"= {reprlib.repr(content)}: must map each channel to a text")
    return content


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
