"""MATLAB files up to version 7, and how MATLAB writes the parts of its variables."""

import struct
import zlib
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

import numpy as np
import scipy.io
from scipy.io.matlab import MatlabFunction, MatlabOpaque

from fprc.errors import LogError
from fprc.logs.variables import MOST_NUMBERS, MOST_VARIABLES, Source, sorted_out

_COMPRESSED = 15
_CHUNK_BYTES = 1 << 20


def elements(shape: tuple[int, ...]) -> Iterator[tuple[tuple[int, ...], str]]:
    """Yield the indices of an array down its columns, and MATLAB's way to write them.

    It counts from 1; one number does for a vector.
    """
    vector = sum(n > 1 for n in shape) < 2
    for reverse in np.ndindex(*reversed(shape)):
        index = reverse[::-1]
        numbers = [max(index, default=0)] if vector else index
        yield index, ",".join(str(1 + i) for i in numbers)


def read_matlab(path: Path) -> Source:
    """Read a file of MATLAB 4 to 7 (not 7.3).

    Structs, struct arrays and cell arrays are taken apart; their parts have the
    names that MATLAB gives them: ``s.y``, ``s(2).y``, ``c{1}.y``. A field that is one
    number in every element of a struct array is an array, ``[s.y]``.

    Raises
    ------
    LogError
        The file is damaged, or too large.
    """
    _refuse_large(path)
    variables: dict[str, np.ndarray] = {}
    others: dict[str, str] = {}
    try:
        content = scipy.io.loadmat(path, verify_compressed_data_integrity=True)
        for name, part in _variables(content):
            if isinstance(part, str):
                others[name] = part
            else:
                variables[name] = part.astype(np.float64)
            if len(variables) + len(others) > MOST_VARIABLES:
                raise LogError(
                    f"{path}: more than {MOST_VARIABLES} arrays; save structs and cells as arrays"
                )
    except (LogError, MemoryError):
        raise
    except Exception as error:  # the library raises whatever it stumbles over
        raise LogError(
            f"{path}: cannot be read as MATLAB ({type(error).__name__}: {error}); the file is "
            "cut short, damaged, or something else"
        ) from error
    return Source(path, "MATLAB 5", *sorted_out(path, variables, others))


def _refuse_large(path: Path) -> None:
    """Unpack what is compressed, a piece at a time, and refuse what is too much."""
    most = 8 * MOST_NUMBERS
    size = path.stat().st_size
    with path.open("rb") as file:
        order = {b"IM": "<", b"MI": ">"}.get(file.read(128)[126:])
        while order and size <= most and len(tag := file.read(8)) == 8:
            kind, length = struct.unpack(f"{order}II", tag)
            if kind == _COMPRESSED:
                size += _unpacked_bytes(file.read(length), most)
            else:
                file.seek(length, 1)
    if size > most:
        raise LogError(
            f"{path}: its variables take more than {most >> 20} MB; save only those that are "
            "needed, or as HDF5"
        )


def _unpacked_bytes(packed: bytes, most: int) -> int:
    """Return how many bytes this is unpacked, or soon after ``most``."""
    unpacker, size = zlib.decompressobj(), 0
    try:
        while packed and size <= most:
            size += len(unpacker.decompress(packed, _CHUNK_BYTES))
            packed = unpacker.unconsumed_tail
    except zlib.error:
        pass  # who reads the variable says what is wrong
    return size


def _variables(content: Mapping[str, Any]) -> Iterator[tuple[str, np.ndarray | str]]:
    for name, value in content.items():
        if not name.startswith("__"):  # what the library says of the file
            yield from _parts(name, value)


def _parts(name: str, value: Any) -> Iterator[tuple[str, np.ndarray | str]]:
    """Yield the arrays of numbers in a variable; for what is none, why it cannot be a channel."""
    if isinstance(value, MatlabOpaque):
        told = [field.decode() for field in value[0].item()[:3] if isinstance(field, bytes)]
        yield told[0] if told else name, OBJECT.format(told[-1] if told else "object")
    elif isinstance(value, MatlabFunction):
        yield name, OBJECT.format("function")
    elif not isinstance(value, np.ndarray):
        yield name, SPARSE
    elif value.size == 0:
        yield name, EMPTY
    elif value.dtype.names:
        yield from _struct(name, value)
    elif value.dtype == object:
        for index, text in elements(value.shape):
            yield from _parts(f"{name}{{{text}}}", value[index])
    elif value.dtype.kind in "fiub":
        yield name, value
    else:
        yield name, "text" if value.dtype.kind in "US" else f"numbers of type {value.dtype}"


def _struct(name: str, value: np.ndarray) -> Iterator[tuple[str, np.ndarray | str]]:
    for field in value.dtype.names or ():
        each = [(value[field][index], text) for index, text in elements(value.shape)]
        if len(each) == 1:
            yield from _parts(f"{name}.{field}", each[0][0])
        elif all(isinstance(part, np.ndarray) and part.size == 1 and part.dtype.kind in "fiub"
                 for part, _ in each):  # fmt: skip
            yield f"[{name}.{field}]", np.array([part.item() for part, _ in each])
        else:
            for part, text in each:
                yield from _parts(f"{name}({text}).{field}", part)


#: Why a part of a file is no channel.
EMPTY = "empty"
SPARSE = "a sparse matrix; save full(...) of it"
OBJECT = (
    "a MATLAB {}; save a table or timetable T as "
    "table2struct(timetable2table(T), 'ToScalar', true), and times in seconds"
)
