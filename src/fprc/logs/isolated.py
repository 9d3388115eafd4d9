"""Call a function in a process of its own, with limits on its time and memory.

On a damaged file the HDF5 library and SciPy's reader of MATLAB files can hang, or crash
the process. Files that come from outside are therefore read in a child process.
"""

import contextlib
import io
import math
import os
import pickle
import signal
import subprocess
import sys
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from typing import Any

from fprc.errors import LogError

#: Longest time that a processor may spend on reading: so many s, and one for each so many bytes.
_LIMIT_S, _BYTES_PER_S = 5.0, 20e6
#: The process is ended too if it takes so many times longer by the clock: it waits for something.
_PATIENCE = 6.0
#: Most memory that the process may ask for, bytes; of which libraries take some 0.5 GB.
LIMIT_BYTES = 4 << 30

_DAMAGED = "the file is damaged; `fprc log repair` saves what can be read of a raw log"


def isolated(
    function: Callable[..., Any],
    *arguments: Any,
    what: str,
    limit_s: float | None = None,
    limit_bytes: int = LIMIT_BYTES,
    **keywords: Any,
) -> Any:
    """Return what a function returns that runs in a process of its own.

    Parameters
    ----------
    function : callable
        Of a module, not nested; with its arguments and its result it is pickled.
    what : str
        File that is read, for the message.
    limit_s : float, optional
        Processor time of the process; by default what a file of that size may take.
    limit_bytes : int
        Its address space.

    Raises
    ------
    LogError
        The process crashed, took too long or asked for too much memory; names ``what``.
    Exception
        What the function raised.
    """
    limit_s = limit_s or time_limit_s([what])
    answers, ended = _call(function, [arguments], keywords, limit_s, limit_bytes)
    if not answers:
        raise LogError(f"{what}: {ended}")
    return _result(answers[0], what, limit_bytes)


def isolated_each(
    function: Callable[..., Any], paths: Sequence[Path | str], **keywords: Any
) -> list[Any]:
    """Return what a function returns for each of several raw logs; see ``attempt_each``.

    Raises
    ------
    LogError
        All that is wrong with the files, each named.
    """
    found = attempt_each(function, paths, **keywords)
    problems = [str(each) for each in found if isinstance(each, LogError)]
    if problems:
        raise LogError("\n".join(problems))
    return found


def attempt_each(
    function: Callable[..., Any],
    paths: Sequence[Path | str],
    *,
    limit_s: float | None = None,
    limit_bytes: int = LIMIT_BYTES,
    **keywords: Any,
) -> list[Any]:
    """Return what a function returns for each of several raw logs, or the error that says why not.

    One process reads them all. After a file that it does not survive another goes on.

    Parameters
    ----------
    function : callable
        Takes a path, and ``keywords``; see ``isolated``.
    limit_s : float, optional
        Processor time of a process.
    """
    found: list[Any] = []
    while left := list(paths)[len(found) :]:
        answers, ended = _call(
            function,
            [(path,) for path in left],
            keywords,
            limit_s or time_limit_s(left),
            limit_bytes,
        )
        for path, answer in zip(left, answers, strict=False):
            try:
                found.append(_result(answer, str(path), limit_bytes))
            except LogError as error:
                found.append(error)
        if len(answers) < len(left):
            found.append(LogError(f"{left[len(answers)]}: {ended}"))
    return found


def time_limit_s(paths: Sequence[Path | str]) -> float:
    """Return the longest time that a processor may spend on reading files, s."""
    sizes = [path.stat().st_size for path in map(Path, paths) if path.is_file()]
    return _LIMIT_S + sum(sizes) / _BYTES_PER_S


def limit_process(limit_bytes: int, limit_s: float) -> None:
    """Let this process have so much memory and processor time, and leave no image of a crash."""
    with contextlib.suppress(ImportError):  # Windows has no such limits
        import resource

        seconds = math.ceil(limit_s)
        resource.setrlimit(resource.RLIMIT_CPU, (seconds, seconds + 1))
        resource.setrlimit(resource.RLIMIT_AS, (limit_bytes, limit_bytes))
        resource.setrlimit(resource.RLIMIT_CORE, (0, 0))


def _call(
    function: Callable[..., Any],
    requests: Sequence[tuple[Any, ...]],
    keywords: dict[str, Any],
    limit_s: float,
    limit_bytes: int,
) -> tuple[list[tuple[Any, Any]], str]:
    """Return result and error of each request that was answered, and what ended the process."""
    code = f"from fprc.logs.isolated import answer; answer({int(limit_bytes)}, {limit_s})"
    request = pickle.dumps((function, requests, keywords))
    answers, ended = run_limited([sys.executable, "-c", code], limit_s, request)
    return list(_answers(answers)), f"{ended}; {_DAMAGED}"


def run_limited(command: Sequence[str], limit_s: float, request: bytes = b"") -> tuple[bytes, str]:
    """Run a process that calls ``limit_process``; return what it wrote, and what ended it early."""
    late = f"not read within {limit_s:.3g} s"
    try:
        done = subprocess.run(
            command,
            input=request,
            capture_output=True,
            timeout=_PATIENCE * limit_s,
            check=False,
            env=os.environ | {"OPENBLAS_NUM_THREADS": "1"},  # each thread reserves memory
        )
    except subprocess.TimeoutExpired as waited:
        return waited.stdout or b"", late
    if done.returncode == 0:
        return done.stdout, ""
    if done.returncode == -getattr(signal, "SIGXCPU", 0):
        return done.stdout, late
    said = done.stderr.decode(errors="replace").strip().splitlines()
    why = said[-1] if done.returncode > 0 and said else "the library crashed"
    return done.stdout, f"cannot be read ({why})"


def _answers(stream: bytes) -> Iterator[tuple[Any, Any]]:
    """Return the answers that are whole."""
    file = io.BytesIO(stream)
    while True:
        try:
            yield pickle.load(file)
        except (EOFError, pickle.UnpicklingError):
            return


def _result(answer: tuple[Any, Any], what: str, limit_bytes: int) -> Any:
    result, error = answer
    if isinstance(error, MemoryError):
        raise LogError(
            f"{what}: reading it takes more than {limit_bytes >> 20} MB of memory; it is damaged, "
            "or too large: split it"
        )
    if error is not None:
        raise error
    return result


def answer(limit_bytes: int, limit_s: float) -> None:
    """Answer the requests on the standard input, one by one, on the standard output."""
    output = os.fdopen(os.dup(sys.stdout.fileno()), "wb")
    os.dup2(sys.stderr.fileno(), sys.stdout.fileno())  # what a library prints is no answer
    limit_process(limit_bytes, limit_s)
    function, requests, keywords = pickle.load(sys.stdin.buffer)
    with output:
        for arguments in requests:
            result, error = None, None
            try:
                result = function(*arguments, **keywords)
            except Exception as raised:
                error = raised
            pickle.dump((result, error), output)
            output.flush()
