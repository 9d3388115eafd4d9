"""The commands of docs/commands.md print what the page says."""

import re
import shlex
from pathlib import Path

import pytest

from fprc.cli import main

DOCS = Path(__file__).parents[3] / "docs"

pytestmark = pytest.mark.slow


def test_commands_of_the_page_print_what_it_says(tmp_path, monkeypatch, capsys):
    (console,) = re.findall(
        r"```console\n(.*?)```", (DOCS / "commands.md").read_text(encoding="utf-8"), re.DOTALL
    )
    commands = [command.partition("\n") for command in console.split("$ ")[1:]]
    assert [line.split()[1] for line, _, _ in commands] == [
        "simulate", "simulate", "log", "train", "predict", "export"
    ]  # fmt: skip
    monkeypatch.chdir(tmp_path)
    for line, _, output in commands:
        program, *words = shlex.split(line)
        assert program == "fprc"
        assert main(words) == 0
        assert capsys.readouterr().out == output
    made = {path.name for path in tmp_path.iterdir()}
    assert made == {"sweep.h5", "complex.h5", "model.h5", "predicted.csv", "fprc_model.h"}
