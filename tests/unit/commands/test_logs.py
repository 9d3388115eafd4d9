import numpy as np
import pytest

from fprc.channels import needed_by
from fprc.cli import main
from fprc.logs import Journal, read_raw

pytestmark = pytest.mark.slow

ATTRIBUTES = {
    "experiment": "sweep",
    "source": "rig",
    "sample_rate_hz": 200.0,
    "seed": 0,
    "software": "fprc test",
    "rig": {},
}


@pytest.fixture
def repair(tmp_path, capsys):
    """Run `fprc log repair` into copy.h5 and return its exit code, output and errors."""

    def run(path):
        code = main(["log", "repair", str(path), "--out", str(tmp_path / "copy.h5")])
        printed = capsys.readouterr()
        return code, printed.out, printed.err

    return run


@pytest.fixture
def journal(tmp_path, channels):
    """Journal of 400 samples that is still open."""
    path = tmp_path / "run.journal"
    with Journal(path, needed_by("sim"), ATTRIBUTES) as journal:
        for k in range(400):
            journal.append(k, [channels[name][k] for name in needed_by("sim")])
        yield journal


def copy_of(tmp_path):
    return read_raw(
        tmp_path / "copy.h5", experiment=None, sample_rate_hz=200.0, rate_tolerance=0.05
    )


# --- journals -------------------------------------------------------------------------------


def test_whole_journal_is_copied_with_code_0(journal, repair, tmp_path, channels):
    journal.close()
    code, out, err = repair(journal.path)
    assert (code, err) == (0, "")
    copy = tmp_path / "copy.h5"
    assert out == f"{copy}: 400 samples from {journal.path}\n  nothing is lost\n"
    log = copy_of(tmp_path)
    for name in needed_by("sim"):
        np.testing.assert_array_equal(log.channels[name], channels[name])
    assert log.attributes["complete"] is True


def test_journal_of_a_killed_run_is_copied_with_code_3(journal, repair, tmp_path, channels):
    last_s = channels["time_s"][-1]
    before = journal.path.read_bytes()
    code, out, _ = repair(journal.path)
    assert code == 3
    assert f"400 samples from {journal.path}" in out
    assert f"  the end mark is missing after {last_s:.3f} s: the program was killed" in out
    assert "nothing is lost" not in out
    assert copy_of(tmp_path).attributes["complete"] is False
    assert journal.path.read_bytes() == before
