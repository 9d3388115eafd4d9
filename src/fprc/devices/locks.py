"""One program at a time has a board: locks that hold over processes and users."""

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

#: Folders whose files every user may lock: the first that the system has.
_SHARED = (Path("/run/lock"), Path("/tmp"))


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
    place = Path(folder) if folder else next(filter(Path.is_dir, _SHARED))
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
        with contextlib.suppress(OSError):  # on a full disk the lock holds all the same
            os.truncate(file, 0)
            os.lseek(file, 0, os.SEEK_SET)
            os.write(file, text.encode(errors="replace"))


def _lock(board: str, path: Path) -> int:
    try:
        import fcntl

        file = _open(path)
    except ImportError as error:
        raise DeviceError(
            "boards are locked on Linux alone, so that no other program moves a valve meanwhile; "
            "run the real rig on Linux"
        ) from error
    except OSError as error:
        raise _not_locked(board, path, error) from error
    try:
        fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except OSError as error:
        holder = os.read(file, 1000).decode(errors="replace").strip()
        os.close(file)
        if error.errno not in (errno.EWOULDBLOCK, errno.EACCES):
            raise _not_locked(board, path, error) from error
        raise DeviceError(
            f"board {board} is in use by {visible(holder) or 'another process'}; nothing was "
            f"moved. Wait for its end, or stop it; to delete {path} does not free the board"
        ) from None
    return file


def _not_locked(board: str, path: Path, error: OSError) -> DeviceError:
    remedy = "make the file writable for all"
    if isinstance(error, FileNotFoundError):
        remedy = f"there is no folder {path.parent}: make it"
    return DeviceError(
        f"board {board}: {path} cannot be locked ({error.strerror}), so that another program could "
        f"use the board too; {remedy}, or set hardware.boards.lock_folder"
    )


def _open(path: Path) -> int:
    """Open a lock, or make it, for every user to write; a link is not followed."""
    flags = os.O_RDWR | os.O_NOFOLLOW | os.O_CLOEXEC
    # a system may refuse O_CREAT for another user's file in a folder that all can write to
    with contextlib.suppress(FileNotFoundError):
        return os.open(path, flags)
    try:
        file = os.open(path, flags | os.O_CREAT | os.O_EXCL, 0o666)
    except FileExistsError:  # another process was faster
        return os.open(path, flags)
    os.fchmod(file, 0o666)  # whatever the umask
    return file


def _user() -> str:
    try:
        return f"user {getpass.getuser()}"
    except (KeyError, OSError):  # a number without a name, as in a container
        return "a user without a name"
