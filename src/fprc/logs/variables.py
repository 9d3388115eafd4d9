"""What another program's file holds, and how a map names its columns."""

import difflib
import re
from contextlib import suppress
from pathlib import Path
from typing import NamedTuple

import numpy as np

from fprc.errors import LogError


class Source(NamedTuple):
    """What a file holds."""

    path: Path
    kind: str  #: file format, for messages
    variables: dict[str, np.ndarray]  #: arrays of one or two dimensions, by name
    others: dict[str, str]  #: reason why each other variable cannot be a channel, by name
    lines: np.ndarray | None = None  #: line number of each sample in a text file, from 1
    notes: tuple[str, ...] = ()  #: what was left out

    def sample(self, number: int) -> str:
        """Describe a sample, counted from 0, for a message."""
        line = "" if self.lines is None else f" (line {self.lines[number]})"
        return f"sample {number}{line}"


_INDEXED = re.compile(r"(?P<name>.+?)\s*\[\s*(?P<row>:|\d+)\s*,\s*(?P<column>:|\d+)\s*\]")


def columns_of(source: Source) -> dict[str, np.ndarray]:
    """Return every column by its name in a map, such as ``name`` or, of a matrix, ``name[:, 0]``.

    The longer dimension of a matrix is taken to be time.
    """
    columns = {}
    for name, values in source.variables.items():
        if values.ndim == 1:
            columns[name] = values
        elif values.shape[0] >= values.shape[1]:
            columns |= {f"{name}[:, {j}]": values[:, j] for j in range(values.shape[1])}
        else:
            columns |= {f"{name}[{j}, :]": values[j] for j in range(values.shape[0])}
    return columns


def pick(source: Source, text: str) -> np.ndarray:
    """Return the column that a map names.

    Raises
    ------
    LogError
        There is no such column (the message names the most similar one), or it is a matrix.
    """
    if text in source.variables:
        values = source.variables[text]
        if values.ndim == 1:
            return values
        rows, columns = values.shape
        raise LogError(
            f"{text}: has {rows} rows and {columns} columns; choose one of them, "
            f"such as {text}[:, 0] (counted from 0)"
        )
    match = _INDEXED.fullmatch(text)
    if match and match["name"] in source.variables and ":" in (match["row"], match["column"]):
        values = source.variables[match["name"]]
        index = tuple(slice(None) if part == ":" else int(part) for part in match.group(2, 3))
        if values.ndim == 2 and index != (slice(None), slice(None)):
            with suppress(IndexError):
                return values[index]
        raise LogError(f"{text}: {match['name']} has shape {values.shape}; indices count from 0")
    if text in source.others:
        raise LogError(f"{text}: cannot be a channel: {source.others[text]}")
    known = {name.lower(): name for name in [*columns_of(source), *source.others]}
    (near,) = difflib.get_close_matches(text.lower(), known, n=1, cutoff=0.0)
    raise LogError(
        f"{text}: no such column; did you mean {known[near]}? `fprc import {source.path} --list` "
        "shows all"
    )
