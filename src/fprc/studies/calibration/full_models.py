"""Measures of the full models on one rig, and how they compare with those of the surrogate."""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from joblib import Parallel, delayed, parallel_config

from fprc.experiments.comparison import judge_directions
from fprc.experiments.hysteresis import simulate
from fprc.experiments.settings import Judgement, RigSettings
from fprc.experiments.tracking import Track, rms_of, tracking_errors
from fprc.paper import DIRECTIONS, MODELS
from fprc.registry import build
from fprc.studies.calibration.objective import errors_of


def judge_fully(
    on_rig: RigSettings,
    seeds: Sequence[int],
    workers: int,
    judgement: Mapping[str, Any],
    tracking: Mapping[str, Any],
    loops: Mapping[str, bool],
) -> list[dict[str, dict[str, float]]]:
    """Return the full models' errors on a rig, one mapping per seed.

    Parameters
    ----------
    judgement : Mapping
        Arguments of ``Judgement`` without the seed.
    tracking : Mapping
        Section ``tracking`` of the configuration.
    loops : Mapping
        See ``tracking_errors``; these errors are of FPRC trained on the sweep.

    Returns
    -------
    list of dict
        ``errors`` of Tables II and III by "trained on/model/phase", kPa, and those of ``loops`` by
        reference, deg.
    """
    with parallel_config("loky", inner_max_num_threads=1):
        return Parallel(n_jobs=workers)(
            delayed(_judge_seed)(on_rig, Judgement(**judgement, seed=seed), tracking, loops)
            for seed in seeds
        )


def _judge_seed(
    on_rig: RigSettings,
    judgement: Judgement,
    tracking: Mapping[str, Any],
    loops: Mapping[str, bool],
) -> dict[str, dict[str, float]]:
    data = simulate(on_rig, judgement.seed)
    reports = [
        {"trained_on": train, "model": name, **report}
        for name in MODELS
        for (train, _), (_, report, _) in zip(
            DIRECTIONS, judge_directions(name, judgement, data, DIRECTIONS), strict=True
        )
    ]
    judged = {"errors": errors_of({"models": reports})}
    if loops:
        fprc = build("fprc", judgement.models, judgement.seed).fit(*data["sweep"].pair("fprc"))
        bench = Track(tracking, on_rig.control, on_rig.rig, judgement.seed)
        judged |= rms_of(tracking_errors(bench, fprc, loops))
    return judged


def ratios_to_full(
    full: Sequence[Mapping[str, Mapping[str, float]]], estimated: Sequence[Mapping[str, Any]]
) -> dict[str, dict[str, float]]:
    """Return the ratios of the full models' mean errors to those of the surrogate, by measure."""

    def mean(judged: Sequence[Mapping[str, Any]], measure: str, key: str) -> float:
        return float(np.mean([seed[measure][key] for seed in judged]))

    return {
        measure: {key: mean(full, measure, key) / mean(estimated, measure, key) for key in errors}
        for measure, errors in full[0].items()
    }
