"""Locks that give one program at a time access to a board, across processes and users."""

import errno
import socket
import sys
from collections.abc import Iterator, Mapping, Sequence
from contextlib import ExitStack, contextmanager
from typing import Any

from fprc.errors import DeviceError


def boards_of(hardware: Mapping[str, Any]) -> list[str]:
    """Return the device names of both boards."""
    return [hardware["boards"][f"{kind}_device"] for kind in ("input", "output")]


@contextmanager
def locked(boards: Sequence[str]) -> Iterator[list[int]]:
    """Hold the locks of boards; the operating system releases them if the process ends.

    A lock is an abstract socket of Linux: its name exists once for all users of a computer, without
    a file that could be deleted or that a user could not write to. Yields the file descriptors: a
    process that inherits them also holds the locks until it ends.
    """
    if sys.platform != "linux":
        raise DeviceError("the real rig can be driven only from Linux; nothing was moved")
    with ExitStack() as held:
        files = []
        for board in sorted(boards):
            lock = held.enter_context(socket.socket(socket.AF_UNIX))
            try:
                lock.bind(f"\0fprc-{board}".encode())
            except OSError as error:
                why = f"cannot be locked ({error.strerror or error})"
                if error.errno == errno.EADDRINUSE:
                    why = (
                        "is in use by another process; wait until it ends, or stop it: "
                        f"`ss -xap | grep fprc-{board}` shows which it is"
                    )
                raise DeviceError(f"board {board} {why}; nothing was moved") from None
            files.append(lock.fileno())
        yield files
