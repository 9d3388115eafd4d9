"""Tables II and III: cross-validation and test of the models (Sec. III-D)."""

import logging
from collections.abc import Mapping
from typing import Any

import numpy as np

from fprc.evaluation import CrossValidated, rmse
from fprc.evaluation.crossval import prepare
from fprc.experiments.data import Data, refuse_mixture
from fprc.experiments.grids import weight_shares
from fprc.experiments.settings import CrossValidation
from fprc.experiments.trained import trained_on
from fprc.models import SequenceModel
from fprc.paper import DIRECTIONS, EXPERIMENTS
from fprc.registry import build, entries

log = logging.getLogger(__name__)

#: A model cross-validated on one log, its errors, and its output for the test log.
Validated = tuple[CrossValidated, dict[str, Any], np.ndarray]


def compare_models(
    data: Mapping[str, Data], validation: CrossValidation
) -> tuple[dict[str, Any], dict[str, SequenceModel]]:
    """Return results to report, and the models that were trained on the sweep, by name.

    The results are the errors of Tables II and III, and the weights of Fig. 9.
    """
    names = list(entries(validation.models))
    both = [cross_validate_both(name, validation, data) for name in names]
    compared = {
        "models": [report for direction in zip(*both, strict=True) for _, report, _ in direction],
        "weights": weight_shares(data["sweep"], validation),
    }
    return compared, {name: of[0][0].model for name, of in zip(names, both, strict=True)}


def cross_validate_both(
    name: str, validation: CrossValidation, logs: Mapping[str, Data]
) -> list[Validated]:
    """Cross-validate and test one model for each of ``DIRECTIONS``.

    The features of each log are computed once for both; they are fitted to the sweep.
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
        log.info("%s, trained on %s: test %.2f", name, train, report["test_rmse_kpa"])
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


def errors_over_starts(
    logs: Mapping[str, Data], validation: CrossValidation, starts: int
) -> tuple[dict[str, dict[str, list[float]]], list[SequenceModel]]:
    """Return RMSEs of FPRC whose fuzzy c-means begins at several random places, kPa.

    Each start trains on the same rows, those of the first fold, and clusters once. The errors are
    by the log that trained and by phase; the models are those that the sweep trained.
    """
    samples = {key: data.samples("fprc", validation.models) for key, data in logs.items()}
    prepared = prepare(build("fprc", validation.models, validation.seed), samples)
    seeds = np.random.SeedSequence(validation.seed).generate_state(starts).tolist()
    errors, models = {}, []
    for train, test in DIRECTIONS:
        part, _ = validation.split_rows(logs[train])[0]
        readouts = [prepared.readout(train, part, random_state=seed, restarts=1) for seed in seeds]
        errors[train] = {
            "train": [prepared.error(readout, train, part) for readout in readouts],
            "test": [prepared.error(readout, test) for readout in readouts],
        }
        if train == "sweep":
            fitted = map(prepared.fitted, readouts)
            models = [trained_on(model, logs[train], "fprc", validation.models) for model in fitted]
    return errors, models
