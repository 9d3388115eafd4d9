"""HDF5 files of other programs, including MATLAB 7.3."""

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import h5py
import numpy as np

from fprc.errors import LogError
from fprc.logs.attributes import read_attribute
from fprc.logs.hdf5 import refuse_never_written
from fprc.logs.matlab import EMPTY, OBJECT, SPARSE, elements
from fprc.logs.variables import MOST_NUMBERS, Part, Source, collect

#: Most datasets and links in a file; the library takes 0.2 ms for each.
MOST_OBJECTS = 10_000
#: MATLAB's numeric classes.
_NUMBERS = {"double", "single", "logical"} | {
    f"{sign}int{bits}" for sign in ("", "u") for bits in (8, 16, 32, 64)
}

#: Name of an array in a file; and its dataset, its numbers, or why it cannot be a channel.
_Part = tuple[str, h5py.Dataset | np.ndarray | str]


def read_hdf5(path: Path, *, matlab: bool) -> Source:
    """Read an HDF5 file.

    Parts of MATLAB variables are named as in MATLAB, see ``fprc.logs.matlab.read_matlab``.
    Links are not followed.

    Raises
    ------
    LogError
        The file is damaged, cut short, or has too many parts.
    """
    return collect(path, "MATLAB 7.3" if matlab else "HDF5", "HDF5", _read_parts(path, matlab))


def _read_parts(path: Path, matlab: bool) -> Iterator[Part]:
    left = MOST_NUMBERS
    with h5py.File(path, "r") as file:
        for count, (name, part) in enumerate(_variables(file) if matlab else _datasets(file)):
            if count == MOST_OBJECTS:
                raise _too_many(path)
            if isinstance(part, h5py.Dataset):
                part = _why_no_channel(part, left, matlab=matlab) or _read(part, matlab=matlab)
            left -= 0 if isinstance(part, str) else part.size
            yield name, part


def _too_many(path: Path | str) -> LogError:
    return LogError(
        f"{path}: more than {MOST_OBJECTS} datasets; save the columns as one matrix, or a struct "
        "array as a struct of arrays"
    )


def _why_no_channel(dataset: h5py.Dataset, left: int, *, matlab: bool) -> str | None:
    """Return why a dataset cannot be a channel, according to its metadata."""
    kind = "double"
    if matlab and "MATLAB_class" in dataset.attrs:
        kind = read_attribute(dataset.attrs, "MATLAB_class")
    if not dataset.size or (matlab and "MATLAB_empty" in dataset.attrs):
        return EMPTY
    if kind not in _NUMBERS:
        return "text" if kind == "char" else OBJECT.format(kind)
    if dataset.ndim > 2 or dataset.dtype.kind not in "fiub":
        return f"{dataset.dtype} of shape {dataset.shape}"
    if dataset.external or dataset.is_virtual:
        return "stored in another file; copy it into this one"
    largest = max(dataset.size, int(np.prod(dataset.chunks or (1,), dtype=float)))
    if largest > left:
        return f"declares {largest:,} numbers; a file may have {MOST_NUMBERS:,} in all, split it"
    try:
        refuse_never_written(dataset)
    except LogError as error:
        return str(error)
    return None


def _read(dataset: h5py.Dataset, *, matlab: bool) -> np.ndarray | str:
    try:
        values = np.asarray(dataset[()], dtype=np.float64)
    except (OSError, RuntimeError) as error:  # other datasets may be readable
        return f"cannot be read ({error})"
    return values.T if matlab else values  # MATLAB stores arrays by columns


def _members(group: h5py.Group) -> Iterator[tuple[str, Any]]:
    """Yield the names and objects of a group; for a soft or external link, a text."""
    if len(group) > MOST_OBJECTS:
        raise _too_many(group.file.filename)
    for name in group:
        link = group.get(name, getlink=True)
        if isinstance(link, h5py.HardLink):
            yield name, group[name]
        else:
            where = getattr(link, "filename", "")
            yield name, f"a link to {where or link.path}, which is not followed"


def _datasets(group: h5py.Group, prefix: str = "") -> Iterator[_Part]:
    for name, member in _members(group):
        if isinstance(member, h5py.Group):
            yield from _datasets(member, f"{prefix}{name}/")
        elif isinstance(member, (h5py.Dataset, str)):
            yield f"{prefix}{name}", member


def _variables(file: h5py.File) -> Iterator[_Part]:
    for name, member in _members(file):
        if not name.startswith("#"):  # MATLAB's storage for the targets of references
            yield from _parts(name, member)


def _parts(name: str, thing: Any) -> Iterator[_Part]:
    if isinstance(thing, h5py.Group):
        if "MATLAB_sparse" in thing.attrs:
            yield name, SPARSE
            return
        for field, member in _members(thing):
            if _is_reference(member) and "MATLAB_class" not in member.attrs:
                yield from _field(name, field, member)
            else:
                yield from _parts(f"{name}.{field}", member)
    elif _is_reference(thing):
        for text, target in _targets(thing):
            yield from _parts(f"{name}{{{text}}}", target)
    elif isinstance(thing, (h5py.Dataset, str)):
        yield name, thing


def _field(name: str, field: str, member: h5py.Dataset) -> Iterator[_Part]:
    """Yield the parts of a field of a struct array, which holds one reference per element."""
    each = list(_targets(member))
    if all(isinstance(target, h5py.Dataset) and target.size == 1 and not _is_reference(target)
           and _why_no_channel(target, 1, matlab=True) is None for _, target in each):  # fmt: skip
        yield f"[{name}.{field}]", np.array([float(target[()].item()) for _, target in each])
    else:
        for text, target in each:
            yield from _parts(f"{name}({text}).{field}", target)


def _is_reference(thing: Any) -> bool:
    """Return whether a dataset holds references, as cell arrays and struct arrays do."""
    return isinstance(thing, h5py.Dataset) and h5py.check_ref_dtype(thing.dtype) is h5py.Reference


def _targets(dataset: h5py.Dataset) -> Iterator[tuple[str, Any]]:
    """Yield each element's index in MATLAB notation, and the object it refers to."""
    if dataset.size > MOST_OBJECTS:
        raise _too_many(dataset.file.filename)
    references = np.asarray(dataset[()] if dataset.size else []).T
    for index, text in elements(references.shape):
        reference = references[index]
        yield text, dataset.file[reference] if reference else EMPTY
