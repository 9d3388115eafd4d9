"""Tables and figure of families whose numbers are known."""

import json
import re
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
from matplotlib.colors import to_hex
from scipy.stats import t

from fprc.studies import beyond as tables
from fprc.studies.beyond import CLAIMS, numbers_of
from fprc.studies.verdicts import claims_page, decide
from fprc.tables.text import markdown

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
    table = tables.models(families).set_index(["family", "model", "measure"])
    row = table.loc[("drawn", "esn", "reversed")]
    values = np.array([cell["models"]["esn"]["reversed"] for cell in families[1]["cells"]])
    half = t.ppf(0.975, 8) * values.std(ddof=1) / 3.0
    assert row["units"] == 9
    assert [row["mean"], row["low"], row["high"]] == pytest.approx(
        [values.mean(), values.mean() - half, values.mean() + half]
    )


def test_pages_survive_a_family_with_nothing(families, verdicts):
    pages = [tables.models_page(rows_of(tables.models(families), "broken"))]
    pages += [claims_page(verdicts), claims_page(rows_of(verdicts, "broken"))]
    for page in pages:
        assert markdown(page, "Note.").count("\n|") == len(page) + 2
        assert "nan" not in page.to_string().lower().split()


def test_models_begin_with_the_lowest_error(families):
    models = tables.models(families)
    page = tables.models_page(rows_of(models, "dry"))
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
    tables.plot_pairs(verdicts, axes)
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
    files = {name: str(tmp_path / f"{name}.csv") for name in CSV}
    pages = [str(tmp_path / f"beyond/{name}.md") for name in PAGES]
    figure = [str(tmp_path / f"pairs.{kind}") for kind in ("pdf", "png")]
    tables.tabulate_beyond(list(map(str, paths)), pages, figure, family="dry", **files)
    claims = pd.read_csv(files["claims"])
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
