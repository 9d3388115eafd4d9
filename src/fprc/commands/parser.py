"""The command line, as the signatures and docstrings of the commands describe it.

The function of a command is written for Python and for the command line:

- Parameters before ``*`` are positional arguments; those after it are options. An underscore at
  the end, which keeps a name apart from one of Python's, is left out: ``--map`` is ``map_``.
- The annotation is one of ``_KINDS`` or a ``Literal`` of the allowed words.
- A type in capitals in the docstring is the placeholder: ``out : FILE.h5``.
- Summary, extended summary, Parameters and Examples are the help.

Functions are read as text: importing their modules takes seconds, and the help must appear at
once.
"""

import argparse
import ast
import re
import textwrap
from collections.abc import Iterable
from difflib import get_close_matches
from functools import partial
from importlib import import_module
from pathlib import Path
from typing import Any

from fprc import __version__

#: Commands and their functions, as ``package.module.function``.
COMMANDS = {
    "simulate": "commands.simulate.simulate",
    "train": "commands.models.train",
    "predict": "commands.models.predict",
    "export": "commands.export.export_c",
    "import": "recordings.import_recording.import_or_draft",
    "log check": "commands.logs.check",
    "log repair": "commands.logs.repair",
    "readout": "recordings.readout.report_readout",
    "config check": "commands.configuration.check",
    "config defaults": "commands.configuration.defaults",
    "config reference": "commands.configuration.reference",
    "config rig": "commands.configuration.rig",
    "config published": "commands.configuration.published",
    "calibrate": "commands.calibrate.calibrate_from_files",
    "rig check": "apparatus.command.check",
    "rig run": "apparatus.command.run",
}

#: The first words of commands of two words, and what these commands do.
_GROUPS = {
    "log": "Check or repair experiment logs",
    "config": "Check or explain the configuration",
    "rig": "Check and run the real rig",
}

_ABOUT = """\
Hysteresis compensation by pneumatic physical reservoir computing.
`snakemake --cores 2 all` makes the tables and figures of the paper.

to begin:
  fprc simulate sweep --out sweep.h5
  fprc train sweep.h5 --out model.h5
  fprc predict model.h5 sweep.h5 --out predicted.csv
"""

#: Annotations of parameters, and what they mean to argparse.
_KINDS: dict[str, dict[str, Any]] = {
    "str": {},
    "str | None": {},
    "int | None": {"type": int},
    "float | None": {"type": float},
    "bool": {"action": "store_true"},
    "Sequence[str]": {"nargs": "+"},
}


class _Parser(argparse.ArgumentParser):
    """A parser that suggests the nearest name for an unknown one."""

    def __init__(self, **settings: Any) -> None:
        super().__init__(formatter_class=argparse.RawDescriptionHelpFormatter, **settings)

    def parse_known_args(self, args: Any = None, namespace: Any = None) -> Any:
        """Refuse unknown arguments here, where the options of the command are known."""
        known, unknown = super().parse_known_args(args, namespace)
        if unknown:
            hint = _nearest(unknown[0], self._option_string_actions)
            self.error(f"unrecognized arguments: {' '.join(unknown)}{hint}")
        return known, unknown

    def _check_value(self, action: argparse.Action, value: Any) -> None:
        try:
            super()._check_value(action, value)
        except argparse.ArgumentError as error:
            error.message += _nearest(value, action.choices or ())
            raise


def _nearest(word: str, names: Iterable[str]) -> str:
    near = get_close_matches(word, list(names), n=1)
    return f"; did you mean {near[0]}?" if near else ""


def parser() -> argparse.ArgumentParser:
    """Return the parser of the command line.

    After parsing, ``run`` of the namespace is a function that takes it and runs the command.
    """
    top = _Parser(
        prog="fprc", description=_ABOUT, epilog="`fprc COMMAND --help` explains a command."
    )
    top.add_argument("--version", action="version", version=f"fprc {__version__}")
    top.set_defaults(run=lambda _: top.print_help())
    commands = top.add_subparsers(title="commands", metavar="COMMAND")
    verbs: dict[str, Any] = {}
    for command, run in COMMANDS.items():
        group, _, name = command.rpartition(" ")
        if group and group not in verbs:
            words = _GROUPS[group]
            first = commands.add_parser(group, help=words, description=f"{words}.")
            verbs[group] = first.add_subparsers(title="verbs", required=True)
        _add_command(verbs.get(group, commands), name, run)
    return top


def _add_command(commands: Any, name: str, run: str) -> None:
    module, _, function = run.rpartition(".")
    parameters, docstring = _read(module, function)
    text, *rest = re.split(r"^(\w+)\n-+\n", docstring.replace("``", "`"), flags=re.MULTILINE)
    sections = dict(zip(rest[::2], rest[1::2], strict=True))
    summary, *more = [" ".join(part.split()) for part in text.split("\n\n")]
    command = commands.add_parser(
        name,
        help=summary.rstrip("."),
        description="\n\n".join(
            textwrap.fill(part, 79, break_on_hyphens=False) for part in (summary, *more)
        ),
        epilog="examples:\n" + textwrap.indent(sections["Examples"].strip(), "  "),
    )
    command.set_defaults(run=partial(_call, f"fprc.{module}", function))
    described = {
        parameter: (placeholder, " ".join(lines.split()))
        for parameter, placeholder, lines in re.findall(
            r"^(\w+) : (.+)\n((?: +.+\n?)+)", sections.get("Parameters", ""), re.MULTILINE
        )
    }
    required = [None] * (len(parameters.args) - len(parameters.defaults))
    for parameter, default in zip(
        [*parameters.args, *parameters.kwonlyargs],
        [*required, *parameters.defaults, *parameters.kw_defaults],
        strict=True,
    ):
        name, annotation = ast.unparse(parameter).split(": ")
        settings = _settings(annotation, default, *described[name])
        if parameter in parameters.kwonlyargs:
            option = f"--{name.rstrip('_').replace('_', '-')}"
            command.add_argument(option, dest=name, required=default is None, **settings)
            continue
        if default is not None:
            settings["nargs"] = "*" if "nargs" in settings else "?"
        command.add_argument(name, **settings)


def _read(module: str, function: str) -> tuple[ast.arguments, str]:
    """Return parameters and docstring of a function, without importing its module."""
    path = Path(__file__).parents[1].joinpath(*module.split(".")).with_suffix(".py")
    tree = ast.parse(path.read_text(encoding="utf-8"))
    functions = (node for node in tree.body if isinstance(node, ast.FunctionDef))
    node = next(node for node in functions if node.name == function)
    docstring = ast.get_docstring(node, clean=False) or ""  # cleaning imports inspect
    return node.args, textwrap.dedent(f"    {docstring}")


def _settings(
    annotation: str, default: ast.expr | None, placeholder: str, text: str
) -> dict[str, Any]:
    """Return what a parameter means to argparse."""
    if annotation.startswith("Literal"):
        settings: dict[str, Any] = {"choices": ast.literal_eval(annotation.removeprefix("Literal"))}
    else:
        settings = dict(_KINDS[annotation])
    if placeholder[0].isupper():
        settings["metavar"] = placeholder
    if default is not None:
        settings["default"] = value = ast.literal_eval(default)
        text += f" (default: {value})" if isinstance(value, str) else ""
    return settings | {"help": text.replace("%", "%%")}


def _call(module: str, function: str, options: argparse.Namespace) -> Any:
    given = {key: value for key, value in vars(options).items() if key != "run"}
    return getattr(import_module(module), function)(**given)
