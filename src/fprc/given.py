"""Files that users name: the one way to open them."""

import os
from collections.abc import Sequence
from pathlib import Path
from typing import BinaryIO

from fprc.errors import ConfigError, FprcError


def open_given(
    path: Path | str, *, error: type[FprcError] = FprcError, most_bytes: int = 4 << 30
) -> BinaryIO:
    """Open a regular file that a user named, for reading; raise ``error`` if that cannot be."""
    try:
        # a pipe would block, and a device can be endless
        if os.path.exists(path) and not os.path.isfile(path):
            raise OSError(0, "no regular file")
        file = open(path, "rb")
    except (OSError, ValueError) as problem:  # ValueError: the path contains NUL
        why = getattr(problem, "strerror", None) or problem
        raise error(f"{path!s}: cannot be opened ({why}); check the path") from problem
    size = os.fstat(file.fileno()).st_size
    if size > most_bytes:
        file.close()
        raise error(f"{path}: has {size:,} bytes; must have at most {most_bytes:,}")
    return file


def read_given(
    path: Path | str, *, error: type[FprcError] = FprcError, most_bytes: int = 4 << 30
) -> bytes:
    """Return the content of a file that a user named; raise ``error`` if it cannot be read."""
    with open_given(path, error=error, most_bytes=most_bytes) as file:
        return file.read()


def refuse_repeats(paths: Sequence[str], why: str) -> None:
    """Raise ConfigError if a recording is given twice; ``why`` says what would be wrong."""
    places = [os.path.realpath(path) for path in paths]
    repeated = [path for i, path in enumerate(paths) if places[i] in places[:i]]
    if repeated:
        raise ConfigError(f"{', '.join(repeated)}: given twice; give each recording once: {why}")
