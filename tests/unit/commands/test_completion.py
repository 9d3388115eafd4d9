import shutil
import subprocess

import pytest

from fprc.cli import main
from fprc.commands import completion

#: Calls the function that the script defines, as bash does after a TAB.
ASK = r"""
COMP_WORDS=("$@"); COMP_CWORD=$(($# - 1))
function=$(complete -p fprc | sed 's/.*-F \([^ ]*\) .*/\1/')
"$function" fprc "${COMP_WORDS[COMP_CWORD]}" ""
printf '%s\n' "${COMPREPLY[@]}"
"""


def test_missing_shtab_is_an_error_that_names_it(monkeypatch, capsys):
    monkeypatch.setattr(completion, "find_spec", lambda name: None)
    assert main(["completion", "bash"]) == 1
    assert "pip install 'fprc[completion]'" in capsys.readouterr().err


@pytest.mark.slow
def test_bash_completes_commands_options_choices_and_files(tmp_path, capsys):
    pytest.importorskip("shtab")
    if shutil.which("bash") is None:
        pytest.skip("no bash")
    assert main(["completion", "bash"]) == 0
    script = capsys.readouterr().out
    (tmp_path / "sweep.h5").touch()
    for words, expected in (
        ("tr", ["train"]),
        ("log re", ["repair"]),
        ("simulate c", ["complex"]),
        ("train --mo", ["--model"]),
        ("train sw", ["sweep.h5"]),
        ("export model.h5 --c sw", ["sweep.h5"]),
        ("train --model sw", [""]),
    ):
        command = ["bash", "-c", script + ASK, "bash", "fprc", *words.split()]
        done = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, check=True)
        assert [line.strip() for line in done.stdout.split("\n")[:-1]] == expected, words
