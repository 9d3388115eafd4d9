"""Numbers and tables as text."""

import re
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import pandas as pd

from fprc import escape
from fprc.artifacts import write_csv, write_json, write_text
from fprc.intervals import half_interval
from fprc.logs.quality import warnings


def means_of(samples: pd.DataFrame, *keys: str, count: str = "seeds") -> pd.DataFrame:
    """Return the mean of ``value`` for each value of the keys, tidy.

    Columns: the keys, ``mean``, ``std``, ``min``, ``max``, the number of samples by the name
    ``count``, and the mean's 95 % interval by Student's t, ``low`` and ``high``.
    """
    groups = samples.groupby(list(keys), sort=False, dropna=False)["value"]
    table = groups.agg(["mean", "std", "min", "max", "count"]).reset_index()
    half = half_interval(table["std"], table["count"])
    table = table.assign(low=table["mean"] - half, high=table["mean"] + half)
    return table.rename(columns={"count": count})


def spread(mean: float, std: float | None) -> str:
    """Format a number to three significant digits, with its standard deviation if it has one."""
    text = three_digits(mean)
    return text if std is None or pd.isna(std) else f"{text} ± {three_digits(std)}"


def format_mean(row: Mapping[str, Any], name: str) -> str:
    """Format a mean with its interval if it has one, else with its standard deviation."""
    if pd.notna(row.get("low")):  # a single value has none
        return within(row[name], row["low"], row["high"])
    return spread(row[name], row.get("std"))


def within(mean: float, low: float, high: float) -> str:
    """Format a number to three significant digits, with its interval or range."""
    return "{} ({} to {})".format(*map(three_digits, (mean, low, high)))


def three_digits(value: float) -> str:
    """Format a number to three significant digits; a missing one gives an empty text."""
    if isinstance(value, str) or pd.isna(value):
        return ""
    exponent = int(f"{value:.2e}".split("e")[1])  # of the rounded number: 9.999 is 10.0
    decimals = max(2 - exponent, 0) if value else 0
    return f"{value:.{decimals}f}"


def markdown(page: pd.DataFrame, note: str) -> str:
    """Render a page as a Markdown table under a note."""
    page = page.map(lambda cell: escape.markdown(cell) if isinstance(cell, str) else cell)
    page = page.rename(columns=escape.markdown)
    return f"{note}\n\n{page.to_markdown(index=False, disable_numparse=True)}\n"


def latex(page: pd.DataFrame, title: str, label: str) -> str:
    """Render a page as a LaTeX table with the rules of booktabs and the paper's symbols.

    Its caption is the title without the paper's number, since LaTeX counts tables itself.
    """
    caption = re.sub(r"^Table [IVX]+[.,] ", "", title)
    caption = re.sub(r"([&%$#_{}])", r"\\\1", caption[:1].upper() + caption[1:])
    text = page.to_latex(index=False, escape=True, caption=caption, label=f"tab:{label}")
    text = text.replace(r"\begin{table}", "\\begin{table}\n\\centering")
    return escape.typeset(text, tex=True)


def failed(records: Sequence[Mapping[str, Any]]) -> str:
    """Return the lines of a note on the failed checks of quality records."""
    return "".join(f"\nFailed check: {line}." for record in records for line in warnings(record))


def write_table(
    table: pd.DataFrame, page: pd.DataFrame, note: str, *files: str, title: str = ""
) -> None:
    """Write a table's tidy numbers as CSV, and its page, what readers see, with title and note.

    The ``files`` of a page are Markdown, and perhaps LaTeX and, for the report, JSON.
    """
    csv, md, *more = files
    write_csv(csv, table)
    write_text(md, markdown(page, f"{title}: {note}" if title else note))
    if more:
        tex, json = more
        write_text(tex, latex(page, title, Path(tex).stem))
        write_json(json, {"title": title, "note": note, **page.to_dict("split", index=False)})
