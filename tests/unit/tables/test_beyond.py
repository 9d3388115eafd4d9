"""Tables of worlds whose numbers are known."""

import re
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
from scipy.stats import t

from fprc.claims.beyond import judge_world
from fprc.tables import beyond as tables
from fprc.tables import markdown, read_markdown

TITLES = {"fprc": "FPRC", "esn": "ESN", "fuzzy_linear": "Fuzzy-linear", "bank": "Bank"}


@pytest.fixture(scope="module")
def worlds(make_world):
    """A full world, one of drawn rigs, and one with the least that can be."""
    sparse = {"capacity": None, "training_length": None, "step_us": None}
    failed = [{"unit": 0, "seed": 601, "rig": None, "failed": "no pressure"}]
    return [
        make_world("dry"),
        make_world("drawn", units=9, builds=2, spread=0.1, fitted=[]),
        make_world("sparse", units=3, models=("fprc", "fuzzy_linear"), **sparse),
        make_world("broken", cells=failed, **sparse),
    ]


@pytest.fixture(scope="module")
def ledgers(worlds):
    return [judge_world(world, TITLES) for world in worlds]


def means(world, measure, name):
    rows = [
        (cell["unit"], cell["models"][name][measure]["test_rmse_kpa"]) for cell in world["cells"]
    ]
    return pd.DataFrame(rows).groupby(0)[1].mean().to_numpy()


def test_means_and_intervals_are_over_units(worlds):
    table = tables.models(worlds).set_index(["world", "model", "measure"])
    row, values = table.loc[("drawn", "esn", "reversed")], means(worlds[1], "reversed", "esn")
    half = t.ppf(0.975, 8) * values.std(ddof=1) / 3.0
    assert row["units"] == 9
    assert [row["mean"], row["low"], row["high"]] == pytest.approx(
        [values.mean(), values.mean() - half, values.mean() + half]
    )


def test_no_number_is_missing_where_there_are_two_units(worlds, ledgers):
    for table in (
        tables.models(worlds),
        tables.offsets(worlds),
        tables.capacity(worlds),
        tables.lengths(worlds),
    ):
        several = table[table["units"] > 1]
        assert not several.isna().any().any()
        assert np.isfinite(table["mean"]).all()
        assert not table.duplicated([c for c in table if c not in ("mean", "low", "high")]).any()
    claims = tables.claims(ledgers)
    decided = claims[claims["verdict"].isin(["superior", "equivalent", "inferior"])]
    assert len(decided) > 8
    assert not decided.isna().any().any()


def test_tables_of_nothing_have_their_columns(worlds):
    broken = worlds[3:]
    for table in (
        tables.models(broken),
        tables.offsets(broken),
        tables.capacity(broken),
        tables.lengths(broken),
    ):
        assert table.empty
        assert {"world", "mean", "low", "high", "units", "source"} <= set(table)


def test_pages_survive_a_world_with_nothing(worlds, ledgers):
    pages = [
        tables.models_page(tables.models(worlds), "broken", TITLES),
        tables.leaderboard(tables.models(worlds), "broken", TITLES),
        tables.offsets_page(tables.offsets(worlds), "broken", TITLES),
        tables.capacity_page(tables.capacity(worlds), "broken"),
        tables.lengths_page(tables.lengths(worlds), "broken", TITLES),
        tables.claims_page(ledgers),
        tables.details_page(ledgers),
    ]
    for page in pages:
        note, read = read_markdown(markdown(page, "Note."))
        assert (note, list(read)) == ("Note.", list(page))
        assert "nan" not in page.to_string().lower().split()


def test_leaderboard_begins_with_the_lowest_error_and_offers_no_oracle(worlds):
    page = tables.leaderboard(tables.models(worlds), "dry", TITLES)
    errors = [float(text.split()[0]) for text in page["Test RMSE, forward [kPa]"]]
    assert errors == sorted(errors)
    assert page["Model"].iloc[0] == "FPRC, tuned"
    assert not page["Model"].str.contains("test log|matched|oracle").any()
    assert not any("closed" in column for column in page)
    assert {"Test RMSE, reversed [kPa]", "Tracking, open loop [deg]", "One step [us]"} < set(page)


def test_claims_have_one_row_each_and_one_column_per_world(ledgers):
    page = tables.claims_page(ledgers).set_index("Id")
    assert list(page.index) == [f"B{n}" for n in range(1, 9)]
    assert page.loc["B1", "dry rig"].startswith("superior: 0.7")
    assert page.loc["B1", "broken rig"] == "not judged"
    assert page.loc["B8", "dry rig"].startswith("holds: ")


def test_whom_the_rigs_were_fitted_for_stands_beside_each_verdict(ledgers):
    page = tables.claims_page(ledgers).set_index("Id")["Fitted in favour of"]
    assert page["B1"].startswith("dry rig and sparse rig and broken rig: FPRC: its forward error")
    assert page["B1"].endswith("drawn rig: nobody")
    assert page["B8"] == "nobody"


def test_details_say_what_is_missing(ledgers):
    page = tables.details_page(ledgers).set_index(["World", "Id"])
    assert page.loc[("dry rig", "B1"), "Units"] == "12 seeds"
    assert page.loc[("dry rig", "B1"), "Subsets that agree"] == "100 %"
    assert page.loc[("drawn rig", "B1"), "Units"] == "9 rigs"
    assert page.loc[("broken rig", "B1"), "Builds without the pair"] == "1 build"
    assert page.loc[("sparse rig", "B5"), "Builds without the pair"] == "3 builds"
    assert page.loc[("sparse rig", "B5"), "Compared"].startswith("not measured here")


def test_tidy_claims_have_a_row_for_each_part(ledgers):
    table = tables.claims(ledgers)
    assert table.groupby(["world", "id"]).size()["dry"].to_dict() == {
        f"B{n}": 2 if n in (3, 8) else 1 for n in range(1, 9)
    }
    broken = table[table["world"] == "broken"]
    assert broken["id"].tolist() == [f"B{n}" for n in range(1, 9)]
    assert broken["reason"].str.startswith("not measured here").all()


def test_offsets_and_disturbances_have_their_columns(worlds):
    table = tables.offsets(worlds)
    assert set(table["offset_kpa"]) == {-5.0, -2.0, -1.0, 0.0, 1.0, 2.0, 5.0}
    assert set(table["disturbance"]) == {"none", "drift", "pushed"}
    page = tables.offsets_page(table, "dry", TITLES).set_index("Model")
    assert list(page) == [f"{kpa:+d} kPa" for kpa in (-5, -2, -1, 0, 1, 2, 5)] + ["drift", "pushed"]
    assert page.loc["Fuzzy-linear"].ne("-").sum() == 1
    assert page.loc["FPRC"].ne("-").all()


def test_model_of_fewer_seeds_says_so(make_world):
    world = make_world()
    for cell in world["cells"][3:]:
        del cell["models"]["mlp"]
    page = tables.models_page(tables.models([world]), "dry", TITLES)
    assert page.set_index("Model")["Units"][["FPRC", "mlp"]].tolist() == ["12", "3"]


def test_lengths_are_in_order_and_two_logs_last(worlds):
    page = tables.lengths_page(tables.lengths(worlds), "dry", TITLES)
    assert list(page) == ["Model", "15 s", "30 s", "60 s", "two logs"]
    assert page.iloc[0].tolist() == ["FPRC", "16.7", "13.3", "11.7", "10.4"]


def test_blocks_are_those_of_the_pages_and_survive_csv(worlds, ledgers, tmp_path):
    found = {
        "models": tables.models(worlds), "offsets": tables.offsets(worlds),
        "tracking": tables.errors_and_tracking(tables.models(worlds)),
        "capacities": tables.capacity(worlds), "lengths": tables.lengths(worlds),
    }  # fmt: skip
    read = {}
    for name, table in found.items():
        table.to_csv(tmp_path / name, index=False)
        read[name] = pd.read_csv(tmp_path / name)
    verdicts = {"source": "sim", "advice": ["Take a | b.", "Not c."], "ledgers": ledgers}
    blocks = tables.blocks(verdicts, found, "dry", TITLES)
    assert tables.blocks(verdicts, read, "dry", TITLES) == blocks
    assert len(blocks["advice"].splitlines()) == 2
    docs = Path(__file__).parents[3] / "docs"
    begun = {
        name
        for page in ("beyond.md", "benchmark.md")
        for name in re.findall(r"<!-- (\w+): generated -->", (docs / page).read_text("utf-8"))
    }
    assert blocks.keys() == begun
    assert blocks["leaderboard"].startswith("Data: simulated rig, not hardware.")
