"""MATLAB files up to version 7, and MATLAB's notation for the parts of variables."""

import struct
import zlib
from collections.abc import Iterator
from contextlib import suppress
from itertools import chain, starmap
from pathlib import Path
from typing import Any

import numpy as np
import scipy.io
from scipy.io.matlab import MatlabFunction, MatlabOpaque

from fprc.errors import LogError
from fprc.logs.variables import MOST_NUMBERS, MOST_VARIABLES, Part, Source, collect

_COMPRESSED = 15
_CHUNK_BYTES = 1 << 20


def elements(shape: tuple[int, ...]) -> Iterator[tuple[tuple[int, ...], str]]:
    """Yield the indices of an array, column by column, and their MATLAB notation.

    MATLAB counts from 1; a vector has one index.
    """
    vector = sum(n > 1 for n in shape) < 2
    for reverse in np.ndindex(*reversed(shape)):
        index = reverse[::-1]
        numbers = [max(index, default=0)] if vector else index
        yield index, ",".join(str(1 + i) for i in numbers)


def read_matlab(path: Path) -> Source:
    """Read a file of MATLAB 4 to 7 (not 7.3).

    Structs, struct arrays and cell arrays are split into parts, which are named as in
    MATLAB: ``s.y``, ``s(2).y``, ``c{1}.y``. A field that is a scalar in every element of a
    struct array becomes an array, ``[s.y]``.

    Raises
    ------
    LogError
        The file is damaged, or too large.
    """
    _refuse_large(path)
    return collect(path, "MATLAB 5", "MATLAB", _read_parts(path))


def _refuse_large(path: Path) -> None:
    """Decompress the variables piece by piece, and refuse a file that becomes too large."""
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
            f"{path}: its variables need more than {most >> 20} MB; save only those that you "
            "need, or save them as HDF5"
        )


def _unpacked_bytes(packed: bytes, most: int) -> int:
    """Return the decompressed size in bytes; stop counting soon after ``most``."""
    unpacker, size = zlib.decompressobj(), 0
    with suppress(zlib.error):  # reported when the variable is read
        while packed and size <= most:
            size += len(unpacker.decompress(packed, _CHUNK_BYTES))
            packed = unpacker.unconsumed_tail
    return size


def _read_parts(path: Path) -> Iterator[Part]:
    content = scipy.io.loadmat(path, verify_compressed_data_integrity=True)
    variables = {name: value for name, value in content.items() if not name.startswith("__")}
    parts = chain.from_iterable(starmap(_parts, variables.items()))
    for count, part in enumerate(parts):
        if count == MOST_VARIABLES:
            raise LogError(
                f"{path}: more than {MOST_VARIABLES} arrays; save structs and cells as arrays"
            )
        yield part


def _parts(name: str, value: Any) -> Iterator[Part]:
    """Yield the numeric arrays in a variable, and why its other parts cannot be channels."""
    if isinstance(value, MatlabOpaque):
        # variable name, type system and class name
        header = [field.decode() for field in value[0].item()[:3] if isinstance(field, bytes)]
        yield header[0] if header else name, OBJECT.format(header[-1] if header else "object")
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


def _struct(name: str, value: np.ndarray) -> Iterator[Part]:
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


#: Reasons why a part of a file cannot be a channel.
EMPTY = "empty"
SPARSE = "a sparse matrix; save full(...) of it"
OBJECT = (
    "a MATLAB {}; save a table or timetable T as "
    "table2struct(timetable2table(T), 'ToScalar', true), and times in seconds"
)
