"""`fprc completion`: a script with which a shell completes the command line."""

import argparse
import re
from collections.abc import Iterator
from importlib.util import find_spec
from typing import Literal

from fprc.commands.parser import parser
from fprc.errors import FprcError


def print_completion(shell: Literal["bash", "zsh", "fish"]) -> None:
    """Print a script with which a shell completes commands, options and files.

    The script is static: no program runs while the user types. Needs shtab: pip install
    'fprc[completion]'. docs/commands.md says where to put it.

    Parameters
    ----------
    shell : str
        Shell of the script.

    Examples
    --------
    eval "$(fprc completion bash)"

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

    top = parser()
    for action in _arguments(top):
        if re.search(r"FILE|SOURCE|\.", str(action.metavar)):
            action.complete = shtab.FILE  # type: ignore[attr-defined]
        elif action.metavar == "FOLDER":
            action.complete = shtab.DIRECTORY  # type: ignore[attr-defined]
    print(shtab.complete(top, shell))


def _arguments(command: argparse.ArgumentParser) -> Iterator[argparse.Action]:
    """Yield the arguments of every command."""
    for action in command._actions:  # noqa: SLF001 (argparse has no public name for them)
        if isinstance(action, argparse._SubParsersAction):  # noqa: SLF001
            for inner in action.choices.values():
                yield from _arguments(inner)
        else:
            yield action
