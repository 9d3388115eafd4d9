"""Locks that give one program at a time access to a board, across processes and users."""

import contextlib
import errno
import getpass
import logging
import os
import sys
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from datetime import datetime
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
        denied: set[str] = set()
        for board in sorted(set(boards)):
            for file in _lock_in_all(board, places, denied):
                held.callback(os.close, file)
                files.append(file)
        if denied:
            log.info(
                "boards are locked in one folder only, not in %s; two users need one in common "
                "(hardware.boards.lock_folder)",
                ", ".join(sorted(denied)),
            )
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


def _lock_in_all(board: str, places: Sequence[Path], denied: set[str]) -> Iterator[int]:
    """Yield the locked files; add folders that this user cannot write to, but not all, to a set."""
    refused: dict[Path, OSError] = {}
    for place in places:
        path = place / f"fprc-{board}.lock"
        try:
            yield _lock(board, path)
        except OSError as error:
            refused[path] = error
    problems = list(refused.values())
    if len(refused) < len(places) and all(error.errno in _DENIED for error in problems):
        denied.update(f"{path.parent} ({error.strerror})" for path, error in refused.items())
        return
    failed = in_words(
        f"{path} cannot be locked ({error.strerror})" for path, error in refused.items()
    )
    remedy = "make the file writable for all users"
    if any(isinstance(error, FileNotFoundError) for error in problems):
        remedy = f"create the folder {places[0]}"
    raise DeviceError(
        f"board {board}: {failed}, so another program could use the board too; {remedy}, or set "
        "hardware.boards.lock_folder"
    ) from problems[0]


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
