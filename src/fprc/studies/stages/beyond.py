"""Tables, pages and the figure of the comparison beyond the paper."""

from collections.abc import Sequence
from pathlib import Path

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.ticker import FuncFormatter, NullLocator

from fprc import escape
from fprc.artifacts import read_json, write_csv, write_text
from fprc.evaluation.paired import EQUIVALENT_WITHIN
from fprc.figures import style
from fprc.paper import SOURCES
from fprc.studies.beyond import tables as tables
from fprc.studies.beyond.claims import CLAIMS, best_page, memory_page, numbers_of, worth_page
from fprc.studies.beyond.measurements import family_title
from fprc.studies.beyond.verdicts import claims_page, details_page, fitted_page, judge_family
from fprc.tables.text import markdown, three_digits

#: Columns of the table of the claims.
_CLAIMS = [
    "world", "title", "id", "claim", "part", "mean", "low", "high", "verdict", "p",
    "stable", "units", "dropped", "favours", "fitted", "source",
]  # fmt: skip

#: Marker and colour of each family, in their order, safe for colour-blind readers (Tol). Colours
#: are signals elsewhere, but no figure of families shows one.
_FAMILIES = (
    ("o", "#000000"), ("s", "#ee6677"), ("D", "#4477aa"),
    ("^", "#228833"), ("v", "#aa3377"), ("P", "#ccbb44"),
)  # fmt: skip
#: A ratio beyond this, or beyond one over it, is not shown.
_WIDEST = 5.0
_UNDECIDED = ("undecided", "not judged")


def tabulate_beyond(
    families: Sequence[str],
    pages: Sequence[str],
    *,
    family: str,
    **csv: str,
) -> None:
    """Judge the claims in every family, and write the tables.

    Parameters
    ----------
    families : sequence of str
        Reports of the families.
    pages : sequence of str
        Tables in Markdown, which docs/beyond.md and others show; their names are those below.
    family : str
        Family whose models and offsets the pages show.
    **csv : str
        Tables by name: ``models``, ``claims``, ``offsets``.
    """
    found = [read_json(path) for path in families]
    judged = [judge_family(family, CLAIMS, numbers_of(family)) for family in found]
    verdicts = pd.concat(judged, ignore_index=True)
    models, offsets = tables.models(found), tables.offsets(found)
    made = {"models": models, "claims": verdicts[_CLAIMS], "offsets": offsets}
    for name, table in made.items():
        write_csv(csv[name], table)
    models, offsets = (table[table["world"] == family] for table in (models, offsets))
    shown = {
        "claims": claims_page(verdicts),
        "best": best_page(found),
        "memory": memory_page(found),
        "fitted": fitted_page(verdicts),
        "details": details_page(verdicts),
        "worth": worth_page(verdicts),
        "models": tables.models_page(models),
        "offsets": tables.offsets_page(offsets),
        "leaderboard": tables.leaderboard(models),
    }
    note = f"Data: {SOURCES['sim']}."
    half = float((offsets["high"] - offsets["low"]).max() / 2.0)
    widest = f"; the widest 95 % interval is ± {three_digits(half)} kPa or deg" if half > 0 else ""
    notes = {"offsets": f"{note} Means{widest}."}
    for path in pages:
        name = Path(path).stem
        write_text(path, markdown(shown[name], notes.get(name, note)))


def draw_pairs(claims: str, pdf: str, png: str) -> None:
    """Draw the ratios of the claims in every family."""
    fig, ax = style.figure(1, 1, style.PAGE_IN, 6.8)
    plot_pairs(pd.read_csv(claims), ax)
    style.share_legend(fig, ax)
    style.save(fig, {"source": "sim", "seeds": []}, pdf, png)


def plot_pairs(table: pd.DataFrame, ax: Axes) -> None:
    """Draw the ratios of the claims, one row per pair and one marker per family.

    The band holds what counts as equivalent. A hollow marker is a claim that is undecided.

    Parameters
    ----------
    table : pd.DataFrame
        From ``verdicts.judge_family``, families in their order.
    """
    table = table.dropna(subset="part")
    parts = dict.fromkeys(zip(table["id"], table["part"], strict=True))
    rows = {pair: row for row, pair in enumerate(parts)}
    names = table["world"].unique()
    shifts = dict(zip(names, np.linspace(-0.4, 0.4, len(names) + 2)[1:-1], strict=True))
    ax.axvspan(1 / EQUIVALENT_WITHIN, EQUIVALENT_WITHIN, color="0.92", linewidth=0)
    ax.axvline(1.0, color="0.6", linewidth=0.6)
    for name, (marker, colour) in zip(names, _FAMILIES, strict=False):
        ax.plot([], [], marker, color=colour, markersize=4, label=escape.figure(family_title(name)))
        for row in table[table["world"] == name].itertuples():
            face = "white" if row.verdict in _UNDECIDED else colour
            arms = [[row.mean - row.low], [row.high - row.mean]]
            at = rows[row.id, row.part] + shifts[name]
            ax.errorbar(row.mean, at, xerr=arms, fmt=marker, color=colour, markersize=4,
                        linewidth=0.8, markerfacecolor=face)  # fmt: skip
    ax.plot([], [], "o", color="0", markersize=4, markerfacecolor="white", label="undecided")
    ax.set_xscale("log")
    _decimal_ticks(ax, table["low"].min(), table["high"].max())
    # what is measured is on a second line
    pairs = [style.symbols(part).replace(" (", "\n", 1).removesuffix(")") for _, part in rows]
    ax.set_yticks(range(len(rows)), pairs)
    ax.set_ylim(max(len(rows), 1) - 0.5, -0.5)
    ax.tick_params(axis="y", length=0)
    for row in range(1, len(rows)):
        ax.axhline(row - 0.5, color="0.85", linewidth=0.5)
    ax.set_xlabel("Ratio of the errors; below 1 supports the claim")


def _decimal_ticks(ax: Axes, low: float, high: float) -> None:
    """Set ticks of a logarithmic axis that read as ratios."""
    ticks = np.array(
        [0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9, 1, 1.1, 1.2, 1.5, 2, 2.5, 3, 4, 5, 10]
    )
    low = np.nanmin([low, 1 / EQUIVALENT_WITHIN]) / 1.03
    high = np.nanmax([high, EQUIVALENT_WITHIN]) * 1.03
    low, high = max(low, 1 / _WIDEST), min(high, _WIDEST)  # three units can have any interval
    ax.set_xlim(low, high)
    inside = ticks[(ticks >= low) & (ticks <= high)]
    kept = [1.0]
    for tick in sorted(inside, key=lambda tick: abs(np.log(tick))):
        if min(abs(np.log(tick / other)) for other in kept) > 0.06 * np.log(high / low):
            kept.append(tick)
    ax.set_xticks(sorted(kept))
    ax.xaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
    ax.xaxis.set_minor_locator(NullLocator())
