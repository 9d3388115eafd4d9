"""Grids of control variables, Sec. III-E, and the weights of Fig. 9."""

import itertools
import logging
from collections.abc import Mapping, Sequence
from functools import cache
from typing import Any

import numpy as np

from fprc.evaluation import cross_validate, rmse
from fprc.evaluation.crossval import fit_folds, refusals_of
from fprc.evaluation.weights import normalised_weights
from fprc.experiments.data import Data
from fprc.experiments.settings import Judgement
from fprc.models import SequenceModel, TapFeatures
from fprc.models.recordings import transform_each
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
    cell: Mapping[str, Any], *, train: Data, test: Data, judgement: Judgement
) -> dict[str, Any]:
    """Return the errors of one cell."""
    X, y = train.pair(cell["model"])
    folds = judgement.split_rows(train)
    judged = cross_validate(_model_of(cell, judgement), X, y, folds, lengths=train.lengths)
    return judged.errors(*test.pair(cell["model"]), test.lengths)


def _model_of(cell: Mapping[str, Any], judgement: Judgement) -> SequenceModel:
    changed = {key: value for key, value in cell.items() if key != "model"}
    return build(cell["model"], judgement.models, judgement.seed).set_params(**changed)


def judge_grids(
    data: Mapping[str, Data], values: Mapping[str, Any], judgement: Judgement
) -> dict[str, list[dict[str, Any]]]:
    """Judge every cell of every grid on the first fold; the features are shared by the cells.

    The errors are those of ``judge_cell`` with one fold: enough for a mean over seeds.
    """
    logs = data["sweep"], data["complex"]
    y, expected = (each.channels["p_target_kpa"] for each in logs)
    folds = judgement.split_rows(logs[0])[:1]
    fprc = build("fprc", judgement.models, judgement.seed)
    n_y, n_u = max(fprc.n_y, *values["n_y"]), max(fprc.n_u, *values["n_u"])

    @cache
    def widest(epsilon: float) -> list[np.ndarray]:
        """Return the taps of both logs at the largest sizes, from which each cell takes its own."""
        features = TapFeatures(n_y=n_y, n_u=n_u, epsilon=epsilon).fit(logs[0].pair("fprc")[0])
        return [transform_each(features, each.pair("fprc")[0], each.lengths) for each in logs]

    def rows(model: SequenceModel) -> list[np.ndarray]:
        if not hasattr(model, "epsilon"):
            return [taps[:, : model.n_y] for taps in widest(1.0)]
        return [
            np.hstack([taps[:, : model.n_y], taps[:, n_y : n_y + model.n_u]])
            for taps in widest(model.epsilon)
        ]

    def judge(cell: Mapping[str, Any]) -> dict[str, Any]:
        model = _model_of(cell, judgement)
        trained, tested = rows(model)
        with refusals_of(model):
            folded = fit_folds(model.make_readout(), trained, y, folds)
        return {
            **cell,
            "train_rmse_kpa": folded.train_rmse,
            "validation_rmse_kpa": folded.validation_rmse,
            "test_rmse_kpa": rmse(expected, folded.readout.predict(tested)),
        }

    judged = {}
    for grid in ("epsilon", "n_c", "taps"):
        judged[grid] = [judge(cell) for cell in cells_of(grid, values)]
        log.info("judged grid %s: %d cells", grid, len(judged[grid]))
    return judged


def weight_shares(train: Data, judgement: Judgement) -> dict[str, Any]:
    """Return the share of each feature in the weights, per rule and on average (Fig. 9)."""
    X, y = train.pair("fprc")
    model = build("fprc", judgement.models, judgement.seed)
    folds = judgement.split_rows(train)
    shares = normalised_weights(model, X, y, folds, train.lengths)
    edges = {"bias": (0, 1), "theta_d": (1, 1 + model.n_y), "p_o": (1 + model.n_y, None)}
    parts = {name: shares[:, slice(*edge)] for name, edge in edges.items()}
    return {
        "mean_share": {name: float(part.sum(axis=1).mean()) for name, part in parts.items()},
        "shares": {name: part.tolist() for name, part in parts.items()},
    }
