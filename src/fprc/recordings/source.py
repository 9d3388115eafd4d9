"""What another program's file holds, and how a map names its columns."""

import difflib
from pathlib import Path
from typing import NamedTuple

import numpy as np

from fprc.errors import LogError


class Source(NamedTuple):
    """What a file holds."""

    path: Path
    kind: str  #: file format, for messages
    columns: dict[str, np.ndarray]  #: arrays of one dimension, by their names in a map
    others: dict[str, str]  #: reason why each other variable cannot be a channel, by name
    lines: np.ndarray | None = None  #: line number of each sample in a text file, from 1
    notes: tuple[str, ...] = ()  #: what was left out

    def sample(self, number: int) -> str:
        """Describe a sample, counted from 0, for a message."""
        line = "" if self.lines is None else f" (line {self.lines[number]})"
        return f"sample {number}{line}"


def pick(source: Source, name: str) -> np.ndarray:
    """Return the column that a map names.

    Raises
    ------
    LogError
        There is no such column; the message does not contain its name, but that of one of a matrix
        of that name, or a similar one.
    """
    if name in source.columns:
        return source.columns[name]
    if name in source.others:
        raise LogError(f"cannot be a channel: {source.others[name]}")
    of_matrix = [column for column in source.columns if column.startswith(f"{name}[")]
    known = {column.lower(): column for column in [*source.columns, *source.others]}
    similar = [known[near] for near in difflib.get_close_matches(name.lower(), known)]
    near = "".join(f"did you mean {column}? " for column in [*of_matrix, *similar][:1])
    raise LogError(f"no such column; {near}`fprc import {source.path} --draft` shows all")
