"""Claims in families whose ratios are known."""

import math

import pytest

from fprc.studies.beyond import (
    CLAIMS,
    best_of,
    best_page,
    measured,
    memory_page,
    models,
    numbers_of,
)
from fprc.studies.verdicts import decide


def judged(family):
    """Judge the claims in a family; return the rows of their parts, by claim."""
    return dict(iter(decide(family, CLAIMS, numbers_of(family)).groupby("id")))


def first(rows, column):
    """Return what the first part of each claim has in a column."""
    return {name: of_claim[column].iloc[0] for name, of_claim in rows.items()}


def test_every_claim_compares_what_it_says(make_family):
    rows = judged(make_family(spread=0.0))
    parts = {name: of_claim["mean"].round(6).tolist() for name, of_claim in rows.items()}
    # without P_o the best is the ridge on low-passes
    for name, count in (("W1", 1), ("W2", 2), ("W3", 2)):
        assert parts[name] == pytest.approx([1 / 1.1] * count, abs=1e-6)
    assert parts["W4"] == pytest.approx([1 / 1.05], abs=1e-6)
    assert parts["B1"] == pytest.approx([1 / 1.3], abs=1e-6)
    assert parts["B4"] == pytest.approx([1 / 1.15], abs=1e-6)
    assert parts["B7"] == pytest.approx([math.hypot(12.0, 10.0) / 15.0] * 3, abs=1e-6)
    assert parts["B8"] == pytest.approx([10.0, 0.7 / 0.6], rel=0.02)
    verdicts = first(rows, "verdict")
    assert (verdicts.pop("B7"), verdicts.pop("B8")) == ("equivalent", "inferior")
    assert verdicts.pop("W4") in ("equivalent", "superior")
    assert set(verdicts.values()) == {"superior"}


def test_best_of_a_unit_is_chosen_on_the_others(make_family):
    family = make_family(units=9, spread=0.0)
    for cell in family["cells"]:
        plays, bank = (cell["models"][name] for name in ("plays", "bank"))
        # plays are far better on one unit, and a little worse on all others
        plays["forward"] = 1.0 if cell["unit"] == 3 else bank["forward"] + 0.1
    best = best_of(measured([family]), "without_p_o", "forward")["model"]
    assert best.loc[3] == "bank"
    assert best.drop(3).eq("plays").all()
    numbers = numbers_of(family)["without_p_o", "forward"]
    expected = family["cells"][3]["models"]["bank"]["forward"]
    assert numbers.loc[3] == pytest.approx(expected)


def test_missing_numbers_leave_their_pairs_only(make_family):
    family = make_family(units=12)
    cells = family["cells"]
    cells[0] = {"unit": 0, "seed": 601, "failed": "the reservoir is empty"}
    del cells[1]["models"]["fprc_lowpass"]
    cells[2]["models"]["ridge_p_o"] = {"failed": "the output is not finite"}
    del cells[3]["models"]["fprc"]["closed_loop"]
    rows = judged(family)
    units, dropped = first(rows, "units"), first(rows, "dropped")
    lost = {name: (units[name], dropped[name]) for name in rows}
    assert lost["B1"] == lost["B4"] == (10, 2)
    assert lost["B7"] == (11, 1)
    # FPRC is no longer the best with P_o: it has not all numbers
    assert lost["W1"] == lost["W3"] == (11, 1)


def test_claim_without_its_model_is_not_judged(make_family):
    rows = judged(make_family(models=("fprc", "fuzzy_linear")))
    verdicts = first(rows, "verdict")
    assert {name for name in rows if verdicts[name] != "not judged"} == {"B7"}
    assert rows["W1"]["mean"].isna().tolist() == [True]


def test_half_of_a_claim_is_not_judged(make_family):
    family = make_family()
    for cell in family["cells"]:
        del cell["models"]["fuzzy_linear"]["closed_loop"]
    assert judged(family)["B7"]["verdict"].tolist() == ["not judged"]


def test_verdict_that_few_subsets_share_is_shown_as_unstable(make_family, monkeypatch):
    monkeypatch.setattr("fprc.evaluation.paired._share_of_subsets", lambda *rest: 0.9)
    rows = judged(make_family(spread=0.0))
    assert set(first(rows, "verdict").values()) <= {"undecided", "not judged"}
    decided = set(first(rows, "words").values()) - {"undecided", "not judged"}
    assert decided
    assert all(words.rstrip("†‡").endswith(", unstable") for words in decided)


def test_pages_name_the_best_of_each_side_and_what_p_o_remembers(make_family):
    families = [make_family(spread=0.0), make_family("broken", cells=[])]
    page = best_page(families).set_index(["Rigs", "Error"])
    row = page.loc[("dry", "forward test [kPa]")]
    assert row.tolist() == ["13.2, Ridge on low-passes", "12.0, FPRC"]
    assert set(page.loc["broken"].to_numpy().ravel()) == {"-"}
    memory = memory_page(models(families)).set_index("Rigs").loc["dry"]
    assert float(memory["P_o: nonlinear capacity"].split()[0]) == pytest.approx(0.01)
    assert float(memory["theta: memory [s]"].split()[0]) == pytest.approx(0.7)
