import json

import numpy as np
import pandas as pd
import pytest

from fprc.stages import rigs as stage

METRICS = ("train_rmse_kpa", "validation_rmse_kpa", "test_rmse_kpa")
NAMES = ("esn", "fprc", "fuzzy_linear")
ONES = {name: dict.fromkeys(METRICS, 1.0) for name in NAMES}
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
    "rmse_deg": {"sweep/fprc/none": 1.0, "sweep/fprc_pd/identified": 1.0},
    "gains": {"identified": {"kp_kpa_per_deg": 4.0}},
}


@pytest.fixture
def compare(tmp_path, monkeypatch):
    """Compare repeats whose 18 errors all deviate from print as given, on three seeds each."""

    def judge(claims, results, published):
        return [
            {"id": "C4b", "verdict": "reproduced",
             "statements": [{"mean": 0.7, "first": 0.6, "last": 0.8}]},
            {"id": "C2", "verdict": "reproduced"},
            {"id": "C9a", "verdict": "undecided"},
        ]  # fmt: skip

    monkeypatch.setattr(stage, "judge_claims", judge)
    published = tmp_path / "published.yaml"
    published.write_text(json.dumps(PUBLISHED))
    csv, md, tex = (str(tmp_path / f"repeats.{end}") for end in ("csv", "md", "tex"))

    def run(off, **settings):
        files = {"models": [], "grids": [], "controls": []}
        for name, deviation in off.items():
            for seed in range(SEEDS):
                contents = (reports(1.0 + deviation), {"source": "sim"}, CONTROL)
                for (part, paths), content in zip(files.items(), contents, strict=True):
                    paths.append(str(tmp_path / f"{name}_{part}_{seed}.json"))
                    (tmp_path / paths[-1]).write_text(json.dumps(content))
        limits = {"largest": 0.3, "points": 1, "worth": (0.6, 0.82)} | settings.pop("limits", {})
        stage.compare_repeats(
            str(published),
            **files,
            csv=csv,
            md=md,
            tex=tex,
            rigs=list(off),
            limits=limits,
            **settings,
        )
        return pd.read_csv(csv, index_col="rig"), (tmp_path / "repeats.md").read_text()

    return run


def test_repeats_land_within_given_limits(compare):
    table, page = compare({"a": 0.08, "b": 0.09}, limits={"median": 0.085})
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
    table, page = compare(off, spread_of=["a", "b", "c"])
    assert table["lands"].to_list() == ["gives the limit"] * 3 + ["yes", "no: median"]
    assert f"median {100 * end:.2f} %, by the spread of a, b, c" in page
