"""Files as MATLAB writes them: up to version 7 by SciPy, version 7.3 by mat-io."""

from typing import NamedTuple

import numpy as np
import scipy.io
from matio import save_to_mat


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
    old = {name: _old(value) for name, value in content.items()}
    save_to_mat(str(path), old, version="v7.3")
