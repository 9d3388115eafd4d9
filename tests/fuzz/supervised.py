"""Run cases in a child process, and replace it if it hangs, crashes or uses too much memory."""

import json
import os
import select
import shutil
import sys
import time
import traceback
import warnings
from collections.abc import Callable, Iterable, Iterator
from pathlib import Path
from typing import IO, Any, NamedTuple

import watched
from judging import HANG, MEMORY, SILENT, TRACEBACK, Case, run

#: The child is replaced after this many cases, which frees leaked memory.
_CASES_EACH = 100


class _Child(NamedTuple):
    number: int
    requests: IO[str]
    answers: IO[bytes]


class _Limit:
    """Deadline of a process in CPU and wall-clock time, counted from now."""

    def __init__(self, number: int, limit_s: float):
        self._number = number
        self._processor_s = watched.processor_s(number) + limit_s
        self._clock_s = time.monotonic() + watched.PATIENCE * limit_s

    def is_over(self) -> bool:
        late = time.monotonic() > self._clock_s
        return late or watched.processor_s(self._number) > self._processor_s


def results(
    numbers: Iterable[int], make: Callable[[int, Path], Case], folder: Path
) -> Iterator[tuple[int, dict[str, Any]]]:
    """Yield the result of each case.

    Parameters
    ----------
    make : callable
        Returns the case with a given number and writes its files into an empty folder.
    folder : Path
        Parent of that folder.
    """
    child, done = None, 0
    try:
        for number in numbers:
            found: dict[str, Any] = {"results": []}
            step = 0
            while step is not None:
                if child is None:
                    child, done = _fork(make, folder), 0
                step, spoiled = _ask(child, number, step, found)
                done += 1
                if spoiled or done >= _CASES_EACH:
                    _end(child)
                    child = None
            yield number, found
    finally:
        if child is not None:
            _end(child)


def _ask(child: _Child, number: int, first: int, found: dict[str, Any]) -> tuple[int | None, bool]:
    """Run a case from a given step; return the next step, and whether to replace the child."""
    print(json.dumps([number, first]), file=child.requests, flush=True)
    step, judging, limit = first, False, _Limit(child.number, watched.LIMIT_S)
    buffer = b""
    while True:
        if select.select([child.answers], [], [], watched.LOOK_S)[0]:
            more = os.read(child.answers.fileno(), 1 << 16)
            buffer += more
            *lines, buffer = buffer.split(b"\n")
            for line in map(json.loads, lines):
                if "begin" in line:
                    step, judging = line["begin"], False
                    limit = _Limit(child.number, line["limit_s"])
                    found |= line["case"]
                elif "judging" in line:
                    judging, limit = True, _Limit(child.number, watched.LIMIT_S)
                elif "result" in line:
                    found["results"].append(line["result"])
                else:
                    return None, line["spoiled"]
            outcome = () if more else (TRACEBACK, f"the process ended {_how(child)}")
        elif watched.memory(child.number) > watched.LIMIT_BYTES:
            outcome = MEMORY, "more than 1 GB"
        elif limit.is_over():
            outcome = HANG, "not done in time"
        else:
            outcome = ()
        if outcome:
            if "rows" not in found:
                raise RuntimeError(f"case {number} could not be made")
            if judging:
                outcome = SILENT, f"the output cannot be judged: {outcome[1]}"
            row = found["rows"][step]
            found["results"].append([row, *outcome, 0.0])
            return (step + 1 if step + 1 < len(found["rows"]) else None), True


def _how(child: _Child) -> str:
    _, status = os.waitpid(child.number, 0)
    code = os.waitstatus_to_exitcode(status)
    return f"by signal {-code}" if code < 0 else f"with code {code}"


def _end(child: _Child) -> None:
    watched.end_session(child.number)
    try:
        os.waitpid(child.number, 0)
    except ChildProcessError:
        pass
    child.requests.close()
    child.answers.close()


# --- in the child process -------------------------------------------------------------------


def _fork(make: Callable[[int, Path], Case], folder: Path) -> _Child:
    to_child, from_here = os.pipe()
    to_here, from_child = os.pipe()
    sys.stdout.flush()
    number = os.fork()
    if number:
        os.close(to_child)
        os.close(from_child)
        return _Child(number, os.fdopen(from_here, "w"), os.fdopen(to_here, "rb", 0))
    try:
        os.setsid()
        os.close(from_here)
        os.close(to_here)
        # show a warning for every command, as in separate processes
        warnings.simplefilter("always", RuntimeWarning)
        with os.fdopen(to_child) as requests, os.fdopen(from_child, "w") as answers:
            for line in requests:
                _serve(*json.loads(line), make, folder, answers)
    except BaseException:
        traceback.print_exc()
    finally:
        os._exit(watched.RAISED)


def _serve(
    number: int, first: int, make: Callable[[int, Path], Case], folder: Path, answers: IO[str]
) -> None:
    def answer(**what: Any) -> None:
        print(json.dumps(what), file=answers, flush=True)

    place = folder / "case"
    shutil.rmtree(place, ignore_errors=True)
    place.mkdir()
    case = make(number, place)
    described = {"kind": case.kind, "what": case.what, "rows": [step.row for step in case.steps]}
    spoiled = False
    for k, step in enumerate(case.steps[first:], start=first):
        answer(begin=k, limit_s=step.limit_s, case=described)
        result, ended = run(step, case, place, lambda: answer(judging=True))
        spoiled |= ended.peak_bytes > watched.LIMIT_BYTES
        answer(result=result)
    answer(spoiled=spoiled)
