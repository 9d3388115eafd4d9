import json
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from fprc.stages import rigs as stage

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

    def judge(claims, results, published):
        counts.append([len(results.replicates), len(results.grids), len(results.controls)])
        return [
            {"id": "C2", "claim": "lowest", "verdict": "reproduced", "ours": "a: 1"},
            {"id": "C4b", "claim": "worth", "verdict": "reproduced", "ours": "ratio: 0.7",
             "statements": [{"mean": 0.7, "first": 0.6, "last": 0.8}]},
            {"id": "C9a", "claim": "epsilon", "verdict": "undecided", "ours": "b: 2"},
        ]  # fmt: skip

    monkeypatch.setattr(stage, "judge_claims", judge)
    return counts


@pytest.fixture
def written(tmp_path):
    """The three files of a table."""
    return {end: str(tmp_path / f"table.{end}") for end in ("csv", "md", "tex")}


@pytest.fixture
def compare(reports_of, judged_seeds, written):
    """Compare repeats whose 18 errors all deviate from print as given, on three seeds each."""

    def run(off, limits, **settings):
        limits = {"largest": 0.3, "points": 1, "worth": (0.6, 0.82)} | limits
        stage.compare_repeats(
            **reports_of(off), **written, rigs=list(off), limits=limits, **settings
        )
        assert judged_seeds == [[SEEDS] * 3] * len(off)
        return pd.read_csv(written["csv"], index_col="rig"), Path(written["md"]).read_text()

    return run


def test_repeats_land_within_given_limits(compare):
    table, page = compare({"a": 0.08, "b": 0.09}, {"median": 0.085})
    np.testing.assert_allclose(table["median"], [0.08, 0.09])
    assert table["lands"].to_list() == ["yes", "no: median"]
    assert (table["seeds"] == SEEDS).all()
    assert table["undecided"].to_list() == ["C9a", "C9a"]
    assert "simulated" in page
    assert "median 8.50 %" in page


def test_spread_of_repeats_gives_the_limit_for_the_others(compare):
    # three values with mean 0.07 and standard deviation 0.01; Student's t of 2 degrees of freedom
    end = 0.07 + 2.91999 * 0.01 * np.sqrt(4.0 / 3.0)
    off = {"a": 0.06, "b": 0.07, "c": 0.08, "d": end - 1e-4, "e": end + 1e-4}
    table, page = compare(off, {}, spread_of=["a", "b", "c"])
    assert table["lands"].to_list() == ["yes (median not judged)"] * 3 + ["yes", "no: median"]
    assert f"median {100 * end:.2f} %, by the spread of a, b, c" in page


def test_repeats_that_give_the_limit_of_the_median_are_judged_by_the_others(compare):
    table, _ = compare({"a": 0.02, "b": 0.5}, {"largest": 0.3}, spread_of=["a", "b"])
    assert table["lands"].to_list() == [
        "yes (median not judged)", "no: largest (median not judged)"
    ]  # fmt: skip


def test_variants_are_compared_with_the_spread_of_repeats(reports_of, judged_seeds, written):
    off = {"a": 0.06, "b": 0.07, "c": 0.08, "near": 0.09, "far": 0.11}
    stage.compare_variants(
        **reports_of(off), **written, repeats=["a", "b", "c"], variants=["near", "far"]
    )
    assert judged_seeds == [[SEEDS] * 3] * len(off)
    table = pd.read_csv(written["csv"], index_col="rig", keep_default_na=False)
    # mean 0.07 and standard deviation 0.01; Student's t of 2 degrees of freedom
    end = 0.07 + 2.91999 * 0.01 * np.sqrt(4.0 / 3.0)
    # six digits in the table
    np.testing.assert_allclose(table["end of median"], end, rtol=1e-5)
    assert table["beyond"].to_list() == ["repeat"] * 3 + ["none", "median, largest"]
    page = Path(written["md"]).read_text()
    assert f"median {100 * end:.2f} %, largest {100 * end:.1f} %" in page
    assert "simulated" in page


def test_rigs_side_by_side_are_judged_on_the_deciding_seeds(reports_of, judged_seeds, written):
    files = reports_of({"dry": 0.1, "viscous": -0.2})
    stage.compare_rigs(**files, **written, fitted={"dry": [], "viscous": ["tables"]}, deciding=2)
    assert judged_seeds == [[2] * 3] * 2
    table = pd.read_csv(written["csv"])
    printed = table[~table["number"].str.startswith("Table IV")]
    found = printed.groupby("rig")["deviation"].agg(["min", "max", "size"])
    np.testing.assert_allclose(found, [[0.1, 0.1, 18], [-0.2, -0.2, 18]])
    page = Path(written["md"]).read_text()
    assert "over 3 seeds" in page
    assert "are those of the first 2 seeds" in page
    (off,) = (line for line in page.splitlines() if "errors of single seeds" in line)
    assert [cell.strip() for cell in off.split("|")[3:5]] == [
        f"{100 * np.log(1.1):.0f} % (rms)", f"{-100 * np.log(0.8):.0f} % (rms)"
    ]  # fmt: skip
    (row,) = (line for line in page.splitlines() if line.startswith("| C2: lowest"))
    assert [cell.strip() for cell in row.split("|")[3:5]] == [
        "reproduced (predicted)", "reproduced (fitted)"
    ]  # fmt: skip
