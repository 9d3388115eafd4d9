"""Recorded logs of a user, some of them without some channels."""

import json
import re

import h5py
import numpy as np
import pandas as pd
import pytest

from fprc.logs import read_columns, write_raw

SMOKE = ["--configfile", "config/smoke.yaml"]
ARGUMENTS = ["--config", "source=recorded", "folders={raw: mylogs, results: results/mine}"]


@pytest.fixture
def recording(project):
    """Put logs into mylogs/ as an import would: 10 s, and the channels that are asked for."""
    (project.folder / "mylogs").mkdir()

    def put(*channels, names=("sweep", "complex")):
        for number, name in enumerate(names):
            time_s = np.arange(2000) / 200.0
            angle = 20.0 - 20.0 * np.cos((1.0 + number) * time_s)
            held = {
                "theta_deg": angle,
                "p_exp_kpa": 5.0 * angle + 20.0 * np.sin(3.0 * time_s),
                "p_o_kpa": 100.0 + angle,
                "p_i_kpa": 7.0 * angle,
                "phi_deg": angle / 2.0,
            }
            write_raw(
                project.folder / f"mylogs/{name}.h5",
                {"time_s": time_s} | {channel: held[channel] for channel in channels},
                experiment=name.partition("_")[0],
                source="import",
                sample_rate_hz=200.0,
                seed=0,
                software="test",
                rig={},
                notes=json.dumps({"p_exp_kpa": "not in kPa: motor force F [N]"}),
            )
        return project

    return put


@pytest.mark.parametrize(
    ("target", "why"),
    [
        ("fig5", "Fig. 5 needs p_o_kpa in sweep.h5 and p_o_kpa in complex.h5"),
        ("table4", "Table IV needs closed-loop logs mylogs/track_"),
    ],
)
def test_target_that_is_not_available_is_refused_with_the_reason(recording, target, why):
    done = recording("theta_deg", "p_exp_kpa").smoke("--dry-run", target, *ARGUMENTS)
    (line,) = [line for line in done.stdout.splitlines() if "not available" in line]
    assert f"{target}: not available for this data: " in line
    assert why in line


@pytest.mark.slow
def test_targets_that_are_not_available_do_not_stop_the_others(recording):
    project = recording("theta_deg", "p_exp_kpa", "p_o_kpa", names=["sweep"])
    done = project.smoke("table2", "fig9", "claims", "table1", *ARGUMENTS)
    assert done.returncode == 1
    for line in ("table2: not available for this data", "claims: not available for this data"):
        assert line in done.stdout
    made = {path.name for path in (project.folder / "results/mine").rglob("*.*")}
    assert {"fig09_weights.pdf", "table1.md"} <= made
    assert not {"table2.md", "claims.json"} & made


def test_folder_without_logs_is_an_error_that_names_it(project):
    done = project.smoke("--dry-run", "all", *ARGUMENTS)
    assert done.returncode != 0
    assert "mylogs contains no raw log" in done.stdout


@pytest.mark.slow
def test_logs_without_p_o_give_two_models_and_a_page_that_says_so(recording):
    project = recording("theta_deg", "p_exp_kpa", names=("sweep", "complex", "sweep_2"))
    assert project.planned("all", *SMOKE, *ARGUMENTS).keys() == {
        "all", "preprocess", "judge", "tabulate_models", "draw_without_data", "grid",
        "measure_times", "tabulate_times", "draw_experiments", "show_seeds", "report_page",
    }  # fmt: skip
    done = project.smoke("all", *ARGUMENTS)
    assert done.returncode == 0, done.stdout
    results = project.folder / "results/mine"
    table = pd.read_csv(results / "tables/table2.csv")
    assert set(table["model"]) == {"esn", "fuzzy_linear"}
    assert "No FPRC: needs p_o_kpa" in (results / "tables/table2.md").read_text()
    assert "No FPRC: needs p_o_kpa" in (results / "timing/table2_timing.md").read_text()
    page = (results / "report.html").read_text(encoding="utf-8")
    assert "Not available for this data" in page
    assert "Fig. 5" in page
    assert "MEASURED DATA" in page
    trained = read_columns(results / "data/sweep.h5", ("time_s",))
    assert trained.attributes["recordings"] == {
        "mylogs/sweep.h5": 2000, "mylogs/sweep_2.h5": 2000
    }  # fmt: skip


@pytest.mark.slow
def test_closed_loop_logs_of_a_rig_make_table4_and_its_figures(smoked_copy):
    raw = smoked_copy.folder / "mylogs"
    (smoked_copy.folder / "results/smoke/raw").rename(raw)
    for name in ("track_sine_0p2_pd.h5", "complex.h5"):
        (raw / name).unlink()
    for path in raw.glob("*.h5"):
        with h5py.File(path, "a") as log:
            log.attrs["source"] = "rig"
    before = smoked_copy.files("mylogs")
    done = smoked_copy.smoke("table4", "fig12", "fig16", "fig17", *ARGUMENTS)
    assert done.returncode == 0, done.stdout
    assert smoked_copy.files("mylogs") == before
    results = smoked_copy.folder / "results"
    mine, simulated = (
        pd.read_csv(results / folder / "tables/table4.csv").drop(columns="source")
        for folder in ("mine", "smoke")
    )
    missing = (simulated["controller"] == "pd") & (simulated["reference"] == "sine_0p2")
    pd.testing.assert_frame_equal(mine, simulated[~missing].reset_index(drop=True))
    page = (results / "mine/tables/table4.md").read_text()
    assert "No log of 1 of its runs: track_sine_0p2_pd." in page
    assert "Data: recorded on the rig." in page
    assert "simulated" not in page
    assert (results / "mine/figures/fig17_disturbance.pdf").stat().st_size > 100
    with h5py.File(raw / "track_sweep_fprc_pd.h5", "a") as log:
        log.attrs["source"] = "sim"
    refused = smoked_copy.smoke("table4", *ARGUMENTS)
    assert refused.returncode != 0
    assert re.search(r"logs of different sources: .*sim \(mylogs/track_sweep", refused.stdout)
