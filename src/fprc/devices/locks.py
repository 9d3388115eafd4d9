"""One program at a time has a board: locks that hold over processes and users."""

import contextlib
import getpass
import os
import sys
import tempfile
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from datetime import datetime
from pathlib import Path

from fprc.errors import DeviceError

try:
    import fcntl
except ImportError:  # Windows
    fcntl = None
    import msvcrt

#: Folder whose files every user may lock, where the system has it.
_SHARED = Path("/run/lock")
#: Windows locks bytes, and nobody can read those that are locked.
_LOCKED_BYTE = 1 << 20


@contextmanager
def locked(boards: Sequence[str], folder: str = "") -> Iterator[list[int]]:
    """Hold the locks of boards; the operating system releases them when the process ends.

    Parameters
    ----------
    boards : sequence of str
        Device names, such as AIO000.
    folder : str
        Where the locks are; empty for the system's own.

    Yields
    ------
    list of int
        Descriptors. A process that inherits them holds the locks too, until it ends.

    Raises
    ------
    DeviceError
        Names the process that has a board, or why it cannot be locked.
    """
    place = Path(folder) if folder else _SHARED if _SHARED.is_dir() else Path(tempfile.gettempdir())
    with contextlib.ExitStack() as held:
        files = []
        for board in sorted(set(boards)):
            files.append(_lock(board, place / f"fprc-{board}.lock"))
            held.callback(os.close, files[-1])
        describe(files, "")
        yield files


def describe(files: Sequence[int], more: str) -> None:
    """Write into locks who holds them, for whoever finds them held.

    Parameters
    ----------
    more : str
        What is known beyond this process, its user and its command.
    """
    command = " ".join([Path(sys.argv[0]).name, *sys.argv[1:]])[:200]
    since = datetime.now().astimezone().isoformat(sep=" ", timespec="seconds")
    text = f"process {os.getpid()}{more} of {_user()}, since {since}: {command}\n"
    for file in files:
        os.truncate(file, 0)
        os.lseek(file, 0, os.SEEK_SET)
        os.write(file, text.encode(errors="replace"))


def _lock(board: str, path: Path) -> int:
    try:
        file = _open(path)
    except OSError as error:
        raise DeviceError(
            f"board {board}: its lock {path} cannot be opened ({error.strerror}), so that another "
            "program could use the board too; make the file writable for all, or set "
            "hardware.boards.lock_folder"
        ) from error
    try:
        if fcntl:
            fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
        else:
            os.lseek(file, _LOCKED_BYTE, os.SEEK_SET)
            msvcrt.locking(file, msvcrt.LK_NBLCK, 1)
    except OSError:
        os.lseek(file, 0, os.SEEK_SET)
        holder = os.read(file, 1000).decode(errors="replace").strip()
        holder = "".join(c if c.isprintable() else "?" for c in holder)
        os.close(file)
        raise DeviceError(
            f"board {board} is in use by {holder or 'another process'}; nothing was moved. "
            f"Wait for its end, or stop it ({path})"
        ) from None
    return file


def _open(path: Path) -> int:
    """Open a lock, or make it, for every user to write; a link is not followed."""
    flags = os.O_RDWR | getattr(os, "O_NOFOLLOW", 0) | getattr(os, "O_CLOEXEC", 0)
    # a system may refuse O_CREAT for another user's file in a folder that all can write to
    with contextlib.suppress(FileNotFoundError):
        return os.open(path, flags)
    try:
        file = os.open(path, flags | os.O_CREAT | os.O_EXCL, 0o666)
    except FileExistsError:  # another process was faster
        return os.open(path, flags)
    os.chmod(file if os.chmod in os.supports_fd else path, 0o666)  # whatever the umask
    return file


def _user() -> str:
    try:
        return f"user {getpass.getuser()}"
    except (KeyError, OSError):  # a number without a name, as in a container
        return "a user without a name"
