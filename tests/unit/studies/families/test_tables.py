import json
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from fprc.errors import FprcError
from fprc.studies.families import tables as stage

METRICS = ("train_rmse_kpa", "validation_rmse_kpa", "test_rmse_kpa")
NAMES = ("esn", "fprc", "fuzzy_linear")
PRINTED = {"train_rmse_kpa": [1.0, 0.1], "validation_rmse_kpa": [1.0, 0.1], "test_rmse_kpa": 1.0}
ONES = dict.fromkeys(NAMES, PRINTED)
TABLE_4 = {"fprc": {"sweep": 1.0}, "fprc_pd": {"sweep": 1.0}}
PUBLISHED = {"table_2_models": ONES, "table_3_reversed": ONES, "claims": [],
             "table_4_tracking_rmse_deg": TABLE_4}  # fmt: skip
SEEDS = 3


def reports(error):
    return {
        "source": "sim",
        "models": [
            {"model": name, "trained_on": log, "unit": "kPa", "source": "sim"}
            | dict.fromkeys(METRICS, error)
            for log in ("sweep", "complex")
            for name in NAMES
        ],
    }


CONTROL = {"source": "sim", "rmse_deg": {"sweep/fprc": 1.0, "sweep/fprc_pd": 1.0}}


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


NAMED = {"dry": {"to": []}, "viscous": {"to": ["tables"]}}
TABLES = ("errors", "claims")


@pytest.fixture
def judged(monkeypatch):
    """Judge claims, of which C1a follows the error of the ESN; note what was judged."""
    counts = []

    def judge(results, published, fitted, claims):
        counts.append([len(results.replicates), len(results.grids), len(results.controls)])
        error = results.replicates[0]["models"][0]["test_rmse_kpa"]
        verdicts = {claim.id: "undecided" for claim in claims}
        verdicts |= {"C2": "reproduced", "C1a": "reproduced" if error < 1.0 else "not reproduced"}
        return [
            {"id": claim.id, "claim": claim.text, "verdict": verdicts[claim.id],
             "rig": "fitted" if fitted["to"] else "predicted"}
            for claim in claims
        ]  # fmt: skip

    def members(rigs, published, claims):
        counts.extend([len(r.replicates), len(r.grids), len(r.controls)] for r in rigs)
        errors = [r.replicates[0]["models"][0]["test_rmse_kpa"] for r in rigs]
        held = sum(error < 1.0 for error in errors)
        return {"of": len(rigs), "holds": {c.id: held for c in claims}, "ranges": {}}

    monkeypatch.setattr(stage, "judge_claims", judge)
    monkeypatch.setattr(stage, "members_of", members)
    return counts


@pytest.fixture
def compared(reports_of, judged, tmp_path):
    """Tabulate two named rigs and four drawn ones, of which one failed."""
    files = reports_of({"dry": 0.1, "viscous": -0.2})
    rigs = [
        {"unit": unit, "seed": unit, "compared": reports(error), "measured": CONTROL}
        for unit, error in enumerate((0.5, 0.9, 2.0))
    ]
    rigs.append({"unit": 3, "seed": 3, "failed": "it diverged"})
    drawn = str(tmp_path / "drawn.json")
    Path(drawn).write_text(json.dumps({"source": "sim", "fitted": [], "cells": rigs}))
    tables = {name: [str(tmp_path / f"{name}.{end}") for end in ("csv", "md")] for name in TABLES}
    members = tmp_path / "members.json"
    stage.tabulate_families(**files, **tables, members=str(members), ensemble=drawn, named=NAMED)
    assert json.loads(members.read_text())["of"] == 3
    return tables


def test_named_rigs_are_judged_on_all_seeds_and_others_one_by_one(compared, judged):
    assert judged == [[1, 0, 1]] * 3 + [[SEEDS] * 3] * 2 + [[1, 0, 1]] * 3
    errors = pd.read_csv(compared["errors"][0]).set_index(["rigs", "number"])
    dry = errors.loc["Rig dry"].filter(regex="^Table III?, ", axis="index")
    assert dry["middle"].tolist() == pytest.approx([1.1] * 18)
    sums = errors.loc["Rig viscous", "middle"].filter(like="deviation")
    assert sums.tolist() == pytest.approx([0.2, 0.2, 0.0, 0.0, 0.0])
    drawn = errors.loc["Ensemble"]
    expected = np.quantile([0.5, 0.9, 2.0], (0.5, 0.025, 0.975))
    assert drawn.iloc[0][["middle", "low", "high"]].tolist() == pytest.approx(expected)
    largest = drawn.loc["Tables II and III, largest deviation", "middle"]
    assert largest == pytest.approx(0.5)  # of 0.5, 0.1 and 1
    held = pd.read_csv(compared["claims"][0]).set_index(["rigs", "id"]).loc[("Ensemble", "C1a")]
    assert (held["holds"], held["judged"]) == (2, 3)


def test_tables_show_every_family(compared):
    rows = {}
    for name, (_, page) in compared.items():
        lines = Path(page).read_text().splitlines()
        assert "nan" not in Path(page).read_text()
        rows[name] = [[cell.strip() for cell in x.split("|")[1:-1]] for x in lines if x[:1] == "|"]
    assert rows["errors"][0] == ["Number", "Paper", "Rig dry", "Rig viscous", "Ensemble"]
    assert rows["errors"][2][2].endswith(", +10 %")
    claims = {row[0]: row[2:] for row in rows["claims"]}
    assert claims["C2"][:2] == ["reproduced (predicted)", "reproduced (fitted)"]
    assert claims["C1a"][2] == "2 of 3"
    assert claims["C9a"][2] == "-"  # needs a grid


def test_set_of_which_no_rig_could_be_judged_is_an_error(reports_of, judged, tmp_path):
    drawn = tmp_path / "drawn.json"
    drawn.write_text(json.dumps({"cells": [{"unit": 0, "seed": 0, "failed": "it diverged"}]}))
    with pytest.raises(FprcError, match="drawn.*it diverged"):
        stage.tabulate_families(
            **reports_of({"dry": 0.1}), ensemble=str(drawn), members="",
            errors=[str(tmp_path / "errors.csv")], claims=[], named={"dry": {"to": []}},
        )  # fmt: skip
    assert not (tmp_path / "errors.csv").exists()
