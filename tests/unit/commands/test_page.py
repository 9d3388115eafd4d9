"""The commands of docs/commands.md and docs/own-data.md print what the pages say."""

import re
import shlex
from pathlib import Path

import pytest

from fprc.cli import main
from fprc.logs import read_columns

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

    # the same logs as another program might have written them
    page = (DOCS / "own-data.md").read_text(encoding="utf-8")
    Path("data/raw").mkdir(parents=True)
    for name in ("sweep.h5", "complex.h5"):
        Path(name).rename(f"data/raw/{name}")
    program = page.split("```python\n")[1].split("```")[0]
    exec(compile(program, "docs/own-data.md", "exec"), {})
    assert main(["import", "arm_sweep.csv", "--draft"]) == 0
    drafted = capsys.readouterr().out
    assert f"```\n{drafted}```" in page
    Path("sweep.yaml").write_text(drafted)
    assert main("import arm_sweep.csv --map sweep.yaml --out mylogs/sweep.h5".split()) == 0
    names = ("time_s", "theta_deg", "p_exp_command_kpa", "p_o_kpa")
    simulated, imported = (
        read_columns(path, names).channels for path in ("data/raw/sweep.h5", "mylogs/sweep.h5")
    )
    for name in names:
        assert imported[name] == pytest.approx(simulated[name], abs=1e-9)
