"""Grids of control variables, Sec. III-E, and the weights of Fig. 9."""

import logging
from collections.abc import Mapping, Sequence
from functools import partial
from typing import Any

from fprc.artifacts import read_json, write_json
from fprc.evaluation.cells import judged_cells
from fprc.experiments.data import models_for, read_data
from fprc.experiments.grids import cells_of, chunk_of, judge_cell, weight_shares
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
    chunk: int = 0,
    chunks: int = 1,
    **run: Any,
) -> None:
    """Cross-validate and test every cell of one grid, or of one chunk of it.

    Parameters
    ----------
    judgement : Mapping
        Arguments of ``fprc.experiments.settings.Judgement``.
    chunk, chunks : int
        Number of the chunk, from 0, and of all chunks; ``join_grid`` joins them.
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
        partial(_judge_from_files, train=train, test=test, judgement=Judgement(**judgement)),
        chunk_of(possible, chunk, chunks),
        settings=judgement,
        files=[train, test],
        **run,
    ) as judged:
        write_json(results, {**described, "cells": judged})


def _judge_from_files(
    cell: Mapping[str, Any], *, train: str, test: str, judgement: Judgement
) -> dict[str, Any]:
    # each worker process reads the logs itself: they would be large arguments
    return judge_cell(cell, train=read_data(train), test=read_data(test), judgement=judgement)


def join_grid(chunks: Sequence[str], results: str) -> None:
    """Join the chunks of a grid in order; the file is that of a single job."""
    parts = [read_json(path) for path in chunks]
    write_json(results, parts[0] | {"cells": [cell for part in parts for cell in part["cells"]]})


def weigh(train: str, weights: str, *, judgement: Mapping[str, Any]) -> None:
    """Write the normalised weights of the FPRC, rule by rule."""
    data = read_data(train)
    shares = weight_shares(data, Judgement(**judgement))
    described = {"source": data.attributes["source"], "seed": judgement["seed"]}
    write_json(weights, {**described, **shares})
    log.info("mean shares: P_o {p_o:.3f}, theta_d {theta_d:.3f}".format(**shares["mean_share"]))
