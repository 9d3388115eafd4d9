"""Files as MATLAB writes them: up to version 7 by SciPy, version 7.3 as HDF5 with references."""

from typing import NamedTuple

import h5py
import numpy as np
import scipy.io


class Cells(NamedTuple):
    """A cell array: its shape, its contents down the columns."""

    shape: tuple[int, ...]
    contents: list


class Structs(NamedTuple):
    """A struct array: its shape, its elements (with the same fields) down the columns."""

    shape: tuple[int, ...]
    elements: list[dict]


def write_matlab5(path, content):
    old = {name: _old(value) for name, value in content.items()}
    scipy.io.savemat(path, old, do_compression=True)


def _old(value):
    if isinstance(value, dict):
        return {name: _old(part) for name, part in value.items()}
    if isinstance(value, Cells):
        return _objects(value.shape, map(_old, value.contents))
    if isinstance(value, Structs):
        fields = list(value.elements[0]) if value.elements else ["y"]
        made = np.empty(value.shape, dtype=[(field, object) for field in fields])
        for field in fields:
            made[field] = _objects(
                value.shape, [_old(element[field]) for element in value.elements]
            )
        return made
    return value


def _objects(shape, values):
    made = np.empty(int(np.prod(shape)), dtype=object)
    made[:] = list(values)
    return made.reshape(shape, order="F")


def write_matlab73(path, content):
    with h5py.File(path, "w", userblock_size=512) as file:
        references = file.create_group("#refs#")
        for name, value in content.items():
            _put(file, name, value, references)
    with path.open("r+b") as file:
        file.write(b"MATLAB 7.3 MAT-file, Platform: GLNXA64".ljust(124) + b"\0\2IM")


def _put(parent, name, value, references):
    """Write a value as MATLAB does: arrays by columns, empty ones as their shape."""
    if isinstance(value, dict):
        made, kind = parent.create_group(name), "struct"
        for field, part in value.items():
            _put(made, field, part, references)
    elif isinstance(value, Structs) and value.elements:
        made, kind = parent.create_group(name), "struct"
        for field in value.elements[0]:
            parts = [element[field] for element in value.elements]
            made[field] = _referring(value.shape, parts, references)
    elif isinstance(value, Cells) and value.contents:
        made, kind = parent.create_dataset(
            name, data=_referring(value.shape, value.contents, references)
        ), "cell"  # fmt: skip
    elif isinstance(value, str):
        made, kind = (
            parent.create_dataset(name, data=np.array([[ord(c)] for c in value], "u2")),
            "char",
        )
    else:
        empty = isinstance(value, (Cells, Structs)) or not np.size(value)
        shape = value.shape if isinstance(value, (Cells, Structs)) else np.atleast_2d(value).shape
        data = np.array(shape, dtype=np.uint64) if empty else np.atleast_2d(value).T
        kind = {Cells: "cell", Structs: "struct"}.get(type(value), "double")
        made = parent.create_dataset(name, data=data)
        if empty:
            made.attrs["MATLAB_empty"] = np.uint8(1)
    made.attrs["MATLAB_class"] = np.bytes_(kind)


def _referring(shape, values, references):
    made = np.empty(len(values), dtype=h5py.ref_dtype)
    for k, value in enumerate(values):
        name = f"x{len(references)}"
        _put(references, name, value, references)
        made[k] = references[name].ref
    return made.reshape(shape, order="F").T
