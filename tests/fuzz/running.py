"""Run the steps of a case, each in a process of its own with limits on time and memory."""

import os
import pickle
import resource
import select
import signal
import sys
import tempfile
import traceback
import warnings
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path
from typing import IO

from judging import HANG, LIMIT_BYTES, TRACEBACK, Case, Ended, Result, Step, content_of, judged

#: Limit on wall-clock time over that on CPU time: other processes use the CPU too.
PATIENCE = 3.0
#: Exit code of a function that raised.
RAISED = 70


def attempt(step: Step, case: Case, folder: Path) -> tuple[Result, Ended | None]:
    """Run one step of a case in a forked process, and judge it there.

    A hang or crash ends only that process; then there is no output.
    """
    reader, writer = os.pipe()
    sys.stdout.flush()
    child = os.fork()
    if not child:
        _serve(step, case, folder, writer)
    os.close(writer)
    with open(reader, "rb") as answers:
        late = not select.select([answers], [], [], PATIENCE * step.limit_s)[0]
        if late:
            _end(child)
        answer = answers.read()
    status = os.waitstatus_to_exitcode(os.waitpid(child, 0)[1])
    _end(child)
    if answer:
        return pickle.loads(answer)
    if late or status == -signal.SIGXCPU:
        return Result(step.row, HANG, "not done in time"), None
    return Result(step.row, TRACEBACK, f"the process ended with {status}"), None


def _end(leader: int) -> None:
    """End a process and those that it started."""
    with suppress(ProcessLookupError):
        os.killpg(leader, signal.SIGKILL)


def _serve(step: Step, case: Case, folder: Path, writer: int) -> None:
    """Run and judge a step, write the result, and end this process."""
    try:
        os.setsid()
        resource.setrlimit(resource.RLIMIT_CPU, (int(step.limit_s), resource.RLIM_INFINITY))
        virtual = int(Path("/proc/self/statm").read_text().split()[0]) * resource.getpagesize()
        resource.setrlimit(resource.RLIMIT_AS, (virtual + 2 * LIMIT_BYTES, resource.RLIM_INFINITY))
        # show a warning for every command, as in separate processes
        warnings.simplefilter("always", RuntimeWarning)
        before = content_of(folder)
        ended = _call(lambda: step.call(step.command), folder)
        answer = pickle.dumps((judged(step, case, folder, before, ended), ended))
        with open(writer, "wb") as answers:
            answers.write(answer)
    except BaseException:
        traceback.print_exc()
    finally:
        os._exit(0)


def _call(function: Callable[[], int | None], folder: Path) -> Ended:
    """Call a function in a folder; catch what it and its children print."""
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
        sys.stdout.flush()
        sys.stderr.flush()
        used = (resource.getrusage(who) for who in (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN))
        peak = 1024 * max(one.ru_maxrss for one in used)
        return Ended(code, _text(out), _text(err), peak)


def _text(file: IO[bytes]) -> str:
    file.seek(0)
    return file.read().decode("utf-8", "surrogateescape")
