import json
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from fprc.studies.stages import rigs as stage

METRICS = ("train_rmse_kpa", "validation_rmse_kpa", "test_rmse_kpa")
NAMES = ("esn", "fprc", "fuzzy_linear")
PRINTED = {"train_rmse_kpa": [1.0, 0.1], "validation_rmse_kpa": [1.0, 0.1], "test_rmse_kpa": 1.0}
ONES = dict.fromkeys(NAMES, PRINTED)
PUBLISHED = {
    "table_2_models": ONES,
    "table_3_reversed": ONES,
    "table_4_tracking_rmse_deg": {"fprc": {"sweep": 1.0}, "fprc_pd": {"sweep": 1.0}},
    "claims": [],
}
SEEDS = 3


def reports(error):
    return {
        "source": "sim",
        "models": [
            {"model": name, "trained_on": log} | dict.fromkeys(METRICS, error)
            for log in ("sweep", "complex")
            for name in NAMES
        ],
    }


CONTROL = {
    "source": "sim",
    "rmse_deg": {"sweep/fprc": 1.0, "sweep/fprc_pd": 1.0},
}


@pytest.fixture
def reports_of(tmp_path):
    """Write the reports of rigs whose 18 errors deviate from print as given, on three seeds."""

    def write(off):
        files = {"models": [], "grids": [], "controls": []}
        for name, deviation in off.items():
            for seed in range(SEEDS):
                contents = (reports(1.0 + deviation), {"source": "sim"}, CONTROL)
                for (part, paths), content in zip(files.items(), contents, strict=True):
                    paths.append(str(tmp_path / f"{name}_{part}_{seed}.json"))
                    (tmp_path / paths[-1]).write_text(json.dumps(content))
        published = tmp_path / "published.yaml"
        published.write_text(json.dumps(PUBLISHED))
        return {"published": str(published), **files}

    return write


@pytest.fixture
def judged_seeds(monkeypatch):
    """Judge three claims, and note the number of seeds that each rig was judged on."""
    counts = []

    def judge(results, published, terms, claims):
        counts.append([len(results.replicates), len(results.grids), len(results.controls)])
        return [
            {"id": "C2", "claim": "lowest", "verdict": "reproduced", "ours": "a: 1",
             "rig": "fitted" if terms else "predicted"},
            {"id": "B1", "claim": "worth", "verdict": "reproduced", "ours": "ratio: 0.7", "rig": "",
             "statements": [{"mean": 0.7, "first": 0.6, "last": 0.8}]},
            {"id": "C9a", "claim": "epsilon", "verdict": "undecided", "ours": "b: 2", "rig": ""},
        ]  # fmt: skip

    monkeypatch.setattr(stage, "judge_claims", judge)
    return counts


@pytest.fixture
def written(tmp_path):
    """The three files of a table."""
    return {end: str(tmp_path / f"table.{end}") for end in ("csv", "md", "tex")}


def test_rigs_side_by_side_are_judged_on_all_seeds(reports_of, judged_seeds, written):
    files = reports_of({"dry": 0.1, "viscous": -0.2})
    stage.compare_rigs(**files, **written, fitted={"dry": [], "viscous": ["tables"]})
    assert judged_seeds == [[SEEDS] * 3] * 2
    table = pd.read_csv(written["csv"])
    printed = table[~table["number"].str.startswith("Table IV")]
    found = printed.groupby("rig")["deviation"].agg(["min", "max", "size"])
    np.testing.assert_allclose(found, [[0.1, 0.1, 18], [-0.2, -0.2, 18]])
    page = Path(written["md"]).read_text()
    assert "over 3 seeds" in page
    (off,) = (line for line in page.splitlines() if "errors of single seeds" in line)
    assert [cell.strip() for cell in off.split("|")[3:5]] == [
        f"{100 * np.log(1.1):.0f} % (rms)", f"{-100 * np.log(0.8):.0f} % (rms)"
    ]  # fmt: skip
    (row,) = (line for line in page.splitlines() if line.startswith("| C2: lowest"))
    assert [cell.strip() for cell in row.split("|")[3:5]] == [
        "reproduced (predicted)", "reproduced (fitted)"
    ]  # fmt: skip
