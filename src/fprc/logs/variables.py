"""What a file of another program holds, as named arrays, and one column of it by name."""

import difflib
import re
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import NamedTuple

import numpy as np

from fprc.errors import LogError

#: Most numbers that are read of a file, all its arrays together: 10 channels of 1 kHz for 33 min.
MOST_NUMBERS = 20_000_000
#: Most arrays, texts, ... in a file.
MOST_VARIABLES = 200_000


class Source(NamedTuple):
    """What a file holds.

    Attributes
    ----------
    kind : str
        In words.
    variables : dict
        Arrays of one or two dimensions by name.
    others : dict
        Names of what cannot be a channel, and why.
    lines : ndarray or None
        Line of each sample in a text file, from 1.
    """

    path: Path
    kind: str
    variables: dict[str, np.ndarray]
    others: dict[str, str]
    lines: np.ndarray | None = None

    def sample(self, number: int) -> str:
        """Return a sample, counted from 0, as a message names it."""
        line = "" if self.lines is None else f" (line {self.lines[number]})"
        return f"sample {number}{line}"


def sorted_out(
    path: Path, variables: Mapping[str, np.ndarray], others: Mapping[str, str]
) -> tuple[dict[str, np.ndarray], dict[str, str]]:
    """Drop empty dimensions, and what has too many or too few.

    Raises
    ------
    LogError
        Nothing is there at all.
    """
    kept, dropped = {}, dict(others)
    for name, values in variables.items():
        squeezed = values.reshape([n for n in values.shape if n != 1])
        if squeezed.ndim in (1, 2) and squeezed.size:
            kept[name] = squeezed
        else:
            dropped[name] = f"array of shape {values.shape}"
    if not kept and not dropped:
        raise LogError(f"{path}: holds nothing; the file is empty or cut short")
    return kept, dropped


# --- columns --------------------------------------------------------------------------------

_INDEXED = re.compile(r"(?P<name>.+?)\s*\[\s*(?P<row>:|\d+)\s*,\s*(?P<column>:|\d+)\s*\]")


def columns_of(source: Source) -> dict[str, np.ndarray]:
    """Return every column that a map can name; those of a matrix as ``name[:, j]``, j from 0."""
    found = {}
    for name, values in source.variables.items():
        if values.ndim == 1:
            found[name] = values
        elif values.shape[0] >= values.shape[1]:
            found |= {f"{name}[:, {j}]": values[:, j] for j in range(values.shape[1])}
        else:
            found |= {f"{name}[{j}, :]": values[j] for j in range(values.shape[0])}
    return found


def pick(source: Source, text: str) -> np.ndarray:
    """Return the column that a map names.

    Raises
    ------
    LogError
        There is none of that name (with the nearest), or it is no vector; the
        message names the column and not the file.
    """
    if text in source.variables:
        values = source.variables[text]
        if values.ndim == 1:
            return values
        rows, columns = values.shape
        raise LogError(
            f"{text}: has {rows} rows and {columns} columns; choose one, "
            f"as {text}[:, 0] (counted from 0)"
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
    """Return the name most like ``text``, of many: bounds on the likeness come first."""
    matcher = difflib.SequenceMatcher(autojunk=False, b=text.lower())
    best, likeness = "", -1.0
    for name in known:
        matcher.set_seq1(name.lower())
        if matcher.real_quick_ratio() > likeness and matcher.quick_ratio() > likeness:
            ratio = matcher.ratio()
            if ratio > likeness:
                best, likeness = name, ratio
    return best
