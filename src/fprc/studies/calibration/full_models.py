"""Errors of the full models on one rig, and how they compare with those of the surrogate."""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from joblib import Parallel, delayed, parallel_config

from fprc.experiments.comparison import judge_directions
from fprc.experiments.hysteresis import simulate
from fprc.experiments.settings import Judgement, RigSettings
from fprc.paper import DIRECTIONS, MODELS
from fprc.studies.calibration.objective import errors_of


def full_errors(
    on_rig: RigSettings, seeds: Sequence[int], workers: int, judgement: Mapping[str, Any]
) -> list[dict[str, float]]:
    """Return the full models' errors of Tables II and III, one mapping per seed.

    Parameters
    ----------
    judgement : Mapping
        Arguments of ``Judgement`` without the seed.
    """
    with parallel_config("loky", inner_max_num_threads=1):
        return Parallel(n_jobs=workers)(
            delayed(_judge_fully)(on_rig, Judgement(**judgement, seed=seed)) for seed in seeds
        )


def _judge_fully(on_rig: RigSettings, judgement: Judgement) -> dict[str, float]:
    data = simulate(on_rig, judgement.seed)
    reports = [
        {"trained_on": train, "model": name, **report}
        for name in MODELS
        for (train, _), (_, report, _) in zip(
            DIRECTIONS, judge_directions(name, judgement, data, DIRECTIONS), strict=True
        )
    ]
    return errors_of({"models": reports})


def ratios_to_full(
    full: Sequence[Mapping[str, float]], estimated: Sequence[Mapping[str, Any]]
) -> dict[str, float]:
    """Return the ratios of the full models' errors to those of the surrogate."""
    return {
        key: float(np.mean([e[key] for e in full]) / np.mean([e["errors"][key] for e in estimated]))
        for key in full[0]
    }
