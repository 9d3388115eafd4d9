"""Content of another program's file as named arrays, and its columns by name."""

import difflib
import re
from collections.abc import Iterable
from pathlib import Path
from typing import NamedTuple

import numpy as np

from fprc.errors import LogError

#: Most numbers in a file, over all its arrays: 10 channels of 1 kHz for 33 min.
MOST_NUMBERS = 20_000_000
#: Most variables in a file.
MOST_VARIABLES = 200_000
#: Name of a part of a file; and its numbers, or the reason why it is no channel.
Part = tuple[str, np.ndarray | str]


class Source(NamedTuple):
    """Content of a file."""

    path: Path
    kind: str  #: file format, for messages
    variables: dict[str, np.ndarray]  #: arrays of one or two dimensions, by name
    others: dict[str, str]  #: reason why each other variable cannot be a channel, by name
    lines: np.ndarray | None = None  #: line number of each sample in a text file, from 1

    def sample(self, number: int) -> str:
        """Return the name of a sample, counted from 0, for a message."""
        line = "" if self.lines is None else f" (line {self.lines[number]})"
        return f"sample {number}{line}"


def collect(path: Path, kind: str, reader: str, parts: Iterable[Part]) -> Source:
    """Return the parts of a file, squeezed to one or two dimensions, as its content.

    Parameters
    ----------
    reader : str
        Name of the format in messages.

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
    """Return every column by its name in a map; column j of a matrix, from 0, is ``name[:, j]``."""
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
    """Return a column by the name that a map uses.

    Raises
    ------
    LogError
        There is no such column (the message names the nearest one), or it is not a vector.
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
        return _slice(source, text, match)
    if text in source.others:
        raise LogError(f"{text}: cannot be a channel: {source.others[text]}")
    near = nearest(text, [*columns_of(source), *source.others])
    raise LogError(
        f"{text}: no such column; did you mean {near}? `fprc import {source.path} --list` shows all"
    )


def _slice(source: Source, text: str, match: re.Match[str]) -> np.ndarray:
    values = source.variables[match["name"]]
    index = tuple(slice(None) if part == ":" else int(part) for part in match.group(2, 3))
    if values.ndim == 2 and index != (slice(None), slice(None)):
        try:
            return values[index]
        except IndexError:
            pass
    raise LogError(f"{text}: {match['name']} has shape {values.shape}; indices count from 0")


def nearest(text: str, known: Iterable[str]) -> str:
    """Return the name most similar to ``text``; fast for many names."""
    matcher = difflib.SequenceMatcher(autojunk=False, b=text.lower())
    best, likeness = "", -1.0
    for name in known:
        matcher.set_seq1(name.lower())  # cheap upper bounds on the ratio come first
        if matcher.real_quick_ratio() > likeness and matcher.quick_ratio() > likeness:
            ratio = matcher.ratio()
            if ratio > likeness:
                best, likeness = name, ratio
    return best
