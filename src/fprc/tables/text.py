"""Numbers and tables as text."""

import re
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import pandas as pd

from fprc import escape
from fprc.artifacts import write_csv, write_json, write_text


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


def latex(page: pd.DataFrame, title: str, label: str) -> str:
    """Render a page as a LaTeX table with the rules of booktabs.

    Its caption is the title without the paper's number, since LaTeX counts tables itself.
    """
    caption = re.sub(r"^Table [IVX]+[.,] ", "", title)
    text = page.to_latex(
        index=False,
        escape=True,
        caption=_tex(caption[:1].upper() + caption[1:]),
        label=f"tab:{label}",
    )
    return _symbols(text.replace(r"\begin{table}", "\\begin{table}\n\\centering"))


def _tex(text: str) -> str:
    return re.sub(r"([&%$#_{}])", r"\\\1", text)


def _symbols(text: str) -> str:
    """Return LaTeX with the paper's symbols in formulas, as theta_d, P_o and n_c."""

    def typeset(found: re.Match[str]) -> str:
        name, index = found.groups()
        letter = r"\theta" if name == "theta" else name
        return rf"${letter}_\mathrm{{{index}}}$"

    return re.sub(r"\b(theta|P|n)\\_([a-z]+)", typeset, text)


def write_table(
    table: pd.DataFrame,
    page: pd.DataFrame,
    note: str,
    csv: str,
    md: str,
    tex: str = "",
    json: str = "",
    *,
    title: str = "",
) -> None:
    """Write a table as CSV, and its page with title and note.

    Parameters
    ----------
    table : DataFrame
        Tidy numbers.
    page : DataFrame
        What readers see: texts.
    md, tex, json : str
        Files of the page in Markdown, in LaTeX and, for the report, in JSON.
    """
    write_csv(csv, table)
    write_text(md, markdown(page, f"{title}: {note}" if title else note))
    if tex:
        write_text(tex, latex(page, title, Path(tex).stem))
    if json:
        write_json(json, {"title": title, "note": note, **page.to_dict("split", index=False)})
