"""`fprc completion`: a script with which a shell completes the command line."""

import argparse
from collections.abc import Callable, Iterator
from importlib.util import find_spec

from fprc.errors import FprcError


def print_completion(shell: str, parser: Callable[[], argparse.ArgumentParser]) -> None:
    """Print a script that completes commands, options, choices and files.

    The script is static: no program runs while the user types.

    Parameters
    ----------
    shell : {"bash", "zsh", "fish"}
    parser : callable
        Returns the parser of the command line.

    Raises
    ------
    FprcError
        shtab is not installed.
    """
    if find_spec("shtab") is None:
        raise FprcError(
            "fprc completion needs shtab; install it with: pip install 'fprc[completion]'"
        )
    import shtab

    whole = parser()
    for action in _arguments(whole):
        if (action.metavar or "").endswith("FOLDER"):
            action.complete = shtab.DIRECTORY
        elif action.nargs != 0 and action.choices is None and action.type is None:
            action.complete = shtab.FILE
    print(shtab.complete(whole, shell))


def _arguments(parser: argparse.ArgumentParser) -> Iterator[argparse.Action]:
    """Yield the arguments of every command."""
    for action in parser._actions:
        if isinstance(action, argparse._SubParsersAction):
            for command in action.choices.values():
                yield from _arguments(command)
        else:
            yield action
