import inspect
import re
import shlex
import subprocess
import sys
from functools import partial
from importlib import import_module

import pytest

from fprc.cli import main
from fprc.commands.parser import COMMANDS, parser


def help_of(command, capsys):
    with pytest.raises(SystemExit) as caught:
        main([*command.split(), "--help"])
    assert caught.value.code == 0
    return capsys.readouterr().out


def parsed(line):
    """Return the parsed arguments of a command line, also of one that is redirected."""
    line = re.sub(r" > \S+$", "", line)
    program, *words = shlex.split(line)
    assert program == "fprc"
    return parser().parse_args(words)


@pytest.mark.parametrize("command", COMMANDS)
def test_examples_of_a_command_call_its_function(command, capsys):
    _, _, examples = help_of(command, capsys).partition("examples:\n")
    assert examples
    for line in examples.splitlines():
        assert f"fprc {command}" in line
        given = vars(parsed(line.strip()))
        run = given.pop("run")
        assert isinstance(run, partial)
        module, function = run.args
        called = getattr(import_module(module), function)
        inspect.signature(called).bind(**given)


@pytest.mark.parametrize("command", COMMANDS)
def test_help_of_a_command_is_the_docstring_of_its_function(command, capsys):
    module, _, function = COMMANDS[command].rpartition(".")
    called = getattr(import_module(f"fprc.{module}"), function)
    shown = " ".join(help_of(command, capsys).split())
    text, _, sections = inspect.getdoc(called).replace("``", "`").partition("\n\nParameters\n")
    assert " ".join(re.split(r"\nExamples\n", text)[0].split()) in shown
    for explained in re.findall(r"^\w+ : .*\n((?: +.+\n)+)", sections, re.MULTILINE):
        assert " ".join(explained.split()) in shown


def test_arguments_have_the_types_and_defaults_of_the_signature():
    given = vars(parsed("fprc calibrate a.yaml b.yaml --workers 3"))
    del given["run"]
    assert given == {
        "files": ["a.yaml", "b.yaml"], "out": "config/rigs/fitted.yaml", "published": None,
        "workers": 3,
    }  # fmt: skip
    assert parsed("fprc calibrate").files == ()
    assert parsed("fprc config rig").name is None
    assert parsed("fprc log check a.h5").json_ is False
    assert parsed("fprc log check a.h5 --json").json_ is True


@pytest.mark.parametrize(
    ("words", "message"),
    [
        ("simulat sweep", "did you mean simulate?"),
        ("simulate sweeep --out x.h5", "did you mean sweep?"),
        ("log check x.h5 --jsn", "--jsn; did you mean --json?"),
        ("--versoin", "did you mean --version?"),
    ],
)
def test_wrong_word_is_answered_with_usage_and_the_nearest_name(words, message, capsys):
    with pytest.raises(SystemExit) as caught:
        main(words.split())
    assert caught.value.code == 2
    shown = capsys.readouterr()
    assert shown.out == ""
    assert shown.err.startswith("usage: fprc")
    assert message in shown.err


@pytest.mark.slow
def test_help_imports_no_command_and_no_numerical_library():
    code = (
        "import atexit, sys; from fprc.cli import main; "
        "atexit.register(lambda: print(*sys.modules)); main(sys.argv[1:])"
    )
    done = subprocess.run(
        [sys.executable, "-c", code, "log", "check", "--help"],
        capture_output=True,
        text=True,
        check=True,
    )
    loaded = set(done.stdout.splitlines()[-1].split())
    assert {name for name in loaded if name.startswith("fprc.commands.")} == {
        "fprc.commands.parser"
    }
    assert {"h5py", "numba", "numpy", "pandas", "pydantic", "scipy"} & loaded == set()
