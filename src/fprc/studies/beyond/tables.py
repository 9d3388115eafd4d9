"""Tables of the families of the target ``beyond``: models, and what changes their errors."""

from collections.abc import Callable, Mapping, Sequence
from typing import Any

import pandas as pd

from fprc.studies.beyond.measurements import LOOPS, MEASURES, measured, model_title
from fprc.tables.models import means_of
from fprc.tables.text import format_mean, three_digits

Families = Sequence[Mapping[str, Any]]


def models(families: Families) -> pd.DataFrame:
    """Mean of each model's measures over the units of each family, tidy.

    Returns
    -------
    DataFrame
        ``world``, ``model``, ``measure``, ``mean``, ``low``, ``high`` (95 % interval over units;
        empty for a single one), ``units``, ``source``.
    """
    table = measured(families)
    return _means(table[table["measure"].isin(list(MEASURES))], "model", "measure")


def models_page(table: pd.DataFrame, *, intervals: bool = False) -> pd.DataFrame:
    """Return the models of one family as a page, one row each."""
    headings = {_heading(measure): measure for measure in MEASURES}
    page = wide(table, ["model"], "measure", headings, intervals=intervals)
    units = table.groupby("model")["units"]
    words = units.agg(lambda counts: " to ".join(map(str, sorted({counts.min(), counts.max()}))))
    page["Units"] = words.reindex(page.index).fillna("-")
    return named(page, Model=model_title)


def leaderboard(table: pd.DataFrame) -> pd.DataFrame:
    """Return the models of one family as a page, the lowest forward test RMSE first."""
    forward = table[table["measure"] == "forward"]
    order = forward.sort_values("mean", kind="stable")["model"].tolist()
    ranked = table[table["model"].isin(order)]
    ranked = ranked.sort_values("model", key=lambda names: names.map(order.index), kind="stable")
    page = models_page(ranked, intervals=True)
    return page[[name for name in page if not name.startswith("Closed loop")]]


def offsets(families: Families) -> pd.DataFrame:
    """Forward test RMSE, and tracking, where P_o is shifted after training, tidy.

    Returns
    -------
    DataFrame
        ``world``, ``model``, ``measure`` (forward, open_loop or closed_loop), ``offset_kpa``,
        ``mean``, ``low``, ``high``, ``units``, ``source``; and the errors of Fuzzy-linear, which
        has no P_o, at no offset.
    """
    table = measured(families)
    parts = table["measure"].str.extract("^([a-z_]*)/?(.*)$")
    table["measure"] = parts[0]
    table["offset_kpa"] = pd.to_numeric(parts[1]).fillna(0.0)
    without = parts[0].isin(["forward", *LOOPS]) & (table["model"] == "fuzzy_linear")
    return _means(table[(parts[1] != "") | without], "model", "measure", "offset_kpa")


def offsets_page(table: pd.DataFrame) -> pd.DataFrame:
    """Return one row per model and measure of one family, one column per offset; means alone."""
    offsets_kpa = sorted(table["offset_kpa"].unique())
    headings = {f"{kpa:+g}" if kpa else "0": kpa for kpa in offsets_kpa}
    places = {measure: place for place, measure in enumerate(MEASURES)}
    rows = table.sort_values("measure", key=lambda names: names.map(places), kind="stable")
    page = wide(rows, ["model", "measure"], "offset_kpa", headings, intervals=False)
    return named(page, Model=model_title, Error=_heading)


def _heading(measure: str) -> str:
    words = MEASURES[measure]
    return words[:1].upper() + words[1:]


def _means(table: pd.DataFrame, *keys: str) -> pd.DataFrame:
    """Return the mean over the units of each family, and its interval, for values of the keys."""
    # simulations of one rig with several seeds are one unit
    by_unit = table.groupby(["world", "unit", *keys], sort=False)["value"].mean().reset_index()
    means = means_of(by_unit, "world", *keys, count="units")
    return means.drop(columns=["std", "min", "max"]).assign(source="sim")


def wide(
    table: pd.DataFrame,
    rows: list[str],
    columns: str | list[str],
    headings: Mapping[str, Any],
    *,
    intervals: bool = True,
) -> pd.DataFrame:
    """Return means as text, a row for each value of ``rows`` and a column for each heading."""
    texts = [
        format_mean(row, "mean") if intervals and row["units"] > 1 else three_digits(row["mean"])
        for row in table.to_dict("records")
    ]
    wide = table.assign(text=texts).pivot(index=rows, columns=columns, values="text")
    wide = wide.reindex(index=table.set_index(rows).index.unique(), columns=list(headings.values()))
    return wide.set_axis(list(headings), axis=1).astype(object).fillna("-")


def named(page: pd.DataFrame, **names: Callable[[Any], str]) -> pd.DataFrame:
    """Return a page whose first columns are the levels of its index, as readers see them."""
    for level, (heading, name) in enumerate(names.items()):
        page.insert(level, heading, [name(key) for key in page.index.get_level_values(level)])
    return page.reset_index(drop=True)
