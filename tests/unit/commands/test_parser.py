import argparse
import inspect
import shlex
import subprocess
import sys
from functools import partial
from importlib import import_module

import pytest

from fprc.cli import main
from fprc.commands.parser import parser


def commands(command):
    """Return a parser and those of all commands below it."""
    found = [command]
    for action in command._actions:
        if isinstance(action, argparse._SubParsersAction):
            found += [each for below in action.choices.values() for each in commands(below)]
    return found


def arguments(command):
    return [each for each in command._actions if not isinstance(each, argparse._SubParsersAction)]


ALL = {each.prog: each for each in commands(parser())}
RUN = {name: each for name, each in ALL.items() if each.epilog and each.prog != "fprc"}


def test_every_command_is_there():
    assert {name.removeprefix("fprc ") for name in RUN} == {
        "simulate", "train", "predict", "export", "import", "log check", "log repair", "readout",
        "config check", "config defaults", "config schema", "config reference", "config rig",
        "config published", "calibrate", "rig check", "rig run", "completion",
    }  # fmt: skip
    assert set(ALL) - set(RUN) == {"fprc", "fprc log", "fprc config", "fprc rig"}


@pytest.mark.parametrize("name", ALL)
def test_command_and_each_of_its_arguments_are_described(name):
    assert ALL[name].description
    assert [each.dest for each in arguments(ALL[name]) if not each.help] == []


@pytest.mark.parametrize("name", RUN)
def test_examples_of_a_command_are_commands(name):
    lines = RUN[name].epilog.splitlines()
    assert lines[0] == ("example:" if len(lines) == 2 else "examples:")
    for line in lines[1:]:
        words = shlex.split(line.replace('eval "$(', "").replace(')"', ""))
        assert " ".join(words).startswith(name)
        options = parser().parse_args(words[1:])
        assert callable(options.run)


@pytest.mark.parametrize("name", sorted(set(RUN) - {"fprc import"}))
def test_options_of_a_command_are_the_arguments_of_its_function(name):
    run = RUN[name].get_default("run")
    assert isinstance(run, partial)
    module, function = run.args[0].split(".")
    called = getattr(import_module(f"fprc.commands.{module}"), function)
    given = {each.dest for each in arguments(RUN[name])} - {"help"}
    if name.split()[-1] in ("defaults", "schema", "reference"):
        given.add("page")
    taken = inspect.signature(called).parameters
    assert given <= set(taken)
    needed = {key for key, value in taken.items() if value.default is inspect.Parameter.empty}
    assert needed <= given


def test_fprc_alone_shows_its_help(capsys):
    assert main([]) == 0
    alone = capsys.readouterr().out
    with pytest.raises(SystemExit):
        main(["--help"])
    assert alone == capsys.readouterr().out
    assert "fprc simulate sweep --out sweep.h5" in alone


@pytest.mark.parametrize("group", ["config", "log", "rig"])
def test_group_without_a_verb_shows_its_verbs_as_an_error(group, capsys):
    with pytest.raises(SystemExit) as caught:
        main([group])
    assert caught.value.code == 2
    said = capsys.readouterr()
    assert said.out == ""
    assert f"fprc {group}: error: a verb is missing" in said.err
    assert "    check " in said.err


@pytest.mark.slow
def test_help_starts_without_the_numerical_libraries():
    heavy = {"h5py", "matplotlib", "numba", "numpy", "pandas", "pydantic", "scipy", "sklearn"}
    code = "import sys; from fprc.cli import main; main([]); print(*sys.modules)"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    loaded = set(done.stdout.splitlines()[-1].split())
    assert "fprc.commands.parser" in loaded
    assert heavy & loaded == set()
