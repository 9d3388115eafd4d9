import h5py
import numpy as np
import pytest

WRONG = ["--config", "modles={}", "models={fprc: {n_c: 0, n_uu: 3}, esn: {gamma: lots}}"]
KEYS = ("modles:", "models.fprc.n_uu:", "models.fprc.n_c = 0:", "models.esn.gamma = lots:")


@pytest.mark.parametrize(
    ("asked", "told"),
    [
        (WRONG, KEYS),
        (["--configfile", "mine.json"], ["line 3: seed"]),  # a repeated key
    ],
)
def test_mistakes_are_told_at_once_before_any_job(project, asked, told):
    (project.folder / "mine.json").write_text('{"seed": 2,\n\n"seed": 3, "models": {"n_y": 5}}')
    done = project.snakemake("table1", *asked)
    assert done.returncode != 0
    assert [words for words in told if words not in done.stdout] == []
    assert not project.files("results", "data")
    assert "Traceback" not in done.stdout


@pytest.mark.slow
def test_bad_raw_log_is_one_line_and_nothing_is_overwritten(smoked_copy):
    raw = smoked_copy.folder / "results/smoke/raw/sweep.h5"
    with h5py.File(raw, "a") as log:
        log["theta_deg"][123] = np.nan
    before = smoked_copy.files("results/smoke/raw", "results/smoke/tables")
    done = smoked_copy.smoke("table2")
    assert done.returncode != 0
    assert smoked_copy.smoke("table2").returncode != 0, "asked again, a stale table must not pass"
    (line, *_) = [line for line in done.stdout.splitlines() if "sweep.h5: " in line]
    assert "channel theta_deg: sample 123" in line
    assert "Traceback" not in done.stdout
    assert smoked_copy.files("results/smoke/raw", "results/smoke/tables") == before
