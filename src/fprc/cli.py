"""Command line: arguments in, exit code out."""

import os
import sys
from collections.abc import Sequence

from fprc.commands.parser import parser
from fprc.errors import FprcError

#: Exit code that shells report for a program that SIGPIPE ended.
_BROKEN_PIPE = 141


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command line and return its exit code."""
    try:
        try:
            return _run(arguments)
        finally:
            sys.stdout.flush()
    except BrokenPipeError:  # nothing reads the output any more, as after `| head`
        # so that Python's own flush at exit does not fail too
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return _BROKEN_PIPE


def _run(arguments: Sequence[str] | None) -> int:
    options = parser().parse_args(arguments)
    try:
        return options.run(options) or 0
    except FprcError as error:
        print(f"error: {error}", file=sys.stderr)
        return 1
    except ModuleNotFoundError as error:
        print(
            f"error: {error}; install what the workflow needs: pip install 'fprc[workflow]'",
            file=sys.stderr,
        )
        return 1
    except KeyboardInterrupt:
        print("stopped; finished results are kept", file=sys.stderr)
        return 130
