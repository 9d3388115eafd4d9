"""The arrays in another program's file, and how a map names their columns."""

import difflib
import re
from collections.abc import Iterable
from contextlib import suppress
from pathlib import Path
from typing import NamedTuple

import numpy as np

from fprc.errors import LogError

#: Most numbers in a file, over all its arrays: 10 channels of 1 kHz for 33 min.
MOST_NUMBERS = 20_000_000
#: Most variables in a file.
MOST_VARIABLES = 200_000
#: Name of an array in a file; and its numbers, or the reason why it cannot be a channel.
Part = tuple[str, np.ndarray | str]


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


def collect(path: Path, kind: str, reader: str, parts: Iterable[Part]) -> Source:
    """Return the content of a file; arrays lose their dimensions of length 1.

    Parameters
    ----------
    kind, reader : str
        Format of the file, with its version and without.

    Raises
    ------
    LogError
        The file cannot be read, or has no content.
    """
    variables, others = {}, {}
    try:
        for name, part in parts:
            if isinstance(part, str):
                others[name] = part
                continue
            array = part.astype(np.float64, copy=False).reshape([n for n in part.shape if n != 1])
            if array.ndim in (1, 2) and array.size:
                variables[name] = array
            else:
                others[name] = f"array of shape {part.shape}"
    except (LogError, MemoryError):
        raise
    except Exception as error:  # on a damaged file the libraries raise many types
        raise LogError(
            f"{path}: cannot be read as {reader} ({type(error).__name__}: {error}); the file is "
            "cut short, damaged, or of another format"
        ) from error
    if not variables and not others:
        raise LogError(f"{path}: has no content; the file is empty or cut short")
    return Source(path, kind, variables, others)


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
    near = nearest(text, [*columns_of(source), *source.others])
    raise LogError(
        f"{text}: no such column; did you mean {near}? `fprc import {source.path} --list` shows all"
    )


def nearest(text: str, known: Iterable[str]) -> str:
    """Return the name most similar to ``text``."""
    matcher = difflib.SequenceMatcher(autojunk=False, b=text.lower())
    best, likeness = "", -1.0
    for name in known:
        matcher.set_seq1(name.lower())  # the cheap upper bounds of the ratio come first
        if matcher.real_quick_ratio() > likeness and matcher.quick_ratio() > likeness:
            ratio = matcher.ratio()
            if ratio > likeness:
                best, likeness = name, ratio
    return best
