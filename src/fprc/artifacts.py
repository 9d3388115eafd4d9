"""Result files: written whole or not at all."""

import errno
import glob
import json
import os
import re
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:  # most jobs write no table, and importing pandas takes as long as many of them
    from pandas import DataFrame

from fprc import escape
from fprc.errors import OutputError

_NO_ROOM = (errno.ENOSPC, errno.EDQUOT, errno.EFBIG)
_NO_ACCESS = (errno.EACCES, errno.EPERM, errno.EROFS, errno.ENOTDIR, errno.EEXIST, errno.EIO)


@contextmanager
def replacing(path: Path | str) -> Iterator[Path]:
    """Yield a temporary name beside ``path`` and rename it there on success.

    After an exception the temporary file is removed and ``path`` is as it was.
    The suffix is kept, since some writers choose the format by it. What a
    process that was killed left under such a name is removed too. A name that
    is temporary already is yielded as it is.

    Raises
    ------
    OutputError
        The disk is full or the folder cannot be written to.
    """
    if _owner(Path(path)) == os.getpid():
        yield Path(path)
        return
    with replacing_all(path) as (temporary,):
        yield temporary


@contextmanager
def replacing_all(*paths: Path | str) -> Iterator[list[Path]]:
    """Do as ``replacing`` with several files: all are renamed, the last one last, or none."""
    found = [Path(path) for path in paths]
    temporaries = [
        path.with_name(f".{path.stem}.{os.getpid()}.part{path.suffix}") for path in found
    ]
    with explaining(found[-1]):
        for path in found:
            path.parent.mkdir(parents=True, exist_ok=True)
            for leftover in leftovers(path.parent, path.name):
                leftover.unlink(missing_ok=True)
        try:
            yield temporaries
            for temporary in temporaries:
                with temporary.open("rb") as written:
                    os.fsync(written.fileno())
            for temporary, path in zip(temporaries, found, strict=True):
                temporary.replace(path)
        finally:
            for temporary in temporaries:
                with suppress(NotADirectoryError):
                    temporary.unlink(missing_ok=True)


@contextmanager
def explaining(path: Path | str) -> Iterator[None]:
    """Turn the system's refusal to write ``path`` into an error for people.

    Raises
    ------
    OutputError
        The disk is full or the folder cannot be written to.
    """
    try:
        yield
    except OSError as error:
        if error.errno in _NO_ROOM:
            remedy = "free some space"
        elif error.errno in _NO_ACCESS:
            remedy = "make the folder writable"
        else:
            raise
        raise OutputError(
            f"{path}: cannot be written ({error.strerror}); {remedy} or choose another place "
            "with --config 'folders={results: ...}', then run the same again"
        ) from error


@contextmanager
def appending(path: Path | str) -> Iterator[Callable[[str], None]]:
    """Give a function that appends a line to a file; when it returns the line is on the disk.

    Raises
    ------
    OutputError
        The disk is full or the folder cannot be written to.
    """
    # closing writes what is left, and fails again on a full disk: that too is to be explained
    with explaining(path), open(path, "a", encoding="utf-8") as file:

        def append(line: str) -> None:
            file.write(f"{line}\n")
            file.flush()
            os.fsync(file.fileno())

        yield append


def leftovers(folder: Path, name: str | None = None) -> list[Path]:
    """Return what processes that are gone left of a file, or of any, under temporary names."""
    pattern = ".*.part*"
    if name is not None:
        pattern = f".{glob.escape(Path(name).stem)}.*.part{glob.escape(Path(name).suffix)}"
    found = folder.glob(pattern)
    return sorted(path for path in found if not _runs(path))


def _owner(path: Path) -> int | None:
    """Return the number of the process whose temporary name a path is."""
    number = re.search(r"\.(\d+)\.part(\.\w+)?$", path.name)
    return int(number[1]) if number else None


def _runs(temporary: Path) -> bool:
    owner = _owner(temporary)
    if owner is None:
        return True
    try:
        os.kill(owner, 0)
    except ProcessLookupError:
        return False
    except PermissionError:
        pass
    return True


def refuse_unwritable(folders: Sequence[Path | str]) -> None:
    """Check that results can be written, before anything is computed.

    Raises
    ------
    OutputError
        Names every folder that is none, or that cannot be written to.
    """
    problems = []
    for folder in map(Path, folders):
        nearest = next(path for path in (folder, *folder.absolute().parents) if path.exists())
        if not nearest.is_dir():
            problems.append(f"{folder}: {nearest} is a file; move it away")
        elif not os.access(nearest, os.W_OK | os.X_OK):
            problems.append(
                f"{folder}: {nearest} cannot be written to; make it writable or choose another "
                "place with --config 'folders={results: ...}'"
            )
    if problems:
        raise OutputError("\n".join(problems))


def write_text(path: Path | str, text: str) -> None:
    """Write a text file, UTF-8."""
    with replacing(path) as temporary:
        temporary.write_text(text, encoding="utf-8")


def write_json(path: Path | str, content: Mapping[str, Any]) -> None:
    """Write a JSON file.

    Raises
    ------
    ValueError
        The content holds NaN or infinity.
    """
    write_text(path, json.dumps(content, indent=2, allow_nan=False) + "\n")


def read_json(path: Path | str) -> dict[str, Any]:
    """Read a JSON file."""
    return json.loads(Path(path).read_text(encoding="utf-8"))


def write_csv(path: Path | str, table: "DataFrame") -> None:
    """Write a table, six significant digits, empty where there is no value."""
    texts = table.select_dtypes(exclude="number").map(
        lambda cell: escape.spreadsheet(cell) if isinstance(cell, str) else cell
    )
    texts = texts.astype(object)  # `map` makes floats of mixed numbers, which are written otherwise
    write_text(path, table.assign(**texts).to_csv(index=False, float_format="%.6g"))
