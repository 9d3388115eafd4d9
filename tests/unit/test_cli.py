import logging
import os
import re
import shlex
import subprocess
import sys
from unittest.mock import Mock

import numpy as np
import pytest

from fprc.cli import main
from fprc.config import load

pytestmark = pytest.mark.slow

COMMAND = [sys.executable, "-c", "import sys; from fprc.cli import main; sys.exit(main())"]


@pytest.mark.parametrize("unbuffered", ["", "1"])
def test_output_that_nothing_reads_ends_the_command_without_a_traceback(unbuffered):
    read, write = os.pipe()
    os.close(read)
    done = subprocess.run(
        [*COMMAND, "config", "reference"],
        stdout=write,
        stderr=subprocess.PIPE,
        env=os.environ | {"PYTHONUNBUFFERED": unbuffered},
    )
    os.close(write)
    assert (done.returncode, done.stderr) == (141, b"")


def test_log_with_a_fault_is_reported_as_failed(write_log, recorded, capsys):
    theta_deg = np.array(recorded["sweep"]["theta_deg"])
    theta_deg[10:20] = 500.0
    faulty = recorded["sweep"] | {"theta_deg": theta_deg}
    statistics = {"ticks": 4000, "late_s": 1.23456e-5, "odd": None}
    path = write_log(changed=faulty, notes={"p_o_kpa": "a"}, statistics=statistics)
    assert main(["log", "check", str(path)]) == 1
    lines = capsys.readouterr().out.splitlines()
    assert lines[0].endswith("4000 samples at 200 Hz; 1 of 5 checks failed")
    (failed,) = [line for line in lines if "FAILED" in line]
    assert re.match(r"\s+range .* theta_deg: sample 10 is 500 deg, .* -45 to 120, .* 10$", failed)
    assert [line.split() for line in lines[-2:]] == [
        ["p_o_kpa", "a"], ["loop", *"ticks 4000, late_s 1.23e-05, odd None".split()]
    ]  # fmt: skip


def test_unreadable_log_is_named_and_the_next_one_still_judged(
    write_log, recorded, changed, tmp_path, capsys
):
    bad = write_log("bad.h5", changed=changed("theta_deg", 7, np.nan))
    good = write_log("good.h5", changed=recorded["sweep"])
    paths = [tmp_path / "none.h5", bad, good, tmp_path]
    assert main(["log", "check", *map(str, paths)]) == 1
    printed = capsys.readouterr()
    assert printed.out.startswith(f"{good}: ")
    lines = printed.err.splitlines()
    assert [line.split(": ")[1] for line in lines] == [str(paths[k]) for k in (0, 1, 3)]
    assert "sample 7" in lines[1]


def test_interrupt_ends_the_command_without_a_traceback(monkeypatch, capsys):
    monkeypatch.setattr(load, "defaults", Mock(side_effect=KeyboardInterrupt))
    assert main(["config", "defaults"]) == 130
    assert capsys.readouterr().err == "stopped; finished results are kept\n"


@pytest.mark.parametrize(
    ("arguments", "shell", "environment", "code", "message"),
    [
        ("config defaults", "exec {} >/dev/full", {}, 1, "error: the output .*: No space left"),
        ("config check ü.yaml", "exec {}", {"PYTHONIOENCODING": "ascii"}, 1, r"\\xfc.yaml: cannot"),
        ("import arm.csv --draft", "exec {}", {"MPLBACKEND": "nonsense"}, 0, ""),
    ],
)
def test_output_of_any_kind_is_no_reason_for_a_traceback(
    arguments, shell, environment, code, message, tmp_path
):
    (tmp_path / "arm.csv").write_text("t,ü\n0,1\n1,2\n", encoding="utf-8")
    command = shlex.join([*COMMAND, *arguments.split()])
    done = subprocess.run(
        ["sh", "-c", shell.format(command)], cwd=tmp_path, capture_output=True, text=True,
        env=os.environ | environment, check=False,
    )  # fmt: skip
    assert done.returncode == code
    assert re.search(message, done.stderr) if message else done.stderr == ""
    assert len(done.stderr.splitlines()) <= 1


def test_messages_go_to_the_standard_error_of_each_command(monkeypatch, capsys):
    def say():
        logging.getLogger("fprc.some.module").info("ours")
        logging.getLogger("matplotlib").info("of another library")

    monkeypatch.setattr(load, "defaults", say)
    for _ in range(2):
        assert main(["config", "defaults"]) == 0
        assert capsys.readouterr().err == "ours\n"
