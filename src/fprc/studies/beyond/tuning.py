"""Settings of the competitors, chosen at an equal budget on logs that judge nothing else."""

import logging
from collections.abc import Mapping, Sequence
from operator import itemgetter
from typing import Any

import numpy as np
from scipy.stats import loguniform, randint, uniform
from sklearn.model_selection import ParameterSampler

from fprc.evaluation import evaluate
from fprc.experiments.data import Data
from fprc.experiments.settings import Judgement
from fprc.registry import build

log = logging.getLogger(__name__)

_ALPHA = loguniform(1e-6, 1e-1)
#: Low-passes of a bank: epsilon of the fastest and the slowest, and their number; their ratio from
#: one to the next is constant.
_BANK = {
    "fastest": loguniform(0.02, 0.3),
    "slowest": loguniform(0.001, 0.01),
    "filters": randint(2, 7),
}
_FPRC = {
    "epsilon": loguniform(0.002, 1.0),
    "n_c": randint(2, 17),
    "n_u": randint(1, 11),
    "n_y": randint(1, 11),
    "sigma": loguniform(0.5, 8.0),
    "alpha": _ALPHA,
}
#: Distributions of the settings of each tuned model; other settings keep their defaults. The upper
#: end of ``randint`` is excluded.
SPACES: dict[str, dict[str, Any]] = {
    "fprc": _FPRC,
    "fprc_lowpass": _FPRC,
    "esn": {
        "r": [100, 200, 400, 800],
        "f_input": loguniform(0.002, 0.1),
        "gamma": uniform(0.0, 0.99),
        "rho": uniform(0.1, 1.1),
        "n_y": randint(1, 11),
        "alpha": _ALPHA,
    },
    "bank": {**_BANK, "n_y": randint(1, 11), "alpha": _ALPHA},
    "plays": {**_BANK, "n_plays": randint(4, 21), "n_y": randint(1, 11), "alpha": _ALPHA},
}


def candidates_of(name: str, count: int, seed: int) -> list[dict[str, Any]]:
    """Return the defaults of a model, and ``count`` - 1 settings sampled from its space."""
    sampled = ParameterSampler(SPACES[name], count - 1, random_state=seed)
    return [{}, *map(_settings, sampled)]


def _settings(sampled: Mapping[str, Any]) -> dict[str, Any]:
    """Return plain numbers with four digits, and for a bank the list of its epsilons."""
    plain = {key: _plain(value) for key, value in sampled.items()}
    if "filters" not in plain:
        return plain
    fastest, slowest, filters = (plain.pop(key) for key in _BANK)
    epsilons = np.geomspace(fastest, slowest, int(filters))
    return {**plain, "epsilons": [_plain(epsilon) for epsilon in epsilons]}


def _plain(value: Any) -> int | float:
    return int(value) if isinstance(value, (int, np.integer)) else float(f"{value:.4g}")


def judge_candidate(
    cell: Mapping[str, Any],
    *,
    logs: Sequence[Mapping[str, Data]],
    judgement: Judgement,
) -> dict[str, float]:
    """Return the training, validation and test error of one candidate.

    They are geometric means over pairs of logs; the rows of a fold are contiguous and purged.

    Parameters
    ----------
    cell : Mapping
        The candidate: ``model`` and ``settings``.
    logs : sequence of Mapping
        Pairs of a training log ``sweep`` and a test log ``complex``.
    """
    errors, name = [], cell["model"]
    for pair in logs:
        model = build(name, judgement.models, judgement.seed, **cell["settings"])
        samples = (pair[key].samples(name) for key in ("sweep", "complex"))
        found = evaluate(model, judgement.split_rows(pair["sweep"]), *samples)
        errors.append({measure: np.mean(values) for measure, values in found.items()})
    return {
        measure: float(np.exp(np.mean(np.log([of_pair[measure] for of_pair in errors]))))
        for measure in errors[0]
    }


def chosen(judged: Mapping[str, Sequence[Mapping[str, Any]]]) -> dict[str, dict[str, Any]]:
    """Return the settings of the tuned models, by name with suffix.

    ``tuned`` has the lowest validation error, ``oracle`` the lowest test error; ``esn_matched`` is
    the ESN whose training error is closest to that of FPRC with its defaults, as in Table II.

    Parameters
    ----------
    judged : Mapping
        By model: its candidates, each with ``settings`` and the errors of ``judge_candidate``;
        the defaults first.
    """
    result = {}
    for name, candidates in judged.items():
        for suffix, error in (("tuned", "validation_rmse_kpa"), ("oracle", "test_rmse_kpa")):
            best = min(candidates, key=itemgetter(error))
            result[f"{name}_{suffix}"] = dict(best["settings"])
    if "esn" in judged:
        wanted = np.log(judged["fprc"][0]["train_rmse_kpa"])
        matched = min(
            judged["esn"], key=lambda candidate: abs(np.log(candidate["train_rmse_kpa"]) - wanted)
        )
        result["esn_matched"] = dict(matched["settings"])
    return result
