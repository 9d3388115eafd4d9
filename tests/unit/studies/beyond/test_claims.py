"""Claims B1-B7 in families whose ratios are known."""

import math
from pathlib import Path

import numpy as np
import pytest

from fprc.studies.beyond.claims import CLAIMS, beside_page


@pytest.fixture
def judged(judge_claims):
    """Return what judges B1-B7 in a family: the rows of their parts, by claim."""
    return lambda family: dict(iter(judge_claims(family).groupby("id")))


def first(rows, column):
    """Return what the first part of each claim has in a column."""
    return {name: of_claim[column].iloc[0] for name, of_claim in rows.items()}


def test_claims_stand_in_the_page_that_was_written_before():
    page = (Path(__file__).parents[4] / "docs/archive/preregistration.md").read_text(
        encoding="utf-8"
    )
    for name, claim in CLAIMS.items():
        assert f"| {name} | {claim.text} |" in page


def test_every_claim_compares_what_it_says(make_family, judged):
    rows = judged(make_family(spread=0.0))
    parts = {name: of_claim["mean"].round(6).tolist() for name, of_claim in rows.items()}
    assert parts["B1"] == parts["B2"] == pytest.approx([1 / 1.3], abs=1e-6)
    assert parts["B3"] == pytest.approx([1 / 1.3, 1 / 1.3], abs=1e-6)
    assert parts["B4"] == pytest.approx([1 / 1.15], abs=1e-6)
    assert parts["B5"] == pytest.approx([1 / 1.25], abs=1e-6)
    assert parts["B6"] == pytest.approx([0.95 / 1.1], abs=1e-6)
    assert parts["B7"] == pytest.approx([math.hypot(12.0, 10.0) / 15.0] * 3, abs=1e-6)
    verdicts = first(rows, "verdict")
    assert verdicts.pop("B7") == "equivalent"
    assert set(verdicts.values()) == {"superior"}


def test_repeats_of_a_rig_are_averaged_first(make_family, judged):
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
    row = judged(family)["B1"].iloc[0]
    assert row["units"] == 9
    assert row["mean"] == pytest.approx(math.exp(np.mean(ratios)))


def test_missing_numbers_leave_their_pairs_only(make_family, judged):
    family = make_family(units=12)
    cells = family["cells"]
    cells[0] = {"unit": 0, "seed": 601, "failed": "the reservoir is empty"}
    del cells[1]["models"]["fprc_lowpass"]
    cells[2]["models"]["ridge_p_o"] = {"failed": "the output is not finite"}
    del cells[3]["models"]["fprc"]["closed_loop"]
    rows = judged(family)
    units, dropped = first(rows, "units"), first(rows, "dropped")
    lost = {name: (units[name], dropped[name]) for name in rows}
    assert lost["B1"] == lost["B2"] == lost["B4"] == (10, 2)
    assert lost["B3"] == (9, 3)
    assert lost["B5"] == lost["B6"] == lost["B7"] == (11, 1)


def test_claim_without_its_model_is_not_judged(make_family, judged):
    rows = judged(make_family(models=("fprc", "fuzzy_linear")))
    verdicts = first(rows, "verdict")
    assert {name for name in rows if verdicts[name] != "not judged"} == {"B7"}
    assert rows["B5"]["mean"].isna().tolist() == [True]


def test_half_of_a_claim_is_not_judged(make_family, judged):
    family = make_family()
    for cell in family["cells"]:
        del cell["models"]["fprc"]["closed_loop"]
    assert judged(family)["B3"]["verdict"].tolist() == ["not judged"]


def test_few_units_decide_nothing(make_family, judged):
    rows = judged(make_family(units=7, spread=0.0))
    assert set(first(rows, "verdict").values()) == {"undecided"}


def test_verdict_that_few_subsets_share_is_shown_as_unstable(make_family, judged, monkeypatch):
    monkeypatch.setattr("fprc.evaluation.paired._share_of_subsets", lambda *rest: 0.9)
    rows = judged(make_family(spread=0.0))
    assert set(first(rows, "verdict").values()) <= {"undecided", "not judged"}
    decided = set(first(rows, "words").values()) - {"undecided", "not judged"}
    assert decided
    assert all(words.rstrip("†‡").endswith(", unstable") for words in decided)


def test_ratios_beside_b1_are_those_of_the_models(make_family):
    family = make_family(spread=0.0)
    models = family["cells"][0]["models"]
    errors = {name: report["forward"] for name, report in models.items()}
    compared = [
        ("fprc_tuned", "fprc_lowpass_tuned"),
        ("fprc", "bank"),
        ("fprc_tuned", "bank_tuned"),
    ]
    found = [float(text.split()[0]) for text in beside_page([family])["dry"]]
    assert found == pytest.approx(
        [errors[ours] / errors[theirs] for ours, theirs in compared], rel=0.01
    )
    for cell in family["cells"]:
        cell["models"].pop("bank", None)
    assert [text == "-" for text in beside_page([family])["dry"]] == [False, True, False]
