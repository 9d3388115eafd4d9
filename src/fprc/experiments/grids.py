"""Grids of control variables, Sec. III-E, and the weights of Fig. 9."""

import itertools
import logging
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from fprc.evaluation import cross_validate, rmse
from fprc.evaluation.crossval import fit_folds, refusals_of
from fprc.evaluation.folds import Fold
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
    folds = judgement.split_rows(train)
    judged = cross_validate(model, X, y, folds, lengths=train.lengths)
    return judged.errors(*test.pair(name), test.lengths)


def judge_grids(
    data: Mapping[str, Data], values: Mapping[str, Any], judgement: Judgement
) -> dict[str, list[dict[str, Any]]]:
    """Judge every cell of every grid on the first fold; the features are shared by the cells.

    The errors are those of ``judge_cell`` with one fold: enough for a mean over seeds.
    """
    train, test = data["sweep"], data["complex"]
    folds = judgement.split_rows(train)
    features = _Features((train, test), judgement, values)
    judged = {}
    for grid in ("epsilon", "n_c", "taps"):
        judged[grid] = [
            {**cell, **_judge_first_fold(cell, features, folds[:1])}
            for cell in cells_of(grid, values)
        ]
        log.info("judged grid %s: %d cells", grid, len(judged[grid]))
    return judged


class _Features:
    """Taps of both logs at the largest sizes, from which each cell takes its own."""

    def __init__(self, logs: Sequence[Data], judgement: Judgement, values: Mapping[str, Any]):
        self.logs, self.judgement = logs, judgement
        fprc = build("fprc", judgement.models, judgement.seed)
        self.n_y, self.n_u = max(fprc.n_y, *values["n_y"]), max(fprc.n_u, *values["n_u"])
        self._widest: dict[float, list[np.ndarray]] = {}

    def model(self, cell: Mapping[str, Any]) -> SequenceModel:
        """Return the unfitted model of a cell."""
        changed = {key: value for key, value in cell.items() if key != "model"}
        return build(cell["model"], self.judgement.models, self.judgement.seed).set_params(
            **changed
        )

    def rows(self, model: SequenceModel) -> list[np.ndarray]:
        """Return the features of both logs."""
        if not hasattr(model, "epsilon"):
            return [widest[:, : model.n_y] for widest in self._taps(1.0)]
        return [
            np.hstack([widest[:, : model.n_y], widest[:, self.n_y : self.n_y + model.n_u]])
            for widest in self._taps(model.epsilon)
        ]

    def _taps(self, epsilon: float) -> list[np.ndarray]:
        if epsilon not in self._widest:
            widest = TapFeatures(n_y=self.n_y, n_u=self.n_u, epsilon=epsilon)
            widest.fit(self.logs[0].pair("fprc")[0])
            self._widest[epsilon] = [
                transform_each(widest, log.pair("fprc")[0], log.lengths) for log in self.logs
            ]
        return self._widest[epsilon]


def _judge_first_fold(
    cell: Mapping[str, Any], features: _Features, folds: Sequence[Fold]
) -> dict[str, Any]:
    model = features.model(cell)
    trained, tested = features.rows(model)
    y, expected = (log.channels["p_target_kpa"] for log in features.logs)
    with refusals_of(model):
        folded = fit_folds(model.make_readout(), trained, y, folds)
    return {
        "train_rmse_kpa": folded.train_rmse,
        "validation_rmse_kpa": folded.validation_rmse,
        "test_rmse_kpa": rmse(expected, folded.readout.predict(tested)),
    }


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
