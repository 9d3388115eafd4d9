"""Grids of control variables, Sec. III-E, and the weights of Fig. 9."""

import itertools
import logging
from collections.abc import Mapping, Sequence
from typing import Any

from fprc.evaluation import cross_validate, split_rows
from fprc.evaluation.weights import normalised_weights
from fprc.experiments.data import Data
from fprc.experiments.settings import Judgement
from fprc.paper import GRID_MODELS, GRID_SETTINGS
from fprc.registry import build

log = logging.getLogger(__name__)


def cells_of(grid: str, values: Mapping[str, Sequence[float]]) -> list[dict[str, Any]]:
    """Return the cells of a grid: each is a model and the settings that the grid varies."""
    return [
        {"model": model, **dict(zip(GRID_SETTINGS[grid], cell, strict=True))}
        for model in GRID_MODELS[grid]
        for cell in itertools.product(*(values[name] for name in GRID_SETTINGS[grid]))
    ]


def chunk_of(cells: Sequence[Any], chunk: int, chunks: int) -> list[Any]:
    """Return one of ``chunks`` contiguous parts; their sizes differ by one cell at most."""
    first, last = (len(cells) * edge // chunks for edge in (chunk, chunk + 1))
    return list(cells[first:last])


def judge_cell(
    cell: Mapping[str, Any],
    *,
    train: Data,
    test: Data,
    judgement: Judgement,
) -> dict[str, Any]:
    """Return the errors of one cell."""
    name = cell["model"]
    X, y = train.pair(name)
    changed = {key: value for key, value in cell.items() if key != "model"}
    model = build(name, judgement.models, judgement.seed).set_params(**changed)
    judged = cross_validate(
        model, X, y, split_rows(len(y), judgement.folds, judgement.split, judgement.seed)
    )
    return judged.errors(*test.pair(name))


def judge_grids(
    data: Mapping[str, Data], values: Mapping[str, Any], judgement: Judgement
) -> dict[str, list[dict[str, Any]]]:
    """Judge every cell of every grid; the grid of tap sizes is coarser."""
    coarse = dict(values) | {"n_u": values["replicate_taps"], "n_y": values["replicate_taps"]}
    logs = {"train": data["sweep"], "test": data["complex"]}
    judged = {}
    for grid in ("epsilon", "n_c", "taps"):
        judged[grid] = [
            {**cell, **judge_cell(cell, **logs, judgement=judgement)}
            for cell in cells_of(grid, coarse)
        ]
        log.info("judged grid %s: %d cells", grid, len(judged[grid]))
    return judged


def weight_shares(train: Data, judgement: Judgement) -> dict[str, Any]:
    """Return the share of each feature in the weights, per rule and on average (Fig. 9)."""
    X, y = train.pair("fprc")
    model = build("fprc", judgement.models, judgement.seed)
    folds = split_rows(len(y), judgement.folds, judgement.split, judgement.seed)
    shares = normalised_weights(model, X, y, folds)
    edges = {"bias": (0, 1), "theta_d": (1, 1 + model.n_y), "p_o": (1 + model.n_y, None)}
    parts = {name: shares[:, slice(*edge)] for name, edge in edges.items()}
    return {
        "mean_share": {name: float(part.sum(axis=1).mean()) for name, part in parts.items()},
        "shares": {name: part.tolist() for name, part in parts.items()},
    }
