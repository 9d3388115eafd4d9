"""Numbers and tables as text."""

import re
from collections.abc import Mapping
from typing import Any

import pandas as pd

from fprc import escape
from fprc.artifacts import write_csv, write_text


def spread(mean: float, std: float | None) -> str:
    """Format a number to three significant digits, with its standard deviation if it has one."""
    text = three_digits(mean)
    return text if std is None or pd.isna(std) else f"{text} ± {three_digits(std)}"


def format_mean(row: Mapping[str, Any], name: str) -> str:
    """Format a mean with its interval if it has one, else with its standard deviation."""
    if "low" in row:
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


def read_markdown(text: str) -> tuple[str, pd.DataFrame]:
    """Return note and page of a text that ``markdown`` rendered; every cell is text."""
    note, _, grid = text.partition("\n\n")
    columns, _, *rows = [
        [escape.unmarkdown(cell.strip()) for cell in re.split(r"(?<!\\)\|", line.strip())[1:-1]]
        for line in grid.strip().splitlines()
    ]
    return " ".join(note.split()), pd.DataFrame(rows, columns=columns)


def write_table(table: pd.DataFrame, page: pd.DataFrame, note: str, csv: str, md: str) -> None:
    """Write a table as CSV, and its page under a note as Markdown."""
    write_csv(csv, table)
    write_text(md, markdown(page, note))
