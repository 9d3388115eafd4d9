"""Arrays in the HDF5 and MATLAB files of other programs.

A MATLAB file up to version 7 is read by SciPy, one of version 7.3 is HDF5. Both hold nested structs
and cell arrays; one function splits them into arrays.
"""

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import h5py
import numpy as np
import scipy.io
from scipy.io.matlab import MatlabFunction, MatlabOpaque

from fprc.errors import LogError
from fprc.given import open_given
from fprc.logs.attributes import read_attribute
from fprc.logs.hdf5 import SIGNATURE, refuse_never_written
from fprc.logs.source import Source

#: Most arrays in an HDF5 file, and most elements of a cell or struct array in it; the library takes
#: 0.2 ms for each.
MOST_ARRAYS = 10_000
#: MATLAB's numeric classes.
_NUMBERS = {"double", "single", "logical"} | {
    f"{sign}int{bits}" for sign in ("", "u") for bits in (8, 16, 32, 64)
}
#: Reasons why a part of a file cannot be a channel.
_EMPTY = "empty"
_SPARSE = "a sparse matrix; save full(...) of it"
_OBJECT = (
    "a MATLAB {}; save a table or timetable T as "
    "table2struct(timetable2table(T), 'ToScalar', true), and times in seconds"
)

#: Name of an array in a file; and the array, its dataset, or why it cannot be a channel.
_Part = tuple[str, np.ndarray | h5py.Dataset | str]


def read_arrays(path: Path, *, matlab: bool) -> Source:
    """Read every array of an HDF5 or MATLAB file; dimensions of length 1 are dropped.

    A matrix is split into columns ``name[:, 0]`` or rows ``name[0, :]``: its longer dimension is
    taken to be time.

    Structs, struct arrays and cell arrays are split into parts, which are named as in
    MATLAB: ``s.y``, ``s(2).y``, ``c{1}.y``. A field that is a scalar in every element of a
    struct array becomes an array, ``[s.y]``. Links are not followed.

    Raises
    ------
    LogError
        The file cannot be opened, is damaged, cut short, empty, or has too many parts.
    """
    with open_given(path, error=LogError) as file:
        head = file.read(10)
    if not matlab:
        kind, parts = "HDF5", _parts_of_hdf5(path)
    elif head.startswith((SIGNATURE, b"MATLAB 7.3")):
        kind, parts = "MATLAB 7.3", _parts_of_matlab73(path)
    else:
        kind, parts = "MATLAB 5", _parts_of_matlab5(path)
    columns: dict[str, np.ndarray] = {}
    others = {}
    try:
        for count, (name, part) in enumerate(parts):
            if count == MOST_ARRAYS and kind != "MATLAB 5":
                raise _too_many(path)
            values = _numbers_of(part)
            if isinstance(values, str):
                others[name] = values
                continue
            if kind == "MATLAB 7.3":  # MATLAB stores arrays by columns
                values = values.T
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


def _too_many(path: Path | str) -> LogError:
    return LogError(
        f"{path}: more than {MOST_ARRAYS:,} arrays; save the columns as one matrix, or a struct "
        "array as a struct of arrays"
    )


def _parts_of_hdf5(path: Path) -> Iterator[_Part]:
    def within(group: h5py.Group, prefix: str = "") -> Iterator[_Part]:
        for name, member in _members(group):
            if isinstance(member, h5py.Group):
                yield from within(member, f"{prefix}{name}/")
            else:
                yield f"{prefix}{name}", member

    with h5py.File(path, "r") as file:
        yield from within(file)


def _parts_of_matlab73(path: Path) -> Iterator[_Part]:
    with h5py.File(path, "r") as file:
        for name, member in _members(file):
            if not name.startswith("#"):  # MATLAB's storage for the targets of references
                yield from _parts(name, member)


def _parts_of_matlab5(path: Path) -> Iterator[_Part]:
    content = scipy.io.loadmat(path, verify_compressed_data_integrity=True)
    for name, value in content.items():
        if not name.startswith("__"):
            yield from _parts(name, value)


def _members(group: h5py.Group) -> Iterator[tuple[str, Any]]:
    """Yield the names and objects of a group; for a soft or external link, a text."""
    for name in group:
        link = group.get(name, getlink=True)
        if isinstance(link, h5py.HardLink):
            yield name, group[name]
        else:
            where = getattr(link, "filename", "")
            yield name, f"a link to {where or link.path}, which is not followed"


def _parts(name: str, thing: Any) -> Iterator[_Part]:
    """Yield the arrays in a MATLAB variable, and why its other parts cannot be channels."""
    if isinstance(thing, MatlabOpaque):
        # variable name, type system and class name
        header = [field.decode() for field in thing[0].item()[:3] if isinstance(field, bytes)]
        yield header[0] if header else name, _OBJECT.format(header[-1] if header else "object")
        return
    content = _content_of(thing)
    if isinstance(content, dict):
        for field, by_index in content.items():
            yield from _field(name, field, by_index)
    elif isinstance(content, list):
        for text, element in content:
            yield from _parts(f"{name}{{{text}}}", element)
    else:
        yield name, content


def _field(name: str, field: str, by_index: list[tuple[str, Any]]) -> Iterator[_Part]:
    """Yield the parts of a field of a struct array, given with the index of each element."""
    if len(by_index) == 1:
        yield from _parts(f"{name}.{field}", by_index[0][1])
        return
    contents = (_content_of(element) for _, element in by_index)
    single = [c for c in contents if isinstance(c, np.ndarray | h5py.Dataset) and c.size == 1]
    scalars = [part.item() for part in map(_numbers_of, single) if isinstance(part, np.ndarray)]
    if len(scalars) == len(by_index) > 0:
        yield f"[{name}.{field}]", np.array(scalars)
        return
    for text, element in by_index:
        yield from _parts(f"{name}({text}).{field}", element)


def _content_of(thing: Any) -> Any:
    """Return what a MATLAB variable or a part of one holds.

    Returns
    -------
    dict, list, ndarray, h5py.Dataset or str
        Of a struct or struct array, the elements of each field, with their indices; of a cell
        array, the elements with their indices; an array; why it cannot be a channel.
    """
    if isinstance(thing, h5py.Group):
        if "MATLAB_sparse" in thing.attrs:
            return _SPARSE
        return {
            field: _targets(member)
            if _is_reference(member) and "MATLAB_class" not in member.attrs
            else [("1", member)]
            for field, member in _members(thing)
        }
    if _is_reference(thing):
        return _targets(thing)
    if isinstance(thing, h5py.Dataset | str):
        return thing
    if isinstance(thing, MatlabFunction):
        return _OBJECT.format("function")
    if not isinstance(thing, np.ndarray):
        return _SPARSE
    if thing.size == 0:
        return _EMPTY
    if thing.dtype.names:
        return {field: _elements(thing[field]) for field in thing.dtype.names}
    return _elements(thing) if thing.dtype == object else thing


def _elements(array: np.ndarray) -> list[tuple[str, Any]]:
    """Return the elements of an array, column by column, each with its index as in MATLAB.

    MATLAB counts from 1; a vector has one index.
    """
    vector = sum(n > 1 for n in array.shape) < 2
    found = []
    for reverse in np.ndindex(*reversed(array.shape)):
        index = reverse[::-1]
        numbers = [max(index, default=0)] if vector else index
        found.append((",".join(str(1 + i) for i in numbers), array[index]))
    return found


def _is_reference(thing: Any) -> bool:
    """Return whether a dataset holds references, as cell arrays and struct arrays do."""
    return isinstance(thing, h5py.Dataset) and h5py.check_ref_dtype(thing.dtype) is h5py.Reference


def _targets(dataset: h5py.Dataset) -> list[tuple[str, Any]]:
    """Return the objects that a dataset refers to, each with its index as in MATLAB."""
    if dataset.size > MOST_ARRAYS:
        raise _too_many(dataset.file.filename)
    references = _elements(np.asarray(dataset[()] if dataset.size else []).T)
    return [
        (text, dataset.file[reference] if reference else _EMPTY) for text, reference in references
    ]


def _numbers_of(part: np.ndarray | h5py.Dataset | str) -> np.ndarray | str:
    """Return the numbers of a part, or why it cannot be a channel."""
    if isinstance(part, h5py.Dataset):
        part = _read(part)
    if isinstance(part, str):
        return part
    if part.dtype.kind not in "fiub":
        return "text" if part.dtype.kind in "US" else f"numbers of type {part.dtype}"
    return part.astype(np.float64, copy=False)


def _read(dataset: h5py.Dataset) -> np.ndarray | str:
    """Return the array in a dataset, or, mostly from its metadata, why it cannot be a channel."""
    kind = "double"
    if "MATLAB_class" in dataset.attrs:
        kind = read_attribute(dataset.attrs, "MATLAB_class")
    if not dataset.size or "MATLAB_empty" in dataset.attrs:
        return _EMPTY
    if kind not in _NUMBERS:
        return "text" if kind == "char" else _OBJECT.format(kind)
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
