"""Arrays in the HDF5 and MATLAB files of other programs."""

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import h5py
import numpy as np

from fprc.errors import LogError
from fprc.given import open_given
from fprc.logs.columns import refuse_never_written
from fprc.recordings.source import Source

#: Name of an array in a file; and the array, or why it cannot be a channel.
_Part = tuple[str, np.ndarray | str]


def read_arrays(path: Path, *, matlab: bool) -> Source:
    """Read every array of an HDF5 or MATLAB file; dimensions of length 1 are dropped.

    A matrix is split into columns ``name[:, 0]`` or rows ``name[0, :]``: its longer dimension is
    taken to be time.

    Structs and cell arrays are split into parts, which are named as in MATLAB: ``s.y``,
    ``c{1}.y``, and so are tables and timetables: ``T.y``. A struct array of several elements is
    not split. Durations become seconds, dates seconds since 1970. Links in an HDF5 file are not
    followed.

    Raises
    ------
    LogError
        The file cannot be opened, is damaged, cut short or empty.
    """
    open_given(path, error=LogError).close()
    of_matlab = "MATLAB 7.3" if h5py.is_hdf5(path) else "MATLAB 5"
    kind = of_matlab if matlab else "HDF5"
    columns: dict[str, np.ndarray] = {}
    others = {}
    try:
        parts = _parts_of_matlab(path) if matlab else _parts_of_hdf5(path)
        for name, part in parts:
            values = _numbers_of(part)
            if isinstance(values, str):
                others[name] = values
                continue
            array = values.reshape([n for n in values.shape if n != 1])
            if array.ndim == 1:
                columns[name] = array
            elif array.ndim != 2:
                others[name] = f"array of shape {values.shape}"
            elif array.shape[0] >= array.shape[1]:
                columns |= {f"{name}[:, {j}]": column for j, column in enumerate(array.T)}
            else:
                columns |= {f"{name}[{j}, :]": row for j, row in enumerate(array)}
    except (LogError, MemoryError):
        raise
    except Exception as error:  # on a damaged file the libraries raise many types
        raise LogError(
            f"{path}: cannot be read as {kind} ({type(error).__name__}: {error}); the file is "
            "cut short, damaged, or of another format"
        ) from error
    if not columns and not others:
        raise LogError(f"{path}: has no content; the file is empty or cut short")
    return Source(path, kind, columns, others)


def _parts_of_hdf5(path: Path) -> Iterator[_Part]:
    def within(group: h5py.Group, prefix: str = "") -> Iterator[_Part]:
        for name in group:
            link = group.get(name, getlink=True)
            if not isinstance(link, h5py.HardLink):
                where = getattr(link, "filename", "") or link.path
                yield f"{prefix}{name}", f"a link to {where}, which is not followed"
            elif isinstance(member := group[name], h5py.Group):
                yield from within(member, f"{prefix}{name}/")
            else:
                yield f"{prefix}{name}", _read(member)

    with h5py.File(path, "r") as file:
        yield from within(file)


def _parts_of_matlab(path: Path) -> Iterator[_Part]:
    from matio import load_from_mat

    for name, value in load_from_mat(str(path)).items():
        if not name.startswith("__"):
            yield from _parts(name, value)


def _parts(name: str, thing: Any) -> Iterator[_Part]:
    """Yield the arrays in a MATLAB variable, and why its other parts cannot be channels."""
    from pandas import DataFrame

    if isinstance(thing, DataFrame):  # a table, or a timetable, whose times are the index
        table = thing.reset_index() if thing.index.name else thing
        for column in table:
            yield f"{name}.{column}", table[column].to_numpy()
    elif not isinstance(thing, np.ndarray):
        yield name, f"MATLAB's {getattr(thing, 'classname', type(thing).__name__)}; save numbers"
    elif thing.dtype.names and thing.size == 1:
        for field in thing.dtype.names:
            yield from _parts(f"{name}.{field}", thing[field].item())
    elif thing.dtype.names and thing.size:
        yield name, f"a struct array of {thing.size} elements; save each as a variable of its own"
    elif thing.dtype == object and thing.size:
        for index, element in enumerate(thing.ravel("F"), 1):
            yield from _parts(f"{name}{{{index}}}", element)
    else:
        yield name, thing


def _numbers_of(part: np.ndarray | str) -> np.ndarray | str:
    """Return the numbers of a part, or why it cannot be a channel."""
    if isinstance(part, str):
        return part
    if not part.size:
        return "empty"
    if part.dtype.kind in "mM":  # times; what is missing becomes NaN
        since = part if part.dtype.kind == "m" else part - np.datetime64(0, "s")
        return since / np.timedelta64(1, "s")
    if part.dtype.kind not in "fiub":
        return "text" if part.dtype.kind in "USO" else f"numbers of type {part.dtype}"
    return part.astype(np.float64, copy=False)


def _read(dataset: h5py.Dataset) -> np.ndarray | str:
    """Return the array in a dataset, or, mostly from its metadata, why it cannot be a channel."""
    if not dataset.size:
        return "empty"
    if dataset.ndim > 2 or dataset.dtype.kind not in "fiub":
        return f"{dataset.dtype} of shape {dataset.shape}"
    if dataset.external or dataset.is_virtual:
        return "stored in another file; copy it into this one"
    try:
        refuse_never_written(dataset)
        return dataset[()]
    except LogError as error:
        return str(error)
    except (OSError, RuntimeError) as error:  # other datasets may be readable
        return f"cannot be read ({error})"
