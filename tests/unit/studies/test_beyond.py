"""Tables and figure of families whose numbers are known."""

import json
import math
import re
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
from matplotlib.colors import to_hex
from scipy.stats import t

from fprc.studies import beyond
from fprc.studies.beyond import CLAIMS, numbers_of
from fprc.studies.verdicts import claims_page, decide

CSV = ("models", "claims")
PAGES = (*CSV, "best", "memory", "worth")


@pytest.fixture(scope="module")
def families(make_family):
    """A full family, one of drawn rigs, one with the least that can be, and one that failed."""
    failed = [{"unit": 0, "seed": 601, "failed": "no pressure"}]
    return [
        make_family("dry", fitted=["tables", "orders", "open_loop", "C8"]),
        make_family("drawn", units=9, spread=0.1, fitted=[]),
        make_family("sparse", units=3, models=("fprc", "fuzzy_linear")),
        make_family("broken", cells=failed),
    ]


@pytest.fixture(scope="module")
def verdicts(families):
    judged = [decide(family, CLAIMS, numbers_of(family)) for family in families]
    return pd.concat(judged, ignore_index=True)


def rows_of(table, family):
    return table[table["family"] == family]


def test_means_and_intervals_are_over_units(families):
    table = beyond.means_of_models(families).set_index(["family", "model", "measure"])
    row = table.loc[("drawn", "esn", "reversed")]
    values = np.array([cell["models"]["esn"]["reversed"] for cell in families[1]["cells"]])
    half = t.ppf(0.975, 8) * values.std(ddof=1) / 3.0
    assert row["units"] == 9
    assert [row["mean"], row["low"], row["high"]] == pytest.approx(
        [values.mean(), values.mean() - half, values.mean() + half]
    )


def test_models_begin_with_the_lowest_error(families):
    models = beyond.means_of_models(families)
    page = beyond.models_page(rows_of(models, "dry"))
    errors = [float(text.split()[0]) for text in page["Forward test [kPa]"]]
    assert errors == sorted(errors)
    best = models.set_index(["family", "model", "measure"]).loc[("dry", "fprc", "forward")]
    assert page["Model"].iloc[0] == "FPRC"
    assert errors[0] == pytest.approx(best["mean"], rel=5e-3)
    assert page["Units"].eq("12").all()


def test_mark_beside_a_verdict_says_whom_the_fit_favours(verdicts):
    page = claims_page(verdicts).set_index("Id")
    mean = verdicts[verdicts["id"] == "B1"]["mean"].iloc[0]
    assert page.loc["B1", "dry"] == f"superior†‡ {mean:.3f}"
    assert page.loc["B4", "dry"].startswith("superior† ")
    assert page.loc["B7", "sparse"].startswith("undecided† ")
    assert not page["drawn"].str.contains("[†‡]").any()
    # fitted as well, but there is no verdict
    assert page.loc["B1", "broken"] == "not judged"


def test_tidy_claims_have_a_row_for_each_part(verdicts):
    assert verdicts.groupby(["family", "id"]).size()["dry"].to_dict() == {
        "W1": 1, "W2": 2, "W3": 2, "W4": 1, "B1": 1, "B4": 1, "B7": 3, "B8": 2,
    }  # fmt: skip
    broken = rows_of(verdicts, "broken")
    assert broken["id"].tolist() == [*CLAIMS]
    assert (broken["verdict"] == "not judged").all()


def test_figure_has_a_row_for_each_pair_and_hollow_markers_for_what_is_undecided(verdicts, axes):
    beyond.plot_pairs(verdicts, axes)
    shown = verdicts.dropna(subset="part")
    assert len(axes.get_yticks()) == len(shown[["id", "part"]].drop_duplicates())
    ends = axes.patches[0].get_extents().transformed(axes.transData.inverted())
    assert [ends.x0, ends.x1] == pytest.approx([1 / 1.05, 1.05])
    hollow = [to_hex(bars[0].get_markerfacecolor()) == "#ffffff" for bars in axes.containers]
    assert hollow == shown["verdict"].isin(["undecided", "not judged"]).tolist()
    assert 0 < sum(hollow) < len(hollow)
    centres = [bars[0].get_xdata()[0] for bars in axes.containers]
    assert centres == pytest.approx(shown["mean"].tolist())


@pytest.mark.parametrize("nothing", [False, True])
def test_every_table_page_and_figure_is_written(make_family, tmp_path, nothing):
    paths = []
    for name in ("dry", "viscous"):
        paths.append(tmp_path / f"{name}.json")
        failed = {"cells": [{"unit": 0, "seed": 1, "failed": "no pressure"}]} if nothing else {}
        paths[-1].write_text(json.dumps({"source": "sim", **make_family(name, **failed)}))
    files = [str(tmp_path / f"{name}.csv") for name in CSV]
    pages = [str(tmp_path / f"beyond/{name}.md") for name in PAGES]
    figure = [str(tmp_path / f"pairs.{kind}") for kind in ("pdf", "png")]
    beyond.tabulate_beyond(list(map(str, paths)), *files, pages, figure)
    claims = pd.read_csv(files[1])
    assert set(claims["family"]) == {"dry", "viscous"}
    assert ("not judged" in set(claims["verdict"])) is nothing
    assert all(Path(page).stat().st_size for page in [*pages, *figure])


def test_pages_are_the_blocks_of_the_documentation():
    docs = Path(__file__).parents[3] / "docs"
    begun = {
        name
        for page in ("../README.md", "beyond.md", "beyond-details.md", "benchmark.md")
        for name in re.findall(r"<!-- (\w+): generated -->", (docs / page).read_text("utf-8"))
    }
    assert {f"beyond_{name}" for name in PAGES} == {b for b in begun if b.startswith("beyond_")}


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
    best = beyond.best_of(beyond.measured([family]), "without_p_o", "forward")["model"]
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


def test_claim_without_its_model_or_half_of_its_numbers_is_not_judged(make_family):
    family = make_family(models=("fprc", "fuzzy_linear"))
    rows = judged(family)
    verdicts = first(rows, "verdict")
    assert {name for name in rows if verdicts[name] != "not judged"} == {"B7"}
    assert rows["W1"]["mean"].isna().tolist() == [True]
    for cell in family["cells"]:
        del cell["models"]["fuzzy_linear"]["closed_loop"]
    assert judged(family)["B7"]["verdict"].tolist() == ["not judged"]


def test_pages_name_the_best_of_each_side_and_what_p_o_remembers(make_family):
    families = [make_family(spread=0.0), make_family("broken", cells=[])]
    page = beyond.best_page(families).set_index(["Rigs", "Error"])
    row = page.loc[("dry", "forward test [kPa]")]
    assert row.tolist() == ["13.2, Ridge on low-passes", "12.0, FPRC"]
    assert set(page.loc["broken"].to_numpy().ravel()) == {"-"}
    memory = beyond.memory_page(beyond.means_of_models(families)).set_index("Rigs").loc["dry"]
    assert float(memory["P_o: nonlinear capacity"].split()[0]) == pytest.approx(0.01)
    assert float(memory["theta: memory [s]"].split()[0]) == pytest.approx(0.7)
