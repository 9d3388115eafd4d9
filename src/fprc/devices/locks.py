"""Locks that give one program at a time access to a board, across processes and users."""

import contextlib
import errno
import socket
import struct
import sys
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path

from fprc.errors import DeviceError
from fprc.escape import visible

#: Process, user and group of the process that listens at a socket.
_CREDENTIALS = struct.Struct("3i")


@contextmanager
def locked(boards: Sequence[str]) -> Iterator[list[int]]:
    """Hold the locks of boards; the operating system releases them if the process ends.

    A lock is an abstract socket of Linux: its name exists once for all users of a computer, without
    a file that could be deleted or that a user could not write to.

    Parameters
    ----------
    boards : sequence of str
        Device names, such as AIO000.

    Yields
    ------
    list of int
        File descriptors. A process that inherits them also holds the locks until it ends.

    Raises
    ------
    DeviceError
        A board is in use, by the process that the message names; or this is not Linux.
    """
    if sys.platform != "linux":
        raise DeviceError("the real rig can be driven only from Linux; nothing was moved")
    with contextlib.ExitStack() as held:
        files = []
        for board in sorted(set(boards)):
            lock = held.enter_context(socket.socket(socket.AF_UNIX))
            name = f"\0fprc-{board}".encode()
            try:
                lock.bind(name)
            except OSError as error:
                why = f"cannot be locked ({error.strerror or error})"
                if error.errno == errno.EADDRINUSE:
                    why = f"is in use by {_holder(name)}; wait until it ends, or stop it"
                raise DeviceError(f"board {board} {why}; nothing was moved") from None
            lock.listen(4096)  # each program that asks for the holder stays in the queue
            files.append(lock.fileno())
        yield files


def _holder(name: bytes) -> str:
    """Describe the process that took a lock."""
    try:
        with socket.socket(socket.AF_UNIX) as asking:
            asking.setblocking(False)
            asking.connect(name)
            found = asking.getsockopt(socket.SOL_SOCKET, socket.SO_PEERCRED, _CREDENTIALS.size)
        process, user, _ = _CREDENTIALS.unpack(found)
    except OSError:  # it has just ended, or does not listen yet
        return "another process"
    place = Path(f"/proc/{process}")
    command = ""
    with contextlib.suppress(OSError):
        command = (place / "cmdline").read_text(errors="replace").replace("\0", " ")
    if process and not place.exists():
        command = (
            "which has ended; a process that it started has the board: pgrep -f "
            "fprc.apparatus.process"
        )
    return visible(f"process {process} of user {user}: {command.strip()[:200] or 'unknown'}")
