import pytest

from fprc.cli import main
from fprc.commands import completion
from fprc.commands.parser import COMMANDS


def test_missing_shtab_is_an_error_that_names_it(monkeypatch, capsys):
    monkeypatch.setattr(completion, "find_spec", lambda name: None)
    assert main(["completion", "bash"]) == 1
    assert "pip install 'fprc[completion]'" in capsys.readouterr().err


@pytest.mark.parametrize("shell", ["bash", "zsh"])
def test_script_of_a_shell_has_every_command(shell, capsys):
    pytest.importorskip("shtab")
    assert main(["completion", shell]) == 0
    script = capsys.readouterr().out
    assert [name for name in COMMANDS if name.split()[-1] not in script] == []
