"""Result files, written whole or not at all, and where they come from."""

import errno
import hashlib
import json
import os
import platform
import subprocess
import tempfile
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager, suppress
from importlib.metadata import version
from pathlib import Path
from typing import Any

from fprc.errors import FprcError

_LIBRARIES = (
    "fprc", "numpy", "scipy", "pandas", "scikit-learn", "numba", "h5py", "matplotlib",
    "snakemake",
)  # fmt: skip


@contextmanager
def replacing(path: Path | str) -> Iterator[Path]:
    """Yield a temporary path beside ``path``, and rename that file to ``path`` on success.

    On an exception the temporary file is removed and ``path`` is unchanged. The suffix is kept,
    since some writers choose the format by it. A process that is killed leaves the temporary file,
    and the next that writes ``path`` replaces it.
    """
    path = Path(path)
    temporary = path.with_name(f".{path.stem}.part{path.suffix}")
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        yield temporary
        with temporary.open("rb") as written:
            os.fsync(written.fileno())
        temporary.replace(path)
    except OSError as error:
        if error.errno in (None, errno.ENOENT):  # of a library, or of a file that was to be read
            raise
        raise FprcError(
            f"{path}: cannot be written ({error.strerror}); free some space, make the folder "
            "writable, or choose another"
        ) from error
    finally:
        with suppress(OSError):  # there is none, or what is wrong is being said
            temporary.unlink()


def refuse_output(
    out: Path | str, suffix: str, *, ours: Callable[[Path], bool] | None = None
) -> None:
    """Raise FprcError if a file that a user named cannot be written, before anything is computed.

    No existing file is overwritten, but one of which ``ours`` says that it is an earlier output of
    the same command.
    """
    path = Path(out)
    if path.suffix != suffix:
        raise FprcError(f"{str(out) or repr('')}: must end in {suffix}")
    if os.path.lexists(path) and not (ours and os.path.isfile(path) and ours(path)):
        why = "was not made by this command" if ours else "is not overwritten"
        raise FprcError(f"{out}: exists and {why}; choose another name")
    try:
        folders = Path(os.path.abspath(path)).parents
        tempfile.TemporaryFile(dir=next(filter(os.path.lexists, folders))).close()
    except OSError as error:
        raise FprcError(
            f"{out}: cannot be written to ({error.strerror}); choose another folder"
        ) from error


def write_text(path: Path | str, text: str) -> None:
    """Write a text file, UTF-8."""
    with replacing(path) as temporary:
        temporary.write_text(text, encoding="utf-8")


def write_json(path: Path | str, content: Mapping[str, Any]) -> None:
    """Write a JSON file; raise ValueError if the content holds NaN or infinity."""
    write_text(path, json.dumps(content, indent=2, allow_nan=False) + "\n")


def write_csv(path: Path | str, table: Any) -> None:
    """Write a DataFrame with six significant digits; missing values are empty."""
    write_text(path, table.to_csv(index=False, float_format="%.6g"))


def versions() -> dict[str, str]:
    """Return the version of Python and of each library that the workflow computes or draws with."""
    return {"python": platform.python_version(), **{name: version(name) for name in _LIBRARIES}}


def commit_of(package: Path) -> str:
    """Return the commit of a package's code, with ``-dirty`` where a tracked file was changed.

    A package installed into a folder that git does not track has no commit.
    """
    git = ["git", "--no-optional-locks", "-C", str(package)]
    described = ["describe", "--always", "--dirty", "--exclude=*", "--abbrev=12"]
    try:
        for command in (["ls-files", "--error-unmatch", "__init__.py"], described):
            done = subprocess.run([*git, *command], capture_output=True, text=True, check=True)
    except (OSError, subprocess.CalledProcessError):
        return "unknown (not a git checkout)"
    return done.stdout.strip()


def sha256(path: str) -> str:
    """Return the SHA-256 of a file."""
    with open(path, "rb") as file:
        return hashlib.file_digest(file, "sha256").hexdigest()
