"""Locks that give one program at a time access to a board, across processes and users."""

import contextlib
import errno
import getpass
import logging
import os
import sys
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from datetime import datetime
from itertools import product
from pathlib import Path

from fprc.errors import DeviceError
from fprc.escape import in_words, visible

log = logging.getLogger("fprc.rig")

#: Folders in which users may lock files. Each one that this user can write to is used, not the
#: first alone: a user who can write to both and one who cannot then meet in the second.
_SHARED = (Path("/run/lock"), Path("/tmp"))
#: Errors of a folder that this user cannot write to.
_DENIED = (errno.EACCES, errno.EPERM, errno.EROFS)


@contextmanager
def locked(boards: Sequence[str], folder: str = "") -> Iterator[list[int]]:
    """Hold the locks of boards; the operating system releases them if the process ends.

    Parameters
    ----------
    boards : sequence of str
        Device names, such as AIO000.
    folder : str
        Folder of the lock files; empty for all folders of the system that this user can write to.

    Yields
    ------
    list of int
        File descriptors. A process that inherits them also holds the locks until it ends.

    Raises
    ------
    DeviceError
        A board is in use, by the process that the message names, or cannot be locked; or this is
        not Linux.
    """
    if sys.platform != "linux":
        raise DeviceError("the real rig can be driven only from Linux; nothing was moved")
    # the folders of the system in the order of every program
    places = [Path(folder)] if folder else [place.resolve() for place in _SHARED if place.is_dir()]
    if not places:
        raise DeviceError(
            f"no folder for the locks of the boards: {', '.join(map(str, _SHARED))} are missing; "
            "create a folder and set hardware.boards.lock_folder to it"
        )
    places = list(dict.fromkeys(places))
    with contextlib.ExitStack() as held:
        files: list[int] = []
        refused: dict[Path, OSError] = {}
        for place, board in product(places, sorted(set(boards))):
            path = place / f"fprc-{board}.lock"
            try:
                files.append(_lock(board, path))
                held.callback(os.close, files[-1])
            except OSError as error:
                refused[path] = error
        if refused:
            _judge(refused, places)
        write_holder(files, "")
        yield files


def write_holder(files: Sequence[int], more: str) -> None:
    """Write into lock files which process holds them, for the error message of other programs.

    ``more`` follows this process's number in the text.
    """
    command = " ".join([Path(sys.argv[0]).name, *sys.argv[1:]])[:200]
    since = datetime.now().astimezone().isoformat(sep=" ", timespec="seconds")
    try:
        user = f"user {getpass.getuser()}"
    except (KeyError, OSError):  # a number without a name, as in a container
        user = "a user without a name"
    text = f"process {os.getpid()}{more} of {user}, since {since}: {command}\n"
    for file in files:
        with contextlib.suppress(OSError):  # the lock holds even if the disk is full
            os.truncate(file, 0)
            os.lseek(file, 0, os.SEEK_SET)
            os.write(file, text.encode(errors="replace"))


def _judge(refused: Mapping[Path, OSError], places: Sequence[Path]) -> None:
    """Raise DeviceError unless a folder has all locks, and this user cannot write to the others."""
    failed = in_words(
        f"{path} cannot be locked ({error.strerror})" for path, error in refused.items()
    )
    denied = all(error.errno in _DENIED for error in refused.values())
    if denied and {path.parent for path in refused} < set(places):
        log.info("%s; two users need a folder in common (hardware.boards.lock_folder)", failed)
        return
    remedy = "make the files writable for all users"
    if any(isinstance(error, FileNotFoundError) for error in refused.values()):
        remedy = f"create the folder {places[0]}"
    raise DeviceError(
        f"{failed}, so another program could use the boards too; {remedy}, or set "
        "hardware.boards.lock_folder"
    )


def _lock(board: str, path: Path) -> int:
    import fcntl  # which other systems may lack

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
    os.fchmod(file, 0o666)  # for any umask
    return file
