"""Run something in a process of its own, and watch its time and its memory."""

import os
import resource
import select
import signal
import sys
import tempfile
import time
import traceback
from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from pathlib import Path
from typing import NamedTuple

#: Longest time and most memory that a command may take.
LIMIT_S = 10.0
LIMIT_BYTES = 1 << 30
#: Exit code of a function that raised.
RAISED = 70
_LOOK_S = 0.03


class Ended(NamedTuple):
    """How a process ended.

    Attributes
    ----------
    code : int
        Exit code; of a process that a signal ended, minus its number.
    stopped : str
        ``time`` or ``memory`` if it was stopped for that, else empty.
    peak_bytes : int
        Most memory that the process and its children held.
    """

    code: int
    out: str
    err: str
    stopped: str
    peak_bytes: int
    seconds: float


def call(
    function: Callable[[], int | None],
    folder: Path | str,
    *,
    limit_s: float = LIMIT_S,
    limit_bytes: int = LIMIT_BYTES,
) -> Ended:
    """Call a function in a fork of this process, in a folder."""

    def begin(out: int, err: int) -> None:
        os.dup2(out, 1)
        os.dup2(err, 2)
        os.chdir(folder)
        resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
        code = RAISED
        try:
            code = function() or 0
        except SystemExit as end:
            code = end.code if isinstance(end.code, int) else 1
        except BaseException:
            traceback.print_exc()
        finally:
            with suppress(Exception):
                sys.stdout.flush()
                sys.stderr.flush()
            os._exit(code)

    return _watch(begin, limit_s, limit_bytes)


def command(
    arguments: Sequence[str],
    folder: Path | str,
    *,
    environment: Mapping[str, str] | None = None,
    limit_s: float = LIMIT_S,
    limit_bytes: int = LIMIT_BYTES,
) -> Ended:
    """Run a command in a folder."""

    def begin(out: int, err: int) -> None:
        try:
            os.dup2(out, 1)
            os.dup2(err, 2)
            os.chdir(folder)
            os.execvpe(arguments[0], arguments, {**os.environ, **(environment or {})})
        finally:
            os._exit(127)

    return _watch(begin, limit_s, limit_bytes)


def _watch(begin: Callable[[int, int], None], limit_s: float, limit_bytes: int) -> Ended:
    sys.stdout.flush()
    sys.stderr.flush()
    with tempfile.TemporaryFile() as out, tempfile.TemporaryFile() as err:
        begun_s = time.monotonic()
        number = os.fork()
        if number == 0:
            os.setsid()  # so that its children can be stopped with it
            begin(out.fileno(), err.fileno())
        stopped, peak = _wait(number, begun_s + limit_s, limit_bytes)
        with suppress(ProcessLookupError):
            os.killpg(number, signal.SIGKILL)
        _, status, used = os.wait4(number, 0)
        said = []
        for file in (out, err):
            file.seek(0)
            said.append(file.read().decode("utf-8", "surrogateescape"))
        return Ended(
            code=os.waitstatus_to_exitcode(status),
            out=said[0],
            err=said[1],
            stopped=stopped,
            peak_bytes=max(peak, used.ru_maxrss * 1024),
            seconds=time.monotonic() - begun_s,
        )


def _wait(number: int, end_s: float, limit_bytes: int) -> tuple[str, int]:
    """Wait for the end of a process or the breach of a limit; return which, and its memory."""
    peak = 0
    handle = os.pidfd_open(number)
    try:
        while not select.select([handle], [], [], _LOOK_S)[0]:
            peak = max(peak, sum(_memory(one) for one in _family(number)))
            if peak > limit_bytes:
                return "memory", peak
            if time.monotonic() > end_s:
                return "time", peak
    finally:
        os.close(handle)
    return "", peak


def _family(number: int) -> list[int]:
    """Return a process and its descendants."""
    found = [number]
    for one in found:
        with suppress(OSError):
            children = Path(f"/proc/{one}/task/{one}/children").read_text().split()
            found += map(int, children)
    return found


def _memory(number: int) -> int:
    """Return the memory of a process, without the files that it has mapped."""
    with suppress(OSError, ValueError, IndexError):
        resident, shared = Path(f"/proc/{number}/statm").read_text().split()[1:3]
        return (int(resident) - int(shared)) * os.sysconf("SC_PAGE_SIZE")
    return 0
