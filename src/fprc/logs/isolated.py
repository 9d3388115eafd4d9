"""Call a function in a process of its own, with limits on its time and memory.

On a damaged file the HDF5 library and SciPy's reader of MATLAB files can hang, or crash
the process. Files that come from outside are therefore read in a child process.
"""

import contextlib
import os
import pickle
import subprocess
import sys
from collections.abc import Callable
from typing import Any

from fprc.errors import LogError

#: Longest time that reading one file may take, s.
LIMIT_S = 30.0
#: Most memory that the process may ask for, bytes; of which libraries take some 0.5 GB.
LIMIT_BYTES = 4 << 30


def isolated(
    function: Callable[..., Any],
    *arguments: Any,
    what: str,
    limit_s: float = LIMIT_S,
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
    limit_s, limit_bytes : float, int
        Time and address space of the process.

    Raises
    ------
    LogError
        The process crashed, took too long or asked for too much memory; names ``what``.
    Exception
        What the function raised.
    """
    request = pickle.dumps((function, arguments, keywords))
    command = [sys.executable, "-m", "fprc.logs.isolated", str(limit_bytes)]
    damaged = "the file is damaged; `fprc log repair` saves what can be read of a raw log"
    try:
        done = subprocess.run(
            command,
            input=request,
            capture_output=True,
            timeout=limit_s,
            check=False,
            env=os.environ | {"OPENBLAS_NUM_THREADS": "1"},  # each thread reserves memory
        )
    except subprocess.TimeoutExpired:
        raise LogError(f"{what}: not read within {limit_s:g} s; {damaged}") from None
    if done.returncode:
        said = done.stderr.decode(errors="replace").strip().splitlines()
        why = said[-1] if done.returncode > 0 and said else "the library crashed"
        raise LogError(f"{what}: cannot be read ({why}); {damaged}")
    result, error = pickle.loads(done.stdout)
    if isinstance(error, MemoryError):
        raise LogError(
            f"{what}: reading it takes more than {limit_bytes >> 20} MB of memory; it is damaged, "
            "or too large: split it"
        )
    if error is not None:
        raise error
    return result


def _main(limit_bytes: int) -> None:
    """Answer the request on the standard input on the standard output."""
    answer = os.fdopen(os.dup(sys.stdout.fileno()), "wb")
    os.dup2(sys.stderr.fileno(), sys.stdout.fileno())  # what a library prints is no answer
    with contextlib.suppress(ImportError):  # Windows has no such limits
        import resource

        resource.setrlimit(resource.RLIMIT_AS, (limit_bytes, limit_bytes))
        resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
    function, arguments, keywords = pickle.load(sys.stdin.buffer)
    result, error = None, None
    try:
        result = function(*arguments, **keywords)
    except Exception as raised:
        error = raised
    with answer:
        pickle.dump((result, error), answer)


if __name__ == "__main__":
    _main(int(sys.argv[1]))
