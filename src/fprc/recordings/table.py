"""What another program's file holds: the one door to all formats."""

import difflib
import re
from collections.abc import Iterable, Iterator, Sequence
from itertools import pairwise
from pathlib import Path
from typing import Any, NamedTuple
from zipfile import ZipFile

import numpy as np

from fprc.errors import LogError
from fprc.given import open_given


class Column(NamedTuple):
    """One column of a file, or, until it is split, any array in it."""

    values: np.ndarray  #: shape (n_samples,)
    unit: str = ""  #: as the file states it, outside of the column's name
    label: str = ""  #: what the file calls it besides its name
    parts: Sequence[str] = ()  #: names of the columns of a matrix


class Table(NamedTuple):
    """What a file holds."""

    path: Path
    kind: str  #: file format, for messages
    columns: dict[str, Column]  #: by their names in a map
    others: dict[str, str]  #: reason why each other variable cannot be a channel, by name
    notes: tuple[str, ...] = ()  #: what was left out, or taken for what
    lines: np.ndarray | None = None  #: line number of each sample in a text file, from 1
    unusable: tuple[str, ...] = ()  #: lines among the samples that are none

    def sample(self, number: int) -> str:
        """Describe a sample, counted from 0, for a message."""
        line = "" if self.lines is None else f" (line {self.lines[number]})"
        return f"sample {number}{line}"

    def pick(self, name: str) -> Column:
        """Return the column that a map names; LogError, with a similar name, if there is none."""
        if name in self.columns:
            return self.columns[name]
        if name in self.others:
            raise LogError(f"cannot be a channel: {self.others[name]}")
        of_matrix = [column for column in self.columns if column.startswith(f"{name}[")]
        similar = [*of_matrix, *difflib.get_close_matches(name, self.columns)]
        near = f"did you mean {similar[0]}? " if similar else ""
        raise LogError(f"no such column; {near}`fprc import {self.path} --draft` shows all")


#: How the files of a format begin, its name, and its reader in ``fprc.recordings.formats``.
_FORMATS = (
    (b"\x89HDF", "HDF5", "read_hdf5"),
    (b"MATLAB", "MATLAB", "read_matlab"),
    (b"\x93NUMPY", "NumPy", "read_numpy"),
    (b"PK\x03\x04", "NumPy", "read_numpy"),  # or Excel
    (b"TDSm", "TDMS", "read_tdms"),
    (b"PAR1", "Parquet", "read_parquet"),
    (b"\x89MCAP0", "MCAP", "read_mcap"),
    (b"#ROSBAG", "ROS bag", "read_bag"),
    (b"SQLite format 3", "ROS 2 bag", "read_bag"),
)


def read_table(path: Path | str, **layout: Any) -> Table:
    """Read every column of a file that can be a channel; its content tells its format.

    ``layout`` is of a text, see ``fprc.recordings.text.read_text``. LogError: the file cannot be
    opened, is damaged, empty or of another format, or the library that reads it is not installed.
    """
    from fprc.recordings import formats, text

    path = Path(path)
    with open_given(path, error=LogError) as file:
        head = file.read(512)
    kind, reader = next((found[1:] for found in _FORMATS if head.startswith(found[0])), ("", ""))
    if not kind and path.suffix.lower() == ".mat":  # version 4 begins with a number
        kind, reader = "MATLAB", "read_matlab"
    if not kind:
        return text.read_text(path, **layout)
    try:
        if head.startswith(b"PK") and _is_excel(path):
            table = text.read_xlsx(path)
        else:
            table = Table(path, kind, *_gathered(getattr(formats, reader)(path)))
    except (LogError, MemoryError):
        raise
    except ImportError as error:
        raise LogError(
            f"{path}: {kind} needs the package {error.name}; install with: pip install "
            "'fprc[formats]'"
        ) from error
    except Exception as error:  # on a damaged file the libraries raise many types
        raise LogError(
            f"{path}: cannot be read as {kind} ({type(error).__name__}: {error}); the file is cut "
            "short, damaged, or of another format"
        ) from error
    if not table.columns and not table.others:
        raise LogError(f"{path}: has no content; the file is empty or cut short")
    return table._replace(columns=table.columns | joined_clocks(table.columns))


def _is_excel(path: Path) -> bool:
    with ZipFile(path) as archive:
        return any(name.startswith("xl/") for name in archive.namelist())


def _gathered(
    parts: Iterable[tuple[str, Column | str]],
) -> tuple[dict[str, Column], dict[str, str]]:
    """Return the columns in named parts of a file, and why others cannot be channels."""
    columns: dict[str, Column] = {}
    others: dict[str, str] = {}
    for name, part in parts:
        if isinstance(part, str):
            others[name] = part
            continue
        values = np.asarray(part.values)
        fields = {f"{name}.{field}": values[field] for field in values.dtype.names or ()}
        for place, array in (fields or {name: values}).items():
            found = _numbers(array)
            if isinstance(found, str):
                others[place] = found
            else:
                spread = _spread(place, found, part.parts)
                columns |= {n: Column(v, part.unit, part.label) for n, v in spread}
    return columns, others


def _numbers(array: np.ndarray) -> np.ndarray | str:
    """Return an array as numbers, times in s (dates since 1970), or why it cannot be a channel."""
    if array.size < 2:
        return "one number" if array.size else "empty"
    if array.squeeze().ndim > 2:
        return f"{array.ndim} dimensions"
    if array.dtype.kind in "mM":  # what is missing becomes NaN
        since = array if array.dtype.kind == "m" else array - np.datetime64(0, "s")
        return since / np.timedelta64(1, "s")
    if array.dtype.kind not in "fiub":
        return f"no numbers ({array.dtype})"
    return array.astype(np.float64, copy=False)


def _spread(
    name: str, values: np.ndarray, names: Sequence[str]
) -> Iterator[tuple[str, np.ndarray]]:
    """Yield the columns of an array; dimensions of length 1 are dropped.

    The longer dimension of a matrix is time; its columns are ``name[:, 0]``, its rows
    ``name[0, :]``, or ``name.part`` with the ``names`` of the parts.
    """
    array = values.squeeze()
    if array.ndim == 1:
        yield name, array
        return
    upright = array.shape[0] >= array.shape[1]
    for k, part in enumerate(array.T if upright else array):
        place = f"{name}[:, {k}]" if upright else f"{name}[{k}, :]"
        yield f"{name}.{names[k]}" if len(names) == min(array.shape) else place, part


def joined_clocks(columns: dict[str, Column]) -> dict[str, Column]:
    """Return, for each pair of columns of seconds and nanoseconds, their sum, in s.

    They stand side by side, and are named so, or the seconds count from 1970.
    """
    joined = {}
    for (name, coarse), (fine, parts) in pairwise(columns.items()):
        if len(coarse.values) != len(parts.values) or len(parts.values) < 2:
            continue
        named = re.search(r"(?<![a-z])secs?$", name) and re.search(r"n(ano)?secs?$", fine)
        counted = 1e9 < coarse.values[0] < 5e9 and np.ptp(parts.values) > 1e6
        if named or (counted and (parts.values >= 0.0).all() and parts.values.max() < 1e9):
            total = coarse.values + 1e-9 * parts.values
            joined[f"{name} + {fine.rpartition('.')[2]}"] = Column(total, "s")
    return joined
