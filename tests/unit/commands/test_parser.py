import inspect
import re
import shlex
from importlib import import_module

import pytest

from fprc.cli import main
from fprc.commands.parser import COMMANDS, parser


@pytest.mark.parametrize(("command", "run"), [row[:2] for row in COMMANDS])
def test_help_has_examples_that_call_the_function(command, run, capsys):
    with pytest.raises(SystemExit, match="0"):
        main([*command.split(), "--help"])
    shown = capsys.readouterr().out
    assert max(map(len, shown.splitlines())) < 80
    module, function = run.split(":")
    signature = inspect.signature(getattr(import_module(f"fprc.{module}"), function))
    for line in re.findall(r"^ +(fprc .*)", shown, flags=re.MULTILINE) or [f"fprc {command}"]:
        assert line.startswith(f"fprc {command}")
        # without a redirection
        given = vars(parser().parse_args(shlex.split(re.sub(r" > \S+$", "", line))[1:]))
        del given["run"]
        # every option has its parameter, and every parameter its option
        assert given.keys() == signature.parameters.keys()


@pytest.mark.parametrize(
    "words", ["simulat sweep", "simulate sweeep --out x.h5", "log check x.h5 --jsn"]
)
def test_wrong_word_is_answered_with_usage(words, capsys):
    with pytest.raises(SystemExit, match="2"):
        main(words.split())
    shown = capsys.readouterr()
    assert shown.out == ""
    assert shown.err.startswith("usage: fprc")
