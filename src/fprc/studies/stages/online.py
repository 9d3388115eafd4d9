"""Judge a model that learns while it runs, and show what it is worth."""

from collections.abc import Mapping, Sequence
from functools import partial
from typing import Any

import pandas as pd

from fprc.artifacts import read_json, write_json
from fprc.evaluation.cells import judged_cells
from fprc.figures import style
from fprc.paper import SOURCES
from fprc.studies.beyond.worlds import world_title
from fprc.studies.online import show
from fprc.studies.online.judge import judge_online
from fprc.tables.text import write_table


def judge_family(
    near_print: str,
    judged: str,
    *,
    family: Mapping[str, Any],
    units: Sequence[int],
    tracking: Mapping[str, Any],
    models: Mapping[str, Any],
    **run: Any,
) -> None:
    """Follow the references on the rigs of a family, under every condition.

    Parameters
    ----------
    near_print : str
        File of the rigs near print.
    family : Mapping
        See ``fprc.studies.families.family.rigs_of``.
    **run
        ``workers``, ``checkpoint`` and ``version`` of ``judged_cells``.
    """
    how: dict[str, Any] = {"family": family, "tracking": tracking, "models": models}
    with judged_cells(
        partial(judge_online, near_print=near_print, **how),
        [{"unit": unit} for unit in units],
        settings=how,
        files=[near_print],
        **run,
    ) as cells:
        write_json(judged, {"source": "sim", "name": family["name"], "cells": cells})


def tabulate_online(families: Sequence[str], *, table: str, **files: str) -> None:
    """Write one of the tables: ``verdicts`` on D1 to D4, ``errors`` under every condition."""
    tidy, page, note = show.TABLES[table]([read_json(path) for path in families])
    write_table(tidy, page, f"{note}\nData: {SOURCES['sim']}.", **files)


def draw_online(errors: str, pdf: str, png: str, *, names: Sequence[str]) -> Mapping[str, Any]:
    """Draw the tracking error over the offset of P_o, with and without learning."""
    table = pd.read_csv(errors)
    fig, axes = style.figure(2, len(names), style.PAGE_IN, 3.6, sharex=True)
    for column, name in enumerate(names):
        for row, loop in enumerate(show.LOOPS):
            ax = axes[row][column]
            show.plot_offsets(table[(table["family"] == name) & (table["loop"] == loop)], ax)
            ax.set_title(f"{world_title(name)}, {show.LOOPS[loop]}", fontsize=7)
            # each panel has its own scale, and therefore its own numbers
            ax.set(xlabel=ax.get_xlabel() if row else "", ylabel="" if column else ax.get_ylabel())
    style.share_legend(fig, axes[0][0])
    return style.save(fig, {"source": "sim", "seeds": []}, pdf, png)
