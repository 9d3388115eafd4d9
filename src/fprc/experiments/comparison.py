"""Models on logs: Tables II and III, the grids of Figs. 10 and 11, and the weights of Fig. 9."""

from collections.abc import Mapping
from typing import Any, Literal

import numpy as np
from sklearn.base import clone
from sklearn.model_selection import ParameterGrid

from fprc.config.section import Section
from fprc.errors import EvaluationError
from fprc.evaluation import CrossValidated, Prepared, evaluate, prepare, rmse, split_rows
from fprc.evaluation.folds import Fold
from fprc.experiments.data import Data, models_for, refuse_mixture, trained_on
from fprc.models import SequenceModel
from fprc.paper import DIRECTIONS, EXPERIMENTS, GRID_MODELS, GRID_SETTINGS
from fprc.registry import build, entries


class CrossValidation(Section):
    """How models are cross-validated (Sec. III-D)."""

    models: dict[str, Any]  #: section ``models`` of the configuration, or the part that is read
    folds: int  #: number of folds of the cross-validation
    split: Literal["shuffled", "blocked"]  #: rows of a fold
    seed: int  #: seed of folds and models
    purge_s: float = 2.0  #: time on each side of a contiguous block that does not train

    def split_rows(self, data: Data) -> list[Fold]:
        """Return (training rows, validation rows) of each fold of a log."""
        samples, purge = len(data.channels["time_s"]), round(self.purge_s / data.period_s)
        return split_rows(samples, self.folds, self.split, self.seed, purge)


def compare_models(
    data: Mapping[str, Data], validation: CrossValidation
) -> tuple[dict[str, Any], dict[str, SequenceModel]]:
    """Return the errors of Tables II and III with the weights of Fig. 9, and the sweep's models.

    The models are by name.
    """
    both = {
        name: cross_validate_both(name, validation, data) for name in entries(validation.models)
    }
    reports = [report for way in zip(*both.values(), strict=True) for _, report, _ in way]
    compared = {"models": reports, "weights": weight_shares(data["sweep"], validation)}
    return compared, {name: of[0][0].model for name, of in both.items()}


def cross_validate_both(
    name: str, validation: CrossValidation, logs: Mapping[str, Data]
) -> list[tuple[CrossValidated, dict[str, Any], np.ndarray]]:
    """Cross-validate and test one model for each of ``DIRECTIONS``, on features of the sweep.

    Beside each result stand the errors, and the output for the test log.
    """
    refuse_mixture(*(logs[key] for key in EXPERIMENTS))
    samples = {key: logs[key].samples(name, validation.models) for key in EXPERIMENTS}
    prepared = prepare(build(name, validation.models, validation.seed), samples)
    results = []
    for train, test in DIRECTIONS:
        data, expected = logs[train], prepared.y[test]
        validated = prepared.cross_validated(train, validation.split_rows(data))
        trained_on(validated.model, data, name, validation.models)
        tested = validated.model.readout_.predict(prepared.rows[test])
        report = {
            "model": name,
            "trained_on": data.attributes["experiment"],
            "source": data.attributes["source"],
            "seed": validation.seed,
            "target": data.attributes["target"],
            "unit": data.unit,
            "split": validation.split,
            "train_rmse_kpa": validated.train_rmse,
            "validation_rmse_kpa": validated.validation_rmse,
            "best_fold": validated.best,
            "test_rmse_kpa": rmse(expected, tested),
            "test_halves_rmse_kpa": _halves(expected, tested),
            "train_halves_rmse_kpa": _halves(prepared.y[train], validated.fit),
            "seen_test_rmse_kpa": _seen(data, logs[test], expected, tested),
        }
        results.append((validated, report, tested))
    return results


def _halves(expected: np.ndarray, predicted: np.ndarray) -> list[float]:
    """Return the RMSE in the first and in the second half of a log."""
    return list(map(rmse, np.array_split(expected, 2), np.array_split(predicted, 2)))


def _seen(train: Data, test: Data, expected: np.ndarray, predicted: np.ndarray) -> float:
    """Return the RMSE in the first quarter of a test log, at angles that the training log has.

    In that quarter the sweep reaches the highest frequency of the complex log.
    """
    seen, theta = train.channels["theta_deg"], test.channels["theta_deg"]
    quarter = np.arange(len(theta)) < len(theta) // 4
    known = quarter & (theta >= seen.min()) & (theta <= seen.max())
    return rmse(expected[known], predicted[known]) if known.any() else float("nan")


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
    for grid, names in GRID_MODELS.items():
        for name in filter(models.__contains__, names):
            samples = train.samples(name), test.samples(name)
            for cell in ParameterGrid({key: values[key] for key in GRID_SETTINGS[grid]}):
                model = build(name, validation.models, validation.seed, **cell)
                found[grid].append({"model": name, **cell, **evaluate(model, rows, *samples)})
    return found


def weight_shares(train: Data, validation: CrossValidation) -> dict[str, Any]:
    """Return the share of each feature in the weights, per rule and on average (Fig. 9).

    They are the weights of FPRC's best fold on ``normalised`` features (Eqs. 13, 14).
    """
    model = build("fprc", validation.models, validation.seed)
    prepared = normalised(prepare(model, {"train": train.samples("fprc")}), "train")
    validated = prepared.cross_validated("train", validation.split_rows(train))
    parts = np.split(shares_of(validated.model.readout_.W_out_), [1, 1 + model.n_y], axis=1)
    shares = dict(zip(("bias", "theta_d", "p_o"), parts, strict=True))
    return {
        "mean_share": {name: float(part.sum(axis=1).mean()) for name, part in shares.items()},
        "shares": {name: part.tolist() for name, part in shares.items()},
    }


def normalised(prepared: Prepared, log: str) -> Prepared:
    """Return a prepared FPRC with features of one log scaled to [0, 1] (Eq. 13).

    theta and the filtered P_o are each scaled by their minimum and maximum. The ridge parameter, of
    features in deg and kPa, is divided by both ranges: it counts as much (docs/decisions.md).
    """
    # taps of one signal share its range
    taps = np.split(prepared.rows[log], [prepared.model.n_y], axis=1)
    ranges = [float(np.ptp(of_signal)) for of_signal in taps]
    if 0.0 in ranges:
        raise EvaluationError("FPRC: a signal is constant throughout and cannot be normalised")
    scaled = [(t - t.min()) / width for t, width in zip(taps, ranges, strict=True)]
    weaker = clone(prepared.model)
    weaker.set_params(alpha=prepared.model.alpha / np.prod(ranges))
    return prepared._replace(model=weaker, rows={log: np.hstack(scaled)})


def shares_of(W_out: np.ndarray) -> np.ndarray:
    """Return the absolute weights as shares of their rule."""
    weights = np.abs(W_out)
    return weights / weights.sum(axis=1, keepdims=True)
