"""Files that users name: the one way to open them."""

import os
import stat
from collections.abc import Sequence
from pathlib import Path
from typing import BinaryIO

from fprc.errors import ConfigError, FprcError

#: Largest file, bytes, unless the caller says otherwise.
MOST_BYTES = 4 << 30


def open_given(
    path: Path | str, *, error: type[FprcError] = FprcError, most_bytes: int = MOST_BYTES
) -> BinaryIO:
    """Open a file that a user named, for reading.

    Only a regular file is opened, or a link to one: a pipe would block, and a device can be
    endless.

    Parameters
    ----------
    error : type, default=FprcError
        Class of the exception.
    most_bytes : int, default=MOST_BYTES
        Largest size, bytes.

    Raises
    ------
    FprcError
        The path leads to no regular file, the file cannot be read, or it is too large.
    """
    shown = str(path) or "''"
    try:
        found = os.stat(path)
        if not stat.S_ISREG(found.st_mode):
            kind = "Is a directory" if stat.S_ISDIR(found.st_mode) else "not a regular file"
            raise error(f"{shown}: cannot be opened ({kind}); check the path")
        if found.st_size > most_bytes:
            raise error(
                f"{path}: has {found.st_size:,} bytes; must have at most {most_bytes:,}, split it "
                "or check the path"
            )
        return open(path, "rb")
    except (OSError, ValueError) as problem:  # ValueError: the path contains NUL
        why = getattr(problem, "strerror", None) or problem
        raise error(f"{shown}: cannot be opened ({why}); check the path") from problem


def read_given(
    path: Path | str, *, error: type[FprcError] = FprcError, most_bytes: int = MOST_BYTES
) -> bytes:
    """Return the content of a file that a user named; see ``open_given``."""
    with open_given(path, error=error, most_bytes=most_bytes) as file:
        try:
            return file.read()
        except OSError as problem:
            raise error(f"{path}: cannot be read ({problem.strerror}); check the path") from problem


def refuse_repeats(paths: Sequence[str], why: str) -> None:
    """Refuse a recording that is given twice.

    Parameters
    ----------
    why : str
        What would be wrong, for the message.

    Raises
    ------
    ConfigError
        Lists every repeated recording.
    """
    places = [os.path.realpath(path) for path in paths]
    repeated = [path for i, path in enumerate(paths) if places[i] in places[:i]]
    if repeated:
        raise ConfigError(f"{', '.join(repeated)}: given twice; give each recording once: {why}")
