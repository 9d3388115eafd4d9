import h5py
import numpy as np
import pytest


def test_all_config_errors_at_once_before_any_job(project):
    done = project.snakemake(
        "all", "--config", "modles={}", "models={fprc: {n_c: 0, n_uu: 3}, esn: {gamma: lots}}"
    )
    assert done.returncode != 0
    wrong = ("modles:", "models.fprc.n_uu:", "models.fprc.n_c = 0:", "models.esn.gamma = lots:")
    assert [key for key in wrong if key not in done.stdout] == []
    assert not project.files("results", "data")
    assert "Traceback" not in done.stdout


def test_repeated_key_is_refused(project):
    (project.folder / "mine.json").write_text('{"seed": 2,\n\n"seed": 3, "models": {"n_y": 5}}')
    done = project.snakemake("--dry-run", "all", "--configfile", "mine.json")
    assert done.returncode != 0
    assert "line 3: seed" in done.stdout
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
    lines = [line for line in done.stdout.splitlines() if "sweep.h5: " in line]
    assert lines, done.stdout
    assert "channel theta_deg: sample 123" in lines[0]
    assert "Traceback" not in done.stdout
    assert smoked_copy.files("results/smoke/raw", "results/smoke/tables") == before


@pytest.mark.slow
def test_diverging_simulation_is_an_error_that_leaves_no_log_and_passes_off_no_old_table(
    smoked_copy,
):
    shaky = "rig={valve: {natural_frequency_rad_per_s: 1300, damping_ratio: 1.5}}"
    raw = smoked_copy.folder / "results/smoke/raw"
    for _ in range(2):
        done = smoked_copy.smoke("table2", "--config", shaky)
        assert done.returncode != 0
        assert "[record sweep] error: " in done.stdout
        assert "Traceback" not in done.stdout
        assert not [*raw.glob("*sweep.h5"), *raw.glob("*complex.h5")]
