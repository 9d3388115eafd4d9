"""Fit the simulated rig to published numbers."""

import hashlib
import json
import logging
from collections.abc import Mapping, Sequence
from dataclasses import asdict, replace
from datetime import UTC, datetime
from functools import partial
from typing import Any

import numpy as np
from joblib import Parallel, delayed, parallel_config

from fprc import __version__
from fprc.calibration.objective import Aim, loss_of, properties, residuals
from fprc.calibration.search import search
from fprc.calibration.space import Free, decode, encode
from fprc.calibration.surrogate import surrogate_errors
from fprc.config.free import free_ranges
from fprc.config.rig import Rig
from fprc.errors import ConfigError, FprcError
from fprc.experiments.comparison import judge_directions
from fprc.experiments.hysteresis import simulate
from fprc.experiments.settings import Judgement, RigSettings
from fprc.paper import DIRECTIONS, MODELS, PRINTED
from fprc.provenance import hash_of

log = logging.getLogger(__name__)

#: Loss of a rig that cannot be simulated or breaks a rule of the configuration.
IMPOSSIBLE = 100.0


def fit_rig(
    printed: Mapping[str, Any],
    on_rig: RigSettings,
    judgement: Mapping[str, Any],
    calibration: Mapping[str, Any],
    *,
    workers: int,
    checkpoint: str,
    version: str,
) -> tuple[Mapping[str, Any], dict[str, Any]]:
    """Fit the free parameters by CMA-ES, starting at the rig of ``on_rig``.

    The search uses a cheap surrogate of the models. Its errors are multiplied
    by the ratio of the full models' errors to its own on the starting rig. At
    the end the full models judge the fitted rig on the seeds of the objective.

    Parameters
    ----------
    printed : Mapping
        The published numbers.
    judgement : Mapping
        Arguments of ``Judgement`` without the seed.
    calibration : Mapping
        That section of the configuration.

    Returns
    -------
    dict, dict
        The fitted rig, and a summary of the fit.
    """
    aim = aim_of(printed, calibration)
    free = free_parameters(calibration["free"], calibration["ranges"])
    surrogate = {key: calibration[key] for key in ("stride", "esn_nodes")}
    seeds, models = calibration["seeds"], judgement["models"]

    log.info("judging the starting rig with the full models")
    start = encode(on_rig.rig, free)
    first = replace(on_rig, rig=decode(start, on_rig.rig, free))
    loss = partial(
        loss_at,
        on_rig=on_rig,
        free=free,
        seeds=seeds,
        aim=aim,
        ratios=_ratios(first, aim, seeds[:2], workers, judgement, surrogate),
        models=models,
        surrogate=surrogate,
    )
    depends_on = [asdict(on_rig), judgement, free, surrogate, seeds, aim, version]
    result = search(
        loss,
        start,
        step=calibration["step"],
        population=calibration["population"],
        generations=calibration["generations"],
        seed=seeds[0],
        workers=workers,
        checkpoint=checkpoint,
        key=hashlib.sha256(json.dumps(depends_on, sort_keys=True).encode()).hexdigest(),
        seconds=60.0 * calibration["minutes"],
        progress=_report_progress,
    )
    loss_at_start = loss(start)
    point = result.point if result.loss <= loss_at_start else start
    best = replace(on_rig, rig=decode(point, on_rig.rig, free))
    log.info("judging the fitted rig with the full models, on the seeds of the objective")
    after = residuals(full_errors(best, seeds, workers, judgement), aim)
    measured = [judge_cheaply(best, seed, models, surrogate)[1] for seed in seeds]
    on_other_seeds = partial(loss, seeds=calibration["check_seeds"])
    summary = {
        "date": datetime.now(UTC).date().isoformat(),
        "software": f"fprc {__version__}",
        "seeds": list(seeds),
        "targets_kpa": dict(aim.errors),
        "residuals": after,
        "median_deviation": float(np.median(np.abs(list(after.values())))),
        "largest_deviation": float(np.max(np.abs(list(after.values())))),
        "properties": {name: float(np.mean([m[name] for m in measured])) for name in measured[0]},
        "plausible": dict(aim.ranges),
        "standin_ratios": loss.keywords["ratios"],
        "loss_at_start": loss_at_start,
        "loss": min(result.loss, loss_at_start),
        "check_seeds": list(calibration["check_seeds"]),
        "check_loss_at_start": on_other_seeds(start),
        "check_loss": on_other_seeds(point),
        "rig_sha256": hash_of(best.rig),
        "generations": result.generations,
        "evaluations": result.evaluations,
        "finished": result.finished,
        "parameters": [
            {
                "path": p.path,
                "low": p.low,
                "high": p.high,
                "began_at": float(before),
                "share": float(share),
            }
            for p, before, share in zip(free, start, point, strict=True)
        ],
    }
    return best.rig, summary


def _ratios(
    on_rig: RigSettings,
    aim: Aim,
    seeds: Sequence[int],
    workers: int,
    judgement: Mapping[str, Any],
    surrogate: Mapping[str, int],
) -> dict[str, float]:
    """Return the ratios of the full models' errors to those of the surrogate."""
    full = full_errors(on_rig, seeds, workers, judgement)
    cheap = [judge_cheaply(on_rig, seed, judgement["models"], surrogate)[0] for seed in seeds]
    return {
        key: float(np.mean([e[key] for e in full]) / np.mean([e[key] for e in cheap]))
        for key in aim.errors
    }


def aim_of(published: Mapping[str, Any], calibration: Mapping[str, Any]) -> Aim:
    """Return the aim of the search: Tables II and III, orders, plausible properties.

    Validation errors are left out: with shuffled folds they hardly differ from
    the training errors.
    """
    errors = {}
    for trained_on, table in PRINTED.items():
        for model in MODELS:
            printed = published[table][model]
            errors[f"{trained_on}/{model}/train"] = float(printed["train_rmse_kpa"][0])
            errors[f"{trained_on}/{model}/test"] = float(printed["test_rmse_kpa"])
    return Aim(errors, calibration["plausible"], calibration["margin"], calibration["ratio"])


def free_parameters(
    paths: Sequence[str], ranges: Mapping[str, Sequence[float]] | None = None
) -> list[Free]:
    """Return the free parameters with their ranges: narrower ones if given, else the physical ones.

    Raises
    ------
    ConfigError
        Lists every path and every range that is wrong.
    """
    try:
        limits_of = free_ranges(paths, ranges or {})
    except ValueError as error:
        raise ConfigError(f"cannot calibrate:\n  {error}") from None
    return [Free(path, *limits) for path, limits in limits_of.items()]


def loss_at(
    point: np.ndarray,
    *,
    on_rig: RigSettings,
    free: Sequence[Free],
    seeds: Sequence[int],
    aim: Aim,
    ratios: Mapping[str, float],
    models: Mapping[str, Any],
    surrogate: Mapping[str, int],
) -> float:
    """Return the loss of one point of the unit cube."""
    candidate = replace(on_rig, rig=decode(point, on_rig.rig, free))
    try:
        Rig.model_validate(candidate.rig)
        judged = [judge_cheaply(candidate, seed, models, surrogate) for seed in seeds]
        errors = [{key: ratios[key] * seed[key] for key in ratios} for seed, _ in judged]
        loss = loss_of(errors, [measured for _, measured in judged], aim)
    except (FprcError, ValueError):
        return IMPOSSIBLE
    return loss if np.isfinite(loss) else IMPOSSIBLE


def judge_cheaply(
    on_rig: RigSettings,
    seed: int,
    models: Mapping[str, Any],
    surrogate: Mapping[str, int],
) -> tuple[dict[str, float], dict[str, float]]:
    """Return the surrogate's errors and the properties of a rig, for one seed."""
    logs = {name: data.channels for name, data in simulate(on_rig, seed).items()}
    return surrogate_errors(logs, models, seed=seed, **surrogate), properties(logs)


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
    errors = {}
    for name in MODELS:
        judged = judge_directions(name, judgement, data, DIRECTIONS)
        for (train, _), (_, report, _) in zip(DIRECTIONS, judged, strict=True):
            errors[f"{train}/{name}/train"] = float(np.mean(report["train_rmse_kpa"]))
            errors[f"{train}/{name}/test"] = report["test_rmse_kpa"]
    return errors


def _report_progress(done: int, total: int, best: float, elapsed: float) -> None:
    log.info("generation %d of %d, least loss %.4f, %.0f s", done, total, best, elapsed)
