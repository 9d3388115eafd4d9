"""Numbers of the result files that the claims are judged on, an array with a value per seed."""

from collections.abc import Callable, Mapping
from functools import reduce
from operator import getitem
from typing import Any

import numpy as np
from scipy.stats import rankdata

from fprc.claims.claim import Results

#: Phases as readers see them, and their errors in reports.
PHASES = {
    "training": "train_rmse_kpa",
    "validation": "validation_rmse_kpa",
    "test": "test_rmse_kpa",
}

#: Share of the sizes of taps, smallest first, that count as few, and as many at the other end.
_FEW = 0.3


def error(results: Results, trained_on: str, model: str, phase: str) -> np.ndarray:
    """Return a model's error, kPa, averaged over the folds."""
    return _of(results, trained_on, model, lambda report: np.mean(report[PHASES[phase]]))


def _of(
    results: Results, trained_on: str, model: str, number: Callable[[Mapping[str, Any]], Any]
) -> np.ndarray:
    """Return a number of the reports of a model, one per seed."""
    return np.array(
        [
            number(report)
            for replicate in results.replicates
            for report in replicate["models"]
            if (report["trained_on"], report["model"]) == (trained_on, model)
        ]
    )


def ratio(results: Results, trained_on: str, model: str, other: str, phase: str) -> np.ndarray:
    """Return a model's error over another one's."""
    return error(results, trained_on, model, phase) / error(results, trained_on, other, phase)


def second_over_first_half(
    results: Results, trained_on: str, model: str, phase: str = "test"
) -> np.ndarray:
    """Return the error in the second half of the training or test log over that in the first."""
    key = f"{phase}_halves_rmse_kpa"
    return _of(results, trained_on, model, lambda report: report[key][1] / report[key][0])


def seen_error(results: Results, trained_on: str, model: str) -> np.ndarray:
    """Return a model's test error at frequencies and angles of its training log, kPa."""
    return _of(results, trained_on, model, lambda report: report["seen_test_rmse_kpa"])


def spread_over_folds(results: Results, trained_on: str, model: str, phase: str) -> np.ndarray:
    """Return the standard deviation of a model's error over the folds, kPa."""
    return _of(results, trained_on, model, lambda report: np.std(report[PHASES[phase]], ddof=1))


def variation_among_rules(results: Results, feature: str) -> np.ndarray:
    """Return the standard deviation of a feature's share of the weights over the rules' mean."""
    shares = [np.sum(r["weights"]["shares"][feature], axis=1) for r in results.replicates]
    return np.array([np.std(share, ddof=1) / np.mean(share) for share in shares])


def share(results: Results, feature: str) -> np.ndarray:
    """Return a feature's share of FPRC's weights, averaged over the rules."""
    return np.array([report["weights"]["mean_share"][feature] for report in results.replicates])


def measured(results: Results, *keys: str) -> np.ndarray:
    """Return a number of ``fprc.experiments.measures``."""
    return np.array([reduce(getitem, keys, report) for report in results.controls])


def tracking_error(results: Results, reference: str, controller: str) -> np.ndarray:
    """Return a controller's error on a reference, deg."""
    return measured(results, "rmse_deg", f"{reference}/{controller}")


def multiplications(report: Mapping[str, Any], model: str, phase: str, **which: Any) -> np.ndarray:
    """Return how many multiplications the training or test of a model takes, a single value."""
    short = {"training": "train"}.get(phase, phase)
    wanted = {"model": model, "phase": short, "mode": "batch", **which}
    (found,) = [entry for entry in report["times"] if wanted.items() <= entry.items()]
    return np.array([found["multiplications"]])


def rule_counts(results: Results) -> list[int]:
    """Return the numbers of rules with which models were trained."""
    return sorted({entry["n_c"] for entry in results.times_over_n_c["times"]})


def grid(results: Results, setting: str, model: str, phase: str) -> np.ndarray:
    """Return errors over a rising setting, one row per seed; folds are averaged."""
    rows = []
    for report in results.grids:
        cells = [cell for cell in report[setting] if cell["model"] == model]
        cells.sort(key=lambda cell: cell[setting])
        rows.append([np.mean(cell[PHASES[phase]]) for cell in cells])
    return np.array(rows)


def sizes(results: Results, setting: str) -> list[float]:
    """Return the values of a setting in its grid, rising."""
    cells = results.grids[0][setting]
    return sorted({cell[setting] for cell in cells if cell["model"] == "fprc"})


def taps(report: Mapping[str, Any], tap: str, phase: str) -> tuple[np.ndarray, np.ndarray]:
    """Return the sizes of one tap, and the errors with each, a column per size of the other."""
    found = {(cell["n_u"], cell["n_y"]): np.mean(cell[PHASES[phase]]) for cell in report["taps"]}
    n_u, n_y = (np.unique(sizes) for sizes in zip(*found, strict=True))
    errors = np.array([[found[u, y] for y in n_y] for u in n_u])
    return (n_u, errors) if tap == "n_u" else (n_y, errors.T)


def tap_trend(results: Results, tap: str, phase: str) -> np.ndarray:
    """Return the rank correlation of an error with one tap size, averaged over the other's."""
    ranks = [
        rankdata(np.column_stack(taps(report, tap, phase)), axis=0) for report in results.grids
    ]
    return np.array([np.corrcoef(rank, rowvar=False)[0, 1:].mean() for rank in ranks])


def thirds_of_taps(results: Results, tap: str, phase: str) -> list[np.ndarray]:
    """Return the mean errors with few, a medium number of, and many taps."""
    rows = []
    for report in results.grids:
        _, errors = taps(report, tap, phase)
        few = max(round(_FEW * len(errors)), 1)
        parts = np.split(errors.mean(axis=1), [few, len(errors) - few])
        rows.append([part.mean() for part in parts])
    return list(np.transpose(rows))
