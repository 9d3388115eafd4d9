"""Contec analog boards through their C driver, libcaio.so, and the locks that guard them.

Every call returns 0 on success, else a code that ``AioGetErrorString`` translates
(Contec API-AIO).
"""

import contextlib
import ctypes
import socket
import sys
from collections.abc import Iterator, Mapping
from typing import Any

from fprc.errors import DeviceError

_PM10 = 0  # range of +- 10 V
_SIGNATURES = {
    "AioInit": [ctypes.c_char_p, ctypes.POINTER(ctypes.c_short)],
    "AioExit": [ctypes.c_short],
    "AioResetDevice": [ctypes.c_short],
    "AioGetErrorString": [ctypes.c_long, ctypes.c_char_p],
    "AioSetAiRangeAll": [ctypes.c_short, ctypes.c_short],
    "AioSetAoRangeAll": [ctypes.c_short, ctypes.c_short],
    "AioMultiAiEx": [ctypes.c_short, ctypes.c_short, ctypes.POINTER(ctypes.c_float)],
    "AioSingleAoEx": [ctypes.c_short, ctypes.c_short, ctypes.c_float],
}


@contextlib.contextmanager
def locked(hardware: Mapping[str, Any]) -> Iterator[list[int]]:
    """Hold the locks of both boards; the operating system releases them if the process ends.

    A lock is an abstract socket of Linux: its name exists once for all users of a computer, without
    a file that could be deleted or that a user could not write to. Yields the file descriptors: a
    process that inherits them also holds the locks until it ends.
    """
    if sys.platform != "linux":
        raise DeviceError("the real rig can be driven only from Linux; nothing was moved")
    with contextlib.ExitStack() as held:
        files = []
        for board in (hardware["boards"][f"{kind}_device"] for kind in ("input", "output")):
            lock = held.enter_context(socket.socket(socket.AF_UNIX))
            try:
                lock.bind(f"\0fprc-{board}".encode())
            except OSError as error:
                raise DeviceError(
                    f"board {board} is in use by another process ({error.strerror}); wait until it "
                    f"ends, or stop it: `ss -xap | grep fprc-{board}` shows it; nothing was moved"
                ) from None
            files.append(lock.fileno())
        yield files


class Board:
    """One analog board, range +- 10 V: opened by the constructor, released by ``close``.

    ``name`` is the device name, such as AIO001; ``kind`` is Ai to read its inputs, Ao to write its
    outputs. Without ``reset`` its outputs hold their voltages until the first write. Each method
    raises DeviceError if the driver reports an error.
    """

    def __init__(self, library: str, name: str, kind: str, *, reset: bool = True):
        self.name = name
        try:
            self._library = ctypes.CDLL(library or "libcaio.so")
            for call, types in _SIGNATURES.items():
                function = getattr(self._library, call)
                function.argtypes, function.restype = types, ctypes.c_long
        except (OSError, ValueError, AttributeError) as error:  # ValueError: a NUL in the name
            raise DeviceError(
                f"driver {library or 'libcaio.so'}: is not Contec's API-AIO, or cannot be loaded "
                f"({error}); install API-AIO(LNX) from contec.com, or set hardware.boards.library "
                "to its path"
            ) from error
        self._id = ctypes.c_short()
        self._call("AioInit", name.encode(), ctypes.byref(self._id))
        try:
            if reset:
                self._call("AioResetDevice", self._id)
            self._call(f"AioSet{kind}RangeAll", self._id, _PM10)
        except DeviceError:
            with contextlib.suppress(DeviceError):
                self.close()
            raise

    def read(self, n_channels: int) -> "ctypes.Array[ctypes.c_float]":
        """Return the voltages of the channels 0 to ``n_channels`` - 1."""
        volts = (ctypes.c_float * n_channels)()
        self._call("AioMultiAiEx", self._id, n_channels, volts)
        return volts

    def write(self, channel: int, volts: float) -> None:
        """Set the voltage of a channel, which holds it until the next write."""
        self._call("AioSingleAoEx", self._id, channel, volts)

    def close(self) -> None:
        """Release the board."""
        self._call("AioExit", self._id)

    def _call(self, name: str, *arguments: Any) -> None:
        if code := getattr(self._library, name)(*arguments):
            text = ctypes.create_string_buffer(b"no description", 256)
            self._library.AioGetErrorString(code, text)
            raise DeviceError(
                f"board {self.name}: {name} failed with code {code} "
                f"({text.value.decode('utf-8', 'replace')}); check power, cable and device name"
            )
