"""Command line: arguments in, exit code out."""

import io
import os
import sys
from collections.abc import Sequence

#: Exit codes that shells report for a program that Ctrl-C, or SIGPIPE, ended.
_STOPPED, _BROKEN_PIPE = 130, 141


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command line and return its exit code."""
    # figures go to files; with an unknown backend, Matplotlib cannot be imported
    os.environ["MPLBACKEND"] = "agg"
    for stream in (sys.stdout, sys.stderr):  # of a terminal without Unicode
        if isinstance(stream, io.TextIOWrapper):
            stream.reconfigure(errors="backslashreplace")
    try:
        return _run(arguments)
    except KeyboardInterrupt:
        print("stopped; finished results are kept", file=sys.stderr)
        return _STOPPED


def _run(arguments: Sequence[str] | None) -> int:
    # imported here, where Ctrl-C ends the command without a traceback
    import logging

    from fprc.commands.parser import parser
    from fprc.errors import FprcError

    # the messages of this package, not those of other libraries
    messages = logging.getLogger("fprc")
    messages.handlers = [logging.StreamHandler()]
    messages.setLevel(logging.INFO)
    try:
        try:
            options = parser().parse_args(arguments)
            return options.run(options) or 0
        finally:
            sys.stdout.flush()
    except FprcError as error:
        problem = str(error)
    except ModuleNotFoundError as error:
        problem = f"{error}; install what the workflow needs: pip install 'fprc[workflow]'"
    except OSError as error:
        if error.errno is None:  # of a library, not of the operating system
            raise
        if error.filename is None:
            # what is left to print, so that Python's flush at exit does not fail too
            os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        if isinstance(error, BrokenPipeError):  # the reader has closed the pipe, as after `| head`
            return _BROKEN_PIPE
        what = error.filename or "the output cannot be written"
        problem = f"{what}: {error.strerror}; check the disk and the path"
    print(f"error: {problem}", file=sys.stderr)
    return 1
