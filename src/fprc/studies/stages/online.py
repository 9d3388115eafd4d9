"""Tables and figure of the models that learn while they run."""

from collections.abc import Mapping, Sequence
from typing import Any

import pandas as pd

from fprc.artifacts import read_json
from fprc.figures import style
from fprc.paper import SOURCES
from fprc.studies.beyond.measurements import family_of, family_title
from fprc.studies.online import show
from fprc.tables.text import write_table


def tabulate_online(families: Sequence[str], *, table: str, **files: str) -> None:
    """Write one of the tables: ``verdicts`` on D1 to D4, ``errors`` under every condition."""
    tidy, page, note = show.TABLES[table]([family_of(read_json(path)) for path in families])
    write_table(tidy, page, f"{note}\nData: {SOURCES['sim']}.", **files)


def draw_online(errors: str, pdf: str, png: str, *, names: Sequence[str]) -> Mapping[str, Any]:
    """Draw the tracking error over the offset of P_o, with and without learning."""
    table = pd.read_csv(errors)
    fig, axes = style.figure(2, len(names), style.PAGE_IN, 3.6, sharex=True)
    for column, name in enumerate(names):
        for row, loop in enumerate(show.LOOPS):
            ax = axes[row][column]
            show.plot_offsets(table[(table["family"] == name) & (table["loop"] == loop)], ax)
            ax.set_title(f"{family_title(name)}, {show.LOOPS[loop]}", fontsize=7)
            # the scales of the panels differ, so every panel shows its numbers
            ax.set(xlabel=ax.get_xlabel() if row else "", ylabel="" if column else ax.get_ylabel())
    style.share_legend(fig, axes[0][0])
    return style.save(fig, {"source": "sim", "seeds": []}, pdf, png)
