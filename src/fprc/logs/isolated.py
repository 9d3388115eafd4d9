"""Call a function in a child process, with limits on its time and memory.

On a damaged file the libraries for HDF5 and MATLAB can hang or crash the process. Files from
outside are therefore read in a child process.
"""

import contextlib
import math
import os
import pickle
import signal
import subprocess
import sys
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

from fprc.errors import LogError

#: Limit on processor time: _LIMIT_S + size / _BYTES_PER_S.
_LIMIT_S, _BYTES_PER_S = 5.0, 20e6
#: Limit on wall time, as a multiple of that: ends a process that is blocked.
_PATIENCE = 12.0
#: Limit on the process's address space, bytes; libraries take about 0.5 GB of it.
_LIMIT_BYTES = 4 << 30


def isolated_each(
    function: Callable[..., Any], paths: Sequence[Path | str], **keywords: Any
) -> list[Any]:
    """Call a function on each of several files and return its results; see ``attempt_each``.

    Raises
    ------
    LogError
        Lists the errors of all files.
    """
    results = attempt_each(function, paths, **keywords)
    problems = [str(result) for result in results if isinstance(result, LogError)]
    if problems:
        raise LogError("\n".join(problems))
    return results


def attempt_each(
    function: Callable[..., Any], paths: Sequence[Path | str], **keywords: Any
) -> list[Any]:
    """Call a function on each of several files; return its result or ``LogError`` for each.

    One child process reads all files. If that exceeds a limit or crashes, each file has one of its
    own.

    Parameters
    ----------
    function : callable
        Takes a path, and ``keywords``. At module level: it is pickled, and so are its arguments
        and result.

    Raises
    ------
    Exception
        Any exception but ``LogError`` that the function raised.
    """
    if not paths:
        return []
    answers = _ask(pickle.dumps((function, paths, keywords)), time_limit_s(paths))
    if isinstance(answers, list):
        for error in answers:
            if isinstance(error, Exception) and not isinstance(error, LogError):
                raise error
        return answers
    if len(paths) == 1:
        return [LogError(f"{paths[0]}: {answers}")]
    return [result for path in paths for result in attempt_each(function, [path], **keywords)]


def time_limit_s(paths: Sequence[Path | str]) -> float:
    """Return the limit on the processor time for reading files, s."""
    sizes = [os.path.getsize(path) for path in paths if os.path.isfile(path)]
    return _LIMIT_S + sum(sizes) / _BYTES_PER_S


def _limit_process(limit_s: float) -> None:
    """Limit this process's memory and processor time, and disable core dumps.

    If the process that started this one is killed, this one ends at its limit, or when it answers.
    """
    with contextlib.suppress(ImportError):  # Windows has no such limits
        import resource

        seconds = math.ceil(limit_s)
        resource.setrlimit(resource.RLIMIT_CPU, (seconds, seconds + 1))
        resource.setrlimit(resource.RLIMIT_AS, (_LIMIT_BYTES, _LIMIT_BYTES))
        resource.setrlimit(resource.RLIMIT_CORE, (0, 0))


def _ask(request: bytes, limit_s: float) -> list[Any] | str:
    """Return the answers of a new process to a request, or why it ended without them."""
    code = f"from fprc.logs.isolated import answer; answer({limit_s})"
    wall_s = _PATIENCE * limit_s
    try:
        done = subprocess.run(
            [sys.executable, "-c", code],
            input=request,
            capture_output=True,
            timeout=wall_s,
            check=False,
            env=os.environ | {"OPENBLAS_NUM_THREADS": "1"},  # each thread reserves memory
        )
    except subprocess.TimeoutExpired:
        busy = "the computer is busy, or the disk does not answer: repeat the command"
        return f"not read within {wall_s:.3g} s; {busy}"
    if done.returncode == 0:
        answers: list[Any] = pickle.loads(done.stdout)
        return answers
    if done.returncode == -getattr(signal, "SIGXCPU", 0):
        many = "it is damaged, or has very many arrays: restore it, or save one matrix"
        return f"not read in {limit_s:.3g} s of processor time; {many}"
    errors = done.stderr.decode(errors="replace").strip().splitlines()
    why = errors[-1] if done.returncode > 0 and errors else "the library crashed"
    return f"cannot be read ({why}); the file is damaged, or too large: restore it, or split it"


def answer(limit_s: float) -> None:
    """Read a request from standard input; write a result or exception for each path to the output.

    If the memory does not suffice, the process ends.
    """
    output = os.fdopen(os.dup(sys.stdout.fileno()), "wb")
    os.dup2(sys.stderr.fileno(), sys.stdout.fileno())  # keep library prints out of the answers
    _limit_process(limit_s)
    function, paths, keywords = pickle.load(sys.stdin.buffer)
    answers: list[Any] = []
    for path in paths:
        try:
            answers.append(function(path, **keywords))
        except MemoryError:
            raise
        except Exception as error:
            answers.append(error)
    with output:
        pickle.dump(answers, output)
