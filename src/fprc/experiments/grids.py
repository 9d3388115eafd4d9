"""Grids of control variables, Sec. III-E, and the weights of Fig. 9."""

import logging
from collections.abc import Mapping
from typing import Any

import numpy as np
from sklearn.base import clone
from sklearn.model_selection import ParameterGrid

from fprc.errors import EvaluationError
from fprc.evaluation import Prepared, evaluate, prepare
from fprc.experiments.data import Data, models_for
from fprc.experiments.settings import CrossValidation
from fprc.paper import GRID_MODELS, GRID_SETTINGS
from fprc.registry import build

log = logging.getLogger(__name__)


def evaluate_grids(
    data: Mapping[str, Data], values: Mapping[str, Any], validation: CrossValidation,
    folds: int | None = None,
) -> dict[str, list[dict[str, Any]]]:  # fmt: skip
    """Cross-validate and test each cell of each grid, for the models whose inputs are in the data.

    Of the folds the first ``folds``, by default all; one is enough for a mean over seeds.
    """
    train, test = data["sweep"], data["complex"]
    models = models_for(validation.models, train, test)
    rows = validation.split_rows(train)[:folds]

    found: dict[str, list[dict[str, Any]]] = {grid: [] for grid in GRID_MODELS}
    for grid, cells in found.items():
        settings = {setting: values[setting] for setting in GRID_SETTINGS[grid]}
        for name in (name for name in GRID_MODELS[grid] if name in models):
            samples = train.samples(name), test.samples(name)
            for cell in ParameterGrid(settings):
                model = build(name, validation.models, validation.seed, **cell)
                cells.append({"model": name, **cell, **evaluate(model, rows, *samples)})
        log.info("evaluated grid %s: %d cells", grid, len(cells))
    return found


def weight_shares(train: Data, validation: CrossValidation) -> dict[str, Any]:
    """Return the share of each feature in the weights, per rule and on average (Fig. 9).

    The FPRC is cross-validated as usual on features as ``normalised`` returns them, and the weights
    are those of the best fold (Eqs. 13, 14).
    """
    model = build("fprc", validation.models, validation.seed)
    prepared = normalised(prepare(model, {"train": train.samples("fprc")}), "train")
    validated = prepared.cross_validated("train", validation.split_rows(train))
    shares = shares_of(validated.model.readout_.W_out_)
    edges = {"bias": (0, 1), "theta_d": (1, 1 + model.n_y), "p_o": (1 + model.n_y, None)}
    parts = {name: shares[:, slice(*edge)] for name, edge in edges.items()}
    return {
        "mean_share": {name: float(part.sum(axis=1).mean()) for name, part in parts.items()},
        "shares": {name: part.tolist() for name, part in parts.items()},
    }


def normalised(prepared: Prepared, log: str) -> Prepared:
    """Return a prepared FPRC with features of one log scaled to [0, 1] (Eq. 13).

    theta and the filtered P_o are each scaled by their minimum and maximum. The ridge parameter is
    that of features in deg and kPa. It is divided by the product of both ranges, so that it counts
    as much as on them (docs/decisions.md).
    """
    model, rows = prepared.model, prepared.rows[log]
    taps = rows[:, : model.n_y], rows[:, model.n_y :]  # those of one signal share its range
    ranges = [float(np.ptp(of_signal)) for of_signal in taps]
    if 0.0 in ranges:
        raise EvaluationError("FPRC: a signal is constant throughout and cannot be normalised")
    scaled = [(t - t.min()) / width for t, width in zip(taps, ranges, strict=True)]
    weaker = clone(model).set_params(alpha=model.alpha / np.prod(ranges))
    return prepared._replace(model=weaker, rows={log: np.hstack(scaled)})


def shares_of(W_out: np.ndarray) -> np.ndarray:
    """Return the absolute weights as shares of their rule."""
    weights = np.abs(W_out)
    return weights / weights.sum(axis=1, keepdims=True)
