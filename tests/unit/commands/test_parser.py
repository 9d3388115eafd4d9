import inspect
import re
import shlex
import subprocess
import sys
from importlib import import_module

import pytest

from fprc.cli import main
from fprc.commands.parser import COMMANDS, parser


def parsed(line):
    """Return the parsed arguments of a command line, also of one that is redirected."""
    program, *words = shlex.split(re.sub(r" > \S+$", "", line))
    assert program == "fprc"
    return parser().parse_args(words)


@pytest.mark.parametrize(("command", "run"), [row[:2] for row in COMMANDS])
def test_help_has_examples_that_call_the_function(command, run, capsys):
    with pytest.raises(SystemExit, match="0"):
        main([*command.split(), "--help"])
    shown = capsys.readouterr().out
    assert max(map(len, shown.splitlines())) < 80
    module, function = run.split(":")
    signature = inspect.signature(getattr(import_module(f"fprc.{module}"), function))
    for line in [f"fprc {command}", *shown.partition("examples:\n")[2].splitlines()]:
        assert f"fprc {command}" in line
        if signature.parameters and line == f"fprc {command}":
            continue
        given = vars(parsed(line.strip()))
        del given["run"]
        # every option has its parameter, and every parameter its option
        assert given.keys() == signature.parameters.keys()


@pytest.mark.parametrize(
    ("words", "nearest"),
    [("simulat sweep", "simulate"), ("simulate sweeep --out x.h5", "sweep"),
     ("log check x.h5 --jsn", "--json"), ("simulate sweep --seed 1.5 --out x.h5", "--seed")],
)  # fmt: skip
def test_wrong_word_is_answered_with_usage_and_the_nearest_name(words, nearest, capsys):
    with pytest.raises(SystemExit, match="2"):
        main(words.split())
    shown = capsys.readouterr()
    assert shown.out == ""
    assert shown.err.startswith("usage: fprc")
    assert nearest in shown.err.partition("error")[2]


@pytest.mark.slow
def test_help_imports_no_command_and_no_numerical_library():
    code = (
        "import atexit, sys; from fprc.cli import main; "
        "atexit.register(lambda: print(*sys.modules)); main(sys.argv[1:])"
    )
    done = subprocess.run(
        [sys.executable, "-c", code, "log", "check", "--help"],
        capture_output=True, text=True, check=True,
    )  # fmt: skip
    loaded = set(done.stdout.splitlines()[-1].split())
    assert {name for name in loaded if name.startswith("fprc.commands.")} == {
        "fprc.commands.parser"
    }
    assert {"h5py", "numba", "numpy", "pandas", "pydantic", "scipy"} & loaded == set()
