"""Arrays in HDF5 files."""

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import h5py
import numpy as np

from fprc.errors import LogError
from fprc.logs.columns import open_hdf5, refuse_never_written
from fprc.recordings.table import Column, Table, gathered, spread

#: Attributes that hold the unit of a dataset, its label, and the names of its columns.
_UNITS, _LABELS = ("units", "unit", "Units", "Unit"), ("long_name", "label", "name", "description")
_NAMES = ("columns", "names", "column_names", "labels", "fields")


def read_hdf5(path: Path) -> Table:
    """Read every array of an HDF5 file, by its path in the file; links are not followed.

    The fields of a compound type are ``dataset.field``. A matrix whose attribute ``columns`` or
    ``names`` names its columns, or that pandas wrote, has the columns ``matrix.name``.
    """
    with open_hdf5(path) as file:
        return gathered(path, "HDF5", list(_within(file, "")))


def _within(group: h5py.Group, prefix: str) -> Iterator[tuple[str, Column | str]]:
    for name in group:
        link = group.get(name, getlink=True)
        if not isinstance(link, h5py.HardLink):
            where = getattr(link, "filename", "") or link.path
            yield f"{prefix}{name}", f"a link to {where}, which is not followed"
        elif isinstance(member := group[name], h5py.Group):
            yield from _within(member, f"{prefix}{name}/")
        elif isinstance(member, h5py.Dataset):
            yield from _parts(f"{prefix}{name}", member)


def _parts(name: str, dataset: h5py.Dataset) -> Iterator[tuple[str, Column | str]]:
    """Yield the columns of a dataset, or, mostly from its metadata, why it has none."""
    values = _read(dataset)
    if isinstance(values, str):
        yield name, values
        return
    attributes = dict(dataset.attrs)
    described = {"unit": _text(attributes, _UNITS), "label": _text(attributes, _LABELS)}
    for field in values.dtype.names or ():
        for part, column in spread(f"{name}.{field}", values[field]).items():
            yield part, Column(column, described["unit"])
    if values.dtype.names is None:
        names = _names(dataset, attributes)
        for part, column in spread(name, values, names).items() if names else [(name, values)]:
            yield part, Column(column, **described)


def _read(dataset: h5py.Dataset) -> np.ndarray | str:
    if not dataset.size:
        return "empty"
    if dataset.dtype.kind not in "fiubV":
        return f"{dataset.dtype} of shape {dataset.shape}"
    if dataset.external or dataset.is_virtual:
        return "stored in another file; copy it into this one"
    try:
        refuse_never_written(dataset)
        return np.asarray(dataset[()])
    except LogError as error:
        return str(error)
    except (OSError, RuntimeError) as error:  # other datasets may be readable
        return f"cannot be read ({error})"


def _text(attributes: dict[str, Any], names: tuple[str, ...]) -> str:
    found = next((attributes[name] for name in names if name in attributes), "")
    text = found.decode(errors="replace") if isinstance(found, bytes) else found
    return text if isinstance(text, str) else ""


def _names(dataset: h5py.Dataset, attributes: dict[str, Any]) -> list[str] | None:
    """Return the names of a matrix's columns: from its attributes, or as pandas writes them."""
    found = next((attributes[name] for name in _NAMES if name in attributes), None)
    if found is None and dataset.name.endswith("_values"):
        found = dataset.parent.get(dataset.name.rpartition("/")[2][: -len("values")] + "items")
    names = np.ravel([] if found is None else found[()] if hasattr(found, "dtype") else found)
    texts = [name.decode() if isinstance(name, bytes) else name for name in names.tolist()]
    return texts if texts and all(isinstance(text, str) for text in texts) else None
