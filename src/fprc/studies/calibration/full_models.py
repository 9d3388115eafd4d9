"""Measures of the full models on one rig, and how they compare with those of the surrogate."""

from collections.abc import Collection, Mapping, Sequence
from typing import Any

import numpy as np
from joblib import Parallel, delayed, parallel_config

from fprc.experiments.comparison import judge_directions
from fprc.experiments.grids import weight_shares
from fprc.experiments.hysteresis import simulate
from fprc.experiments.settings import Judgement, RigSettings
from fprc.experiments.tracking import Track, rms_of, tracking_errors
from fprc.paper import MODELS
from fprc.studies.calibration.objective import errors_of
from fprc.studies.calibration.surrogate import LOOPS, SHARES


def judge_fully(
    on_rig: RigSettings,
    seeds: Sequence[int],
    workers: int,
    judgement: Mapping[str, Any],
    tracking: Mapping[str, Any],
    measures: Collection[str],
) -> list[dict[str, dict[str, float]]]:
    """Return the full models' errors on a rig, one mapping per seed.

    Parameters
    ----------
    judgement : Mapping
        Arguments of ``Judgement`` without the seed.
    tracking : Mapping
        Section ``tracking`` of the configuration.
    measures : collection of str
        Which of ``SHARES`` and ``LOOPS`` of ``surrogate`` to compute beside the errors.

    Returns
    -------
    list of dict
        ``errors`` of Tables II and III by "trained on/model/phase", kPa; and of ``measures``, with
        FPRC trained on the sweep: ``shares``, that of P_o in the weights over theta_d's, and the
        RMSE of a loop by reference, deg.
    """
    with parallel_config("loky", inner_max_num_threads=1):
        return Parallel(n_jobs=workers)(
            delayed(_judge_seed)(on_rig, Judgement(**judgement, seed=seed), tracking, measures)
            for seed in seeds
        )


def _judge_seed(
    on_rig: RigSettings,
    judgement: Judgement,
    tracking: Mapping[str, Any],
    measures: Collection[str],
) -> dict[str, dict[str, float]]:
    data = simulate(on_rig, judgement.seed)
    of_models = {name: judge_directions(name, judgement, data) for name in MODELS}
    reports = [report for directions in of_models.values() for _, report, _ in directions]
    judged = {"errors": errors_of({"models": reports})}
    if SHARES in measures:
        shares = weight_shares(data["sweep"], judgement)["mean_share"]
        judged[SHARES] = {"p_o_over_theta_d": shares["p_o"] / shares["theta_d"]}
    if loops := {name: gains for name, gains in LOOPS.items() if name in measures}:
        (trained_on_sweep, *_), _ = of_models["fprc"]
        bench = Track(tracking, on_rig.control, on_rig.rig, judgement.seed)
        judged |= rms_of(tracking_errors(bench, trained_on_sweep.model, loops))
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
