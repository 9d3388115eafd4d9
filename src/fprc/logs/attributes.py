"""Attributes of HDF5 files, checked once, where they are read."""

import json
import math
import reprlib
from collections.abc import Mapping
from typing import Any

import h5py
import numpy as np

from fprc.errors import LogError

#: What must be of its kind wherever it is; ``dict``: a JSON object.
KINDS = {
    "experiment": str,
    "source": str,
    "simulated": bool,
    "sample_rate_hz": float,
    "seed": int,
    "software": str,
    "rig": dict,
    "controller": str,
    "gain": str,
    "reference": str,
    "settle_s": float,
    "complete": bool,
    "incomplete_reason": str,
    "aborted": str,
    "lost_samples": int,
    "started": str,
    "statistics": dict,
    "notes": dict,
    "map": dict,
    "imported_from": str,
    "imported_sha256": str,
    "imported_start_s": float,
    "units": str,
    "crc32": int,
}
#: Of these, what a channel has.
OF_A_CHANNEL = ("units", "crc32")
_WORDS = {
    str: "text",
    bool: "true or false",
    float: "a finite number",
    int: "a whole number",
    dict: "a JSON object",
}


def read_attributes(
    holder: h5py.AttributeManager,
) -> tuple[dict[str, Any], dict[str, str]]:
    """Return the attributes of a file or of a dataset, and what is wrong with others.

    Numbers and text are as Python has them, JSON is parsed. What is not of ``KINDS`` and no
    number or text is left out.
    """
    found, wrong = {}, {}
    for name in filter(is_text, holder):
        try:
            found[name] = read_attribute(holder, name)
        except (LogError, TypeError) as error:  # TypeError: of a type that Python does not have
            if name in KINDS:
                wrong[name] = str(error)
    return found, wrong


def read_attribute(holder: h5py.AttributeManager, name: str, *, mend: bool = False) -> Any:
    """Return one attribute.

    Parameters
    ----------
    mend : bool, default=False
        Replace what is not UTF-8 instead of refusing it.

    Raises
    ------
    LogError
        It is not of its kind, or neither a finite number nor text; the message does not name it.
    """
    # many values may be more than memory holds; an empty one has none
    if holder.get_id(name).get_space().get_simple_extent_npoints() != 1:
        raise LogError("no single value")
    value = holder[name]
    value = value.ravel()[0] if isinstance(value, np.ndarray) else value
    value = value.item() if isinstance(value, np.generic) else value
    if isinstance(value, bytes):
        value = value.decode("utf-8", "surrogateescape")
    kind = KINDS.get(name)
    if isinstance(value, str):
        if mend:
            value = value.encode("utf-8", "surrogateescape").decode("utf-8", "replace")
        if not is_text(value):
            raise LogError(
                f"= {reprlib.repr(value)}: is not UTF-8; write it again, or let `fprc log repair` "
                "replace what is not"
            )
        return _object(name, value) if kind is dict else _of_kind(value, kind or str)
    if not isinstance(value, bool | int | float):
        raise LogError("neither text nor a number")
    return _of_kind(value, kind or type(value))


def wrong_kinds(attributes: Mapping[str, Any]) -> list[str]:
    """Return what is wrong with attributes that have their kinds already, as JSON gives them."""
    wrong = []
    for name, kind in KINDS.items():
        if name in attributes:
            try:
                _of_kind(attributes[name], kind)
            except LogError as error:
                wrong.append(f"{name} {error}")
    return wrong


def is_text(text: str | bytes) -> bool:
    """Whether text, or a name, was UTF-8 in the file; else the library may give bytes."""
    if isinstance(text, bytes):
        return False
    try:
        text.encode("utf-8")
    except UnicodeEncodeError:
        return False
    return True


def _of_kind(value: Any, kind: type) -> Any:
    fitting = (float, int) if kind is float else kind
    finite = not isinstance(value, float) or math.isfinite(value)
    if not isinstance(value, fitting) or (isinstance(value, bool) and kind is not bool):
        finite = False
    if not finite:
        raise LogError(f"= {reprlib.repr(value)}: must be {_WORDS[kind]}; see data/raw/README.md")
    return value


def _object(name: str, text: str) -> dict[str, Any]:
    try:
        found = json.loads(text, parse_float=_finite, parse_constant=_finite)
        json.dumps(found, ensure_ascii=False).encode("utf-8")  # half characters, as \\udce9
    except (ValueError, RecursionError) as error:
        raise LogError(f"= {reprlib.repr(text)}: must be a JSON object ({error})") from error
    if not isinstance(found, dict):
        raise LogError(f"= {reprlib.repr(text)}: must be a JSON object; see data/raw/README.md")
    if name == "notes" and not all(isinstance(note, str) for note in found.values()):
        raise LogError(f"= {reprlib.repr(text)}: must have a text for each channel")
    return found


def _finite(text: str) -> float:
    if not math.isfinite(float(text)):
        raise ValueError(f"{text[:40]} is not finite")
    return float(text)


def as_written(value: Any) -> Any:
    """Return an attribute as HDF5 keeps it: text of its own length, JSON where it is no scalar.

    Text of any length the library would keep where no checksum covers it. JSON has no NaN.
    """
    if not isinstance(value, str | bool | int | float | np.generic):
        value = json.dumps(json.loads(json.dumps(value), parse_constant=lambda text: None))
    if isinstance(value, str):
        text = value.encode("utf-8")
        return np.array(text, dtype=h5py.string_dtype("utf-8", max(len(text), 1)))
    return value
