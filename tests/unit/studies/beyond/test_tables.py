"""Tables of families whose numbers are known."""

import numpy as np
import pandas as pd
import pytest
from scipy.stats import t

from fprc.studies.beyond import tables as tables
from fprc.studies.beyond import verdicts as pages_of_verdicts
from fprc.tables.text import markdown


def rows_of(table, family):
    return table[table["world"] == family]


def means(family, measure, name):
    rows = [(cell["unit"], cell["models"][name][measure]) for cell in family["cells"]]
    return pd.DataFrame(rows).groupby(0)[1].mean().to_numpy()


def test_means_and_intervals_are_over_units(families):
    table = tables.models(families).set_index(["world", "model", "measure"])
    row, values = table.loc[("drawn", "esn", "reversed")], means(families[1], "reversed", "esn")
    half = t.ppf(0.975, 8) * values.std(ddof=1) / 3.0
    assert row["units"] == 9
    assert [row["mean"], row["low"], row["high"]] == pytest.approx(
        [values.mean(), values.mean() - half, values.mean() + half]
    )


def test_no_number_is_missing_where_there_are_two_units(families):
    for make in (tables.models, tables.offsets):
        table = make(families)
        assert list(make(families[3:])) == list(table)  # of a family with nothing
        several = table[table["units"] > 1]
        assert not several.isna().any().any()
        assert np.isfinite(table["mean"]).all()
        assert not table.duplicated([c for c in table if c not in ("mean", "low", "high")]).any()


def test_pages_survive_a_family_with_nothing(families, verdicts):
    pages = [
        tables.leaderboard(rows_of(tables.models(families), "broken")),
        *(
            page(rows_of(make(families), "broken"))
            for page, make in (
                (tables.models_page, tables.models),
                (tables.offsets_page, tables.offsets),
            )
        ),
        *(
            page(few)
            for few in (verdicts, rows_of(verdicts, "broken"))
            for page in (
                pages_of_verdicts.claims_page,
                pages_of_verdicts.fitted_page,
                pages_of_verdicts.details_page,
            )
        ),
    ]
    for page in pages:
        assert markdown(page, "Note.").count("\n|") == len(page) + 2
        assert "nan" not in page.to_string().lower().split()


def test_leaderboard_begins_with_the_lowest_error(families):
    models = tables.models(families)
    page = tables.leaderboard(rows_of(models, "dry"))
    errors = [float(text.split()[0]) for text in page["Forward test [kPa]"]]
    assert errors == sorted(errors)
    best = models.set_index(["world", "model", "measure"]).loc[("dry", "fprc", "forward")]
    assert page["Model"].iloc[0] == "FPRC"
    assert errors[0] == pytest.approx(best["mean"], rel=5e-3)
    assert not any("Closed" in column for column in page)
    assert {"Reversed test [kPa]", "Open loop [deg]"} < set(page)


def test_offsets_have_their_columns(families):
    table = tables.offsets(families)
    assert set(table["offset_kpa"]) == {-5.0, -2.0, -1.0, 0.0, 1.0, 2.0, 5.0}
    page = tables.offsets_page(rows_of(table, "dry")).set_index(["Model", "Error"])
    assert list(page) == ["-5", "-2", "-1", "0", "+1", "+2", "+5"]
    own = table[(table["world"] == "dry") & (table["offset_kpa"] == -2.0)]
    of_error = {"Forward test [kPa]": "forward", "Open loop [deg]": "open_loop",
                "Closed loop [deg]": "closed_loop"}  # fmt: skip
    for measure, key in of_error.items():
        assert page.loc[("Fuzzy-linear", measure)].ne("-").sum() == 1
        low = own[(own["model"] == "fprc") & (own["measure"] == key)]["mean"]
        shown = float(page.loc[("FPRC", measure), "-2"])
        assert shown == pytest.approx(low.item(), rel=5e-3)
    assert page.loc[("FPRC", "Forward test [kPa]")].ne("-").all()
