"""Tables, figures and page of the comparison beyond the paper."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import pandas as pd
from matplotlib.axes import Axes

from fprc.artifacts import read_json, write_csv, write_text
from fprc.figures import style
from fprc.studies.beyond import figures as figures
from fprc.studies.beyond import tables as tables
from fprc.studies.beyond.claims import B8, CLAIMS, numbers_of
from fprc.studies.beyond.measurements import LOOPS
from fprc.studies.beyond.verdicts import judge_family

#: Columns of the table of the claims.
_CLAIMS = [
    "world", "title", "id", "claim", "part", "mean", "low", "high", "verdict", "p",
    "stable", "units", "dropped", "favours", "fitted", "source",
]  # fmt: skip


def tabulate_beyond(
    families: Sequence[str],
    pages: Sequence[str],
    *,
    family: str,
    **csv: str,
) -> None:
    """Judge B1-B7 in every family, and write the tables.

    Parameters
    ----------
    families : sequence of str
        Reports of the families.
    pages : sequence of str
        Tables in Markdown, named after ``tables.pages``.
    family : str
        Family whose models and offsets the pages show.
    **csv : str
        Tables by name: ``models``, ``claims``, ``offsets``.
    """
    found = [read_json(path) for path in families]
    judged = [judge_family(family, CLAIMS, numbers_of(family), B8) for family in found]
    verdicts = pd.concat(judged, ignore_index=True)
    made = {
        "models": tables.models(found),
        "claims": verdicts[_CLAIMS],
        "offsets": tables.offsets(found),
    }
    for name, table in made.items():
        write_csv(csv[name], table)
    texts = tables.pages(found, verdicts, made, family)
    for path in pages:
        write_text(path, texts[Path(path).stem])


def draw_beyond(table: str, pdf: str, png: str, *, figure: str, family: str) -> Mapping[str, Any]:
    """Draw one of the figures.

    Parameters
    ----------
    figure : str
        ``pairs``, of every family, from the table of the claims; or ``offsets``, from the table of
        that name.
    family : str
        Family that the offsets are of.
    """
    *grid, shared, plot = _FIGURES[figure]
    fig, axes = style.figure(*grid, **shared)
    found = pd.read_csv(table)
    plot(found if figure == "pairs" else found[found["world"] == family], axes)
    style.share_legend(fig, fig.axes[0])
    return style.save(fig, {"source": "sim", "seeds": []}, pdf, png)


def _plot_offsets(table: pd.DataFrame, axes: Sequence[Axes]) -> None:
    """Draw the forward test error and the tracking errors over the offset of P_o."""
    for ax, measure in zip(axes, ("forward", *LOOPS), strict=True):
        figures.plot_offsets(table, measure, ax)


#: Rows and columns of axes, width and height in inches, axes that are shared, and what draws.
_FIGURES: dict[str, tuple[Any, ...]] = {
    "pairs": (1, 1, style.PAGE_IN, 4.6, {}, figures.plot_pairs),
    "offsets": (1, 3, style.PAGE_IN, 2.6, {"sharex": True}, _plot_offsets),
}
