"""Claims B1-B8 in families whose ratios are known."""

import math
from pathlib import Path

import numpy as np
import pytest

from fprc.studies.beyond.claims import CLAIMS, beside_b1, judge_family


def judged(family):
    return {row["id"]: row for row in judge_family(family)}


def test_claims_stand_in_the_page_that_was_written_before():
    page = (Path(__file__).parents[4] / "docs/archive/preregistration.md").read_text(
        encoding="utf-8"
    )
    for name, claim in CLAIMS.items():
        assert f"| {name} | {claim.text} |" in page


def test_every_claim_compares_what_it_says(make_family):
    rows = judged(make_family(spread=0.0))
    parts = {name: [round(part["mean"], 6) for part in row["parts"]] for name, row in rows.items()}
    assert parts["B1"] == parts["B2"] == pytest.approx([1 / 1.3], abs=1e-6)
    assert parts["B3"] == pytest.approx([1 / 1.3, 1 / 1.3], abs=1e-6)
    assert parts["B4"] == pytest.approx([1 / 1.15], abs=1e-6)
    assert parts["B5"] == pytest.approx([1 / 1.25], abs=1e-6)
    assert parts["B6"] == pytest.approx([0.95 / 1.1], abs=1e-6)
    assert parts["B7"] == pytest.approx([math.hypot(12.0, 10.0) / 15.0] * 3, abs=1e-6)
    assert parts["B8"] == pytest.approx([0.05, 0.5], abs=0.05)
    verdicts = {name: row["verdict"] for name, row in rows.items()}
    assert verdicts.pop("B7") == "equivalent"
    assert set(verdicts.values()) == {"superior"}


def test_repeats_of_a_rig_are_averaged_first(make_family):
    family = make_family(units=9, repeats=3, spread=0.2)
    family["cells"].pop()  # the last rig has two repeats
    errors = {
        (cell["unit"], cell["seed"]): [
            cell["models"][name]["forward"] for name in ("fprc", "fprc_lowpass")
        ]
        for cell in family["cells"]
    }
    ratios = [
        np.mean([math.log(a / b) for (unit, _), (a, b) in errors.items() if unit == rig])
        for rig in range(9)
    ]
    row = judged(family)["B1"]
    assert row["units"] == 9
    assert row["parts"][0]["mean"] == pytest.approx(math.exp(np.mean(ratios)))


def test_missing_numbers_leave_their_pairs_only(make_family):
    family = make_family(units=12)
    cells = family["cells"]
    cells[0] = {"unit": 0, "seed": 601, "failed": "the reservoir is empty"}
    del cells[1]["models"]["fprc_lowpass"]
    cells[2]["models"]["ridge_p_o"] = {"failed": "the output is not finite"}
    del cells[3]["models"]["fprc"]["closed_loop"]
    rows = judged(family)
    lost = {name: (row["units"], row["dropped"]) for name, row in rows.items()}
    assert lost["B1"] == lost["B2"] == lost["B4"] == (10, 2)
    assert lost["B3"] == (9, 3)
    assert lost["B5"] == lost["B6"] == lost["B7"] == (11, 1)
    assert lost["B8"] == (12, 0)


def test_claim_without_its_model_is_not_judged(make_family):
    rows = judged(make_family(models=("fprc", "fuzzy_linear"), capacity=[]))
    assert {name for name, row in rows.items() if row["verdict"] != "not judged"} == {"B7"}
    assert rows["B5"]["parts"] == []


def test_half_of_a_claim_is_not_judged(make_family):
    family = make_family()
    for cell in family["cells"]:
        del cell["models"]["fprc"]["closed_loop"]
    assert judged(family)["B3"]["verdict"] == "not judged"


def test_few_units_decide_nothing(make_family):
    rows = judged(make_family(units=7, spread=0.0))
    assert {row["verdict"] for row in rows.values()} == {"undecided"}


def test_little_nonlinear_capacity_does_not_hold(make_family):
    family = make_family()
    for entry in family["capacity"]:
        entry["sets"]["p_o"]["by_degree"] = {"1": 0.9, "2": 0.03, "3": 0.04}
    row = judged(family)["B8"]
    assert row["verdict"] == "inferior"
    assert row["parts"][0]["mean"] == pytest.approx(-0.03)
    assert row["parts"][1]["mean"] > 0.0


def test_verdict_that_few_subsets_share_is_shown_as_unstable(make_family, monkeypatch):
    monkeypatch.setattr("fprc.claims.paired._share_of_subsets", lambda *rest: 0.9)
    rows = judged(make_family(spread=0.0))
    assert {row["verdict"] for row in rows.values()} <= {"undecided", "not judged"}
    decided = {row["words"] for row in rows.values()} - {"undecided", "not judged"}
    assert decided
    assert all(words.endswith(", unstable") for words in decided)


def test_ratios_beside_b1_are_those_of_the_models(make_family):
    family = make_family(spread=0.0)
    models = family["cells"][0]["models"]
    errors = {name: report["forward"] for name, report in models.items()}
    compared = [
        ("fprc_tuned", "fprc_lowpass_tuned"),
        ("fprc", "bank"),
        ("fprc_tuned", "bank_tuned"),
    ]
    found = [ends["mean"] for ends in beside_b1(family).values()]
    assert found == pytest.approx(
        [errors[ours] / errors[theirs] for ours, theirs in compared], rel=0.01
    )
    for cell in family["cells"]:
        cell["models"].pop("bank", None)
    assert [ends is None for ends in beside_b1(family).values()] == [False, True, False]
