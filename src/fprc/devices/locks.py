"""Locks that give one program at a time access to a board, across processes and users."""

import contextlib
import errno
import getpass
import os
import sys
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from datetime import datetime
from pathlib import Path

from fprc.errors import DeviceError
from fprc.escape import visible

#: Folders in which every user may lock files; the first existing one is used.
_SHARED = (Path("/run/lock"), Path("/tmp"))


@contextmanager
def locked(boards: Sequence[str], folder: str = "") -> Iterator[list[int]]:
    """Hold the locks of boards; the operating system releases them if the process ends.

    Parameters
    ----------
    boards : sequence of str
        Device names, such as AIO000.
    folder : str
        Folder of the lock files; empty for the system's default.

    Yields
    ------
    list of int
        File descriptors. A process that inherits them also holds the locks until it ends.

    Raises
    ------
    DeviceError
        A board is in use, by the process that the message names, or cannot be locked.
    """
    place = Path(folder) if folder else next(filter(Path.is_dir, _SHARED))
    with contextlib.ExitStack() as held:
        files = []
        for board in sorted(set(boards)):
            files.append(_lock(board, place / f"fprc-{board}.lock"))
            held.callback(os.close, files[-1])
        write_holder(files, "")
        yield files


def write_holder(files: Sequence[int], more: str) -> None:
    """Write into lock files which process holds them, for the error message of other programs.

    ``more`` follows this process's number in the text.
    """
    command = " ".join([Path(sys.argv[0]).name, *sys.argv[1:]])[:200]
    since = datetime.now().astimezone().isoformat(sep=" ", timespec="seconds")
    text = f"process {os.getpid()}{more} of {_user()}, since {since}: {command}\n"
    for file in files:
        with contextlib.suppress(OSError):  # the lock holds even if the disk is full
            os.truncate(file, 0)
            os.lseek(file, 0, os.SEEK_SET)
            os.write(file, text.encode(errors="replace"))


def _lock(board: str, path: Path) -> int:
    try:
        import fcntl
    except ImportError as error:
        raise DeviceError(
            "boards can be locked against other programs only on Linux; run the real rig on Linux"
        ) from error
    try:
        file = _open(path)
        try:
            fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except OSError as error:
            holder = os.read(file, 1000).decode(errors="replace").strip()
            os.close(file)
            if error.errno not in (errno.EWOULDBLOCK, errno.EACCES):
                raise
            raise DeviceError(
                f"board {board} is in use by {visible(holder) or 'another process'}; nothing was "
                f"moved. Wait until it ends, or stop it; deleting {path} does not free the board"
            ) from None
    except OSError as error:
        remedy = "make the file writable for all users"
        if isinstance(error, FileNotFoundError):
            remedy = f"create the folder {path.parent}"
        raise DeviceError(
            f"board {board}: {path} cannot be locked ({error.strerror}), so another program could "
            f"use the board too; {remedy}, or set hardware.boards.lock_folder"
        ) from error
    return file


def _open(path: Path) -> int:
    """Open a lock file, or create it, writable for every user; links are not followed."""
    flags = os.O_RDWR | os.O_NOFOLLOW | os.O_CLOEXEC
    # in a world-writable folder, O_CREAT can be refused for another user's file
    with contextlib.suppress(FileNotFoundError):
        return os.open(path, flags)
    try:
        file = os.open(path, flags | os.O_CREAT | os.O_EXCL, 0o666)
    except FileExistsError:  # another process has created it meanwhile
        return os.open(path, flags)
    os.fchmod(file, 0o666)  # whatever the umask
    return file


def _user() -> str:
    try:
        return f"user {getpass.getuser()}"
    except (KeyError, OSError):  # a number without a name, as in a container
        return "a user without a name"
