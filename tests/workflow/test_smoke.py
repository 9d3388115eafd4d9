import json
import re
import sys

import pandas as pd
import pytest

TABLES = ["table1", "table2", "table3", "table4", "table2_seeds", "table3_seeds",
          "table4_seeds"]  # fmt: skip
FIGURES = ["fig01_actuator", "fig02_reservoir", "fig03_apparatus", "fig04_hysteresis_actuator",
           "fig05_hysteresis_reservoir", "fig06_esn_system", "fig07_fprc_system", "fig08_training",
           "fig09_weights", "fig10_settings", "fig11_taps", "fig12_sine_0p2", "fig13_sine_0p5",
           "fig14_sweep", "fig15_complex", "fig16_loops", "fig17_disturbance"]  # fmt: skip
CONTRACT = [
    *(f"tables/{name}.{kind}" for name in TABLES for kind in ("csv", "md")),
    *(f"figures/{name}.{kind}" for name in FIGURES for kind in ("pdf", "png")),
    "timing/table2_timing.csv",
    "report.html",
    "claims.json",
    "claims.csv",
]

pytestmark = pytest.mark.slow


def test_smoke_makes_every_promised_output(smoked):
    results = smoked[0].folder / "results/smoke"
    assert [name for name in CONTRACT if (results / name).stat().st_size <= 100] == []


def test_smoke_says_where_the_report_is(smoked):
    assert "Job 0: Target all: open results/smoke/report.html" in smoked[1]


def test_smoke_writes_whole_files_below_results_smoke_and_nowhere_else(smoked):
    files = smoked[0].files("results", "data")
    assert files
    assert all(name.startswith("results/smoke/") and ".part" not in name for name in files)


def rules_run(printed):
    return set(re.findall(r"Finished jobid: \d+ \(Rule: (\w+)\)", printed))


def test_smoke_touches_every_rule(smoked, studied, project):
    working = project.stages().keys()
    assert len(working) > 25
    # these look at results and make none, or take minutes and are tested by themselves
    by_hand = {"check", "readme", "beyond_page", "drift_page"}
    by_hand |= {"grid"}  # of recorded logs: test_recorded.py
    assert working - rules_run(smoked[1]) - rules_run(studied[1]) == by_hand


def test_fitted_rig_is_a_configuration_that_the_workflow_takes(project):
    few = "calibration: {free: [bending.friction_kpa, drift.sigma_kpa], ranges: {}}\n"
    (project.folder / "few.yaml").write_text(few)
    done = project.run(
        *(sys.executable, "-m", "fprc", "calibrate", "config/smoke.yaml", "few.yaml"),
        *("--out", "fitted.yaml", "--workers", "1"),
    )
    assert done.returncode == 0, done.stdout
    head = (project.folder / "fitted.yaml").read_text().replace("#", "")
    assert "with the seed 1, to the terms" in " ".join(head.split())
    done = project.snakemake("--dry-run", "table2", "--configfile", "fitted.yaml")
    assert done.returncode == 0, done.stdout


def test_families_stand_side_by_side(studied):
    folder = studied[0].folder / "results/smoke/families"
    errors = pd.read_csv(folder / "errors.csv").dropna(subset="published")
    assert errors.groupby("rigs").size().to_dict() == dict.fromkeys(
        ("Rig paper", "Rig dry", "Rig viscous", "Ensemble"), 26
    )
    claims = pd.read_csv(folder / "claims.csv")
    held = claims[claims["rigs"] == "Ensemble"].set_index("id")
    assert set(held["judged"]) == {2}
    assert {"C1a", "C7a", "C13a", "C18"} <= set(held.index)
    members = json.loads((folder / "members.json").read_text(encoding="utf-8"))
    assert members["holds"] == held["holds"].astype(int).to_dict()


def test_families_beyond_the_paper_have_every_model_and_a_verdict_on_each_claim(studied):
    folder = studied[0].folder / "results/smoke/beyond"
    claims = pd.read_csv(folder / "claims.csv")
    families = ["paper", "bouc_wen", "dry", "viscous", "ensemble"]
    ids = claims.groupby("family", sort=False)["id"].unique().map(list).to_dict()
    every = ["W1", "W2", "W3", "W4", "B1", "B4", "B7", "B8"]
    assert ids == dict.fromkeys(families, every)
    # two seeds decide nothing
    assert set(claims["verdict"]) <= {"undecided", "not judged"}
    models = pd.read_csv(folder / "models.csv").dropna(axis="columns", how="all")
    forward = models[models["measure"] == "forward"]
    assert forward.groupby("family")["model"].nunique().to_dict() == {
        "paper": 19, "bouc_wen": 14, "dry": 14, "viscous": 14, "ensemble": 14,
    }  # fmt: skip
    assert (forward["units"] == 2).sum() == len(forward) - 3  # the slow models have one seed
