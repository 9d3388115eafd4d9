"""Grids of control variables, Sec. III-E, and the weights of Fig. 9."""

import logging
from collections.abc import Mapping, Sequence
from functools import partial
from typing import Any

from fprc.artifacts import write_json
from fprc.evaluation.cells import judged_cells
from fprc.experiments.data import judge_files, models_for, read_data
from fprc.experiments.grids import cells_of, judge_cell, weight_shares
from fprc.experiments.settings import Judgement

log = logging.getLogger(__name__)


def judge_grid(
    train: str,
    test: str,
    results: str,
    *,
    grid: str,
    values: Mapping[str, Sequence[float]],
    judgement: Mapping[str, Any],
    **run: Any,
) -> None:
    """Cross-validate and test every cell of one grid.

    Parameters
    ----------
    judgement : Mapping
        Arguments of ``fprc.experiments.settings.Judgement``.
    **run
        ``workers``, ``checkpoint`` and ``version`` of ``judged_cells``.
    """
    data = read_data(train)
    models = models_for(judgement["models"], data, read_data(test))
    possible = [cell for cell in cells_of(grid, values) if cell["model"] in models]
    described = {
        "grid": grid,
        "source": data.attributes["source"],
        "seed": judgement["seed"],
        "unit": data.unit,
    }
    with judged_cells(
        partial(
            judge_files, judge=judge_cell, train=train, test=test, judgement=Judgement(**judgement)
        ),
        possible,
        settings=judgement,
        files=[train, test],
        **run,
    ) as judged:
        write_json(results, {**described, "cells": judged})


def weigh(train: str, weights: str, *, judgement: Mapping[str, Any]) -> None:
    """Write the normalised weights of the FPRC, rule by rule."""
    data = read_data(train)
    shares = weight_shares(data, Judgement(**judgement))
    described = {"source": data.attributes["source"], "seed": judgement["seed"]}
    write_json(weights, {**described, **shares})
    log.info("mean shares: P_o {p_o:.3f}, theta_d {theta_d:.3f}".format(**shares["mean_share"]))
