"""Grids of control variables, Sec. III-E, and the weights of Fig. 9."""

import itertools
import logging
from collections.abc import Mapping, Sequence
from typing import Any

from fprc.evaluation import evaluate
from fprc.evaluation.folds import Fold
from fprc.evaluation.weights import normalised_weights
from fprc.experiments.data import Data, models_for
from fprc.experiments.settings import Judgement
from fprc.paper import GRID_MODELS, GRID_SETTINGS
from fprc.registry import build

log = logging.getLogger(__name__)


def cells_of(grid: str, values: Mapping[str, Sequence[float]]) -> list[dict[str, Any]]:
    """Return the cells of a grid: a model, and the settings that the grid varies."""
    return [
        {"model": model, **dict(zip(GRID_SETTINGS[grid], cell, strict=True))}
        for model in GRID_MODELS[grid]
        for cell in itertools.product(*(values[name] for name in GRID_SETTINGS[grid]))
    ]


def judge_cell(
    cell: Mapping[str, Any],
    *,
    train: Data,
    test: Data,
    judgement: Judgement,
    folds: Sequence[Fold] | None = None,
) -> dict[str, Any]:
    """Return the errors of one cell.

    Parameters
    ----------
    folds : sequence of (training rows, validation rows), optional
        By default all of ``judgement``.
    """
    name = cell["model"]
    changed = {key: value for key, value in cell.items() if key != "model"}
    model = build(name, judgement.models, judgement.seed, **changed)
    rows = judgement.split_rows(train) if folds is None else folds
    return evaluate(model, rows, train.samples(name), test.samples(name))


def judge_grids(
    data: Mapping[str, Data],
    values: Mapping[str, Any],
    judgement: Judgement,
    *,
    folds: int | None = None,
) -> dict[str, list[dict[str, Any]]]:
    """Judge every cell of every grid, for the models whose inputs are in the data.

    Parameters
    ----------
    folds : int, optional
        Number of folds, the first ones; by default all. One is enough for a mean over seeds.
    """
    train, test = data["sweep"], data["complex"]
    models = models_for(judgement.models, train, test)
    rows = judgement.split_rows(train)[:folds]
    how: dict[str, Any] = {"train": train, "test": test, "judgement": judgement, "folds": rows}
    judged = {}
    for grid in GRID_MODELS:
        cells = [cell for cell in cells_of(grid, values) if cell["model"] in models]
        judged[grid] = [{**cell, **judge_cell(cell, **how)} for cell in cells]
        log.info("judged grid %s: %d cells", grid, len(cells))
    return judged


def weight_shares(train: Data, judgement: Judgement) -> dict[str, Any]:
    """Return the share of each feature in the weights, per rule and on average (Fig. 9)."""
    model = build("fprc", judgement.models, judgement.seed)
    shares = normalised_weights(model, train.samples("fprc"), judgement.split_rows(train))
    edges = {"bias": (0, 1), "theta_d": (1, 1 + model.n_y), "p_o": (1 + model.n_y, None)}
    parts = {name: shares[:, slice(*edge)] for name, edge in edges.items()}
    return {
        "mean_share": {name: float(part.sum(axis=1).mean()) for name, part in parts.items()},
        "shares": {name: part.tolist() for name, part in parts.items()},
    }
