"""Run a function or command in another process with limits on time and memory."""

import os
import resource
import select
import signal
import subprocess
import sys
import tempfile
import time
import traceback
from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from pathlib import Path
from typing import IO, NamedTuple

#: Limits of a command: CPU time and memory.
LIMIT_S = 10.0
LIMIT_BYTES = 1 << 30
#: Wall-clock limit over CPU limit: other processes use the CPU too.
PATIENCE = 3.0
#: Exit code of a function that raised.
RAISED = 70
#: Time between two checks of a process's memory.
LOOK_S = 0.03


class Ended(NamedTuple):
    """How a process ended.

    Attributes
    ----------
    code : int
        Exit code, or minus the number of the signal that ended the process.
    stopped : str
        The limit that was exceeded, ``time`` or ``memory``, or empty.
    peak_bytes : int
        Peak memory of the process and its children.
    """

    code: int
    out: str
    err: str
    stopped: str
    peak_bytes: int
    seconds: float


def call(function: Callable[[], int | None], folder: Path | str) -> Ended:
    """Call a function in this process, in a folder, without limits of its own."""
    begun_s = time.monotonic()
    here = os.getcwd()
    kept = os.dup(1), os.dup(2)
    code = RAISED
    with tempfile.TemporaryFile() as out, tempfile.TemporaryFile() as err:
        os.dup2(out.fileno(), 1)
        os.dup2(err.fileno(), 2)
        os.chdir(folder)
        try:
            code = function() or 0
        except SystemExit as end:
            code = end.code if isinstance(end.code, int) else 1
        except BaseException:
            traceback.print_exc()
        finally:
            sys.stdout.flush()
            sys.stderr.flush()
            os.chdir(here)
            for number, old in enumerate(kept, start=1):
                os.dup2(old, number)
                os.close(old)
        used = (resource.getrusage(who) for who in _WHOSE)
        peak = 1024 * max(one.ru_maxrss for one in used)
        return Ended(code, _text(out), _text(err), "", peak, time.monotonic() - begun_s)


_WHOSE = (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN)


def _text(file: IO[bytes]) -> str:
    file.seek(0)
    return file.read().decode("utf-8", "surrogateescape")


def command(
    arguments: Sequence[str],
    folder: Path | str,
    *,
    environment: Mapping[str, str] | None = None,
    limit_s: float = LIMIT_S,
    limit_bytes: int = LIMIT_BYTES,
) -> Ended:
    """Run a command in a folder."""

    begun_s = time.monotonic()
    with tempfile.TemporaryFile() as out, tempfile.TemporaryFile() as err:
        process = subprocess.Popen(
            arguments, cwd=folder, env={**os.environ, **(environment or {})},
            stdin=subprocess.DEVNULL, stdout=out, stderr=err, start_new_session=True,
        )  # fmt: skip
        stopped, peak = _wait(process.pid, begun_s + limit_s, limit_bytes)
        end_session(process.pid)
        _, status, used = os.wait4(process.pid, 0)
        process.returncode = os.waitstatus_to_exitcode(status)
        peak = max(peak, 1024 * used.ru_maxrss)
        took_s = time.monotonic() - begun_s
        return Ended(process.returncode, _text(out), _text(err), stopped, peak, took_s)


def end_session(leader: int) -> None:
    """End a process and those that it started."""
    with suppress(ProcessLookupError):
        os.killpg(leader, signal.SIGKILL)


def _wait(number: int, end_s: float, limit_bytes: int) -> tuple[str, int]:
    """Wait until a process ends or exceeds a limit; return that limit and its peak memory."""
    peak = 0
    handle = os.pidfd_open(number)
    try:
        while not select.select([handle], [], [], LOOK_S)[0]:
            peak = max(peak, memory(number))
            if peak > limit_bytes:
                return "memory", peak
            if time.monotonic() > end_s:
                return "time", peak
    finally:
        os.close(handle)
    return "", peak


def memory(number: int) -> int:
    """Return the memory of a process and its descendants, without mapped files."""
    family, total = [number], 0
    for one in family:
        with suppress(OSError, ValueError, IndexError):
            resident, shared = Path(f"/proc/{one}/statm").read_text().split()[1:3]
            total += (int(resident) - int(shared)) * _PAGE
            family += map(int, Path(f"/proc/{one}/task/{one}/children").read_text().split())
    return total


def processor_s(number: int) -> float:
    """Return the CPU time of a process and its descendants, including ended ones."""
    family, ticks = [number], 0
    for one in family:
        with suppress(OSError, ValueError, IndexError):
            after_name = Path(f"/proc/{one}/stat").read_text().rpartition(")")[2].split()
            ticks += sum(map(int, after_name[11:15]))
            family += map(int, Path(f"/proc/{one}/task/{one}/children").read_text().split())
    return ticks / os.sysconf("SC_CLK_TCK")


_PAGE = os.sysconf("SC_PAGE_SIZE")
