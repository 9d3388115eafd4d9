"""Fit the simulated rig to published numbers and claims."""

import hashlib
import json
import logging
import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict, replace
from datetime import UTC, datetime
from functools import partial
from typing import Any, NamedTuple

import numpy as np

from fprc import __version__
from fprc.config.rig import Rig
from fprc.errors import FprcError
from fprc.experiments.settings import RigSettings
from fprc.provenance import hash_of
from fprc.studies.calibration.full_models import judge_fully, ratios_to_full
from fprc.studies.calibration.objective import Aim, Objective, aim_of, logs_of
from fprc.studies.calibration.search import SearchResult, search
from fprc.studies.calibration.space import (
    Free,
    decode,
    encode,
    free_parameters,
    resolved,
    starts_near,
)
from fprc.studies.calibration.surrogate import LOOPS, judge_by_surrogate

log = logging.getLogger(__name__)

#: Measure that a term of the objective needs besides errors and properties.
_NEEDS = {
    "C8": "shares", "C9a": "epsilon", "C9b": "n_c", "C11": "n_c", "C12": "taps",
    "open_loop": "open_loop", "closed_loop": "closed_loop",
    "closed_sweep": "closed_loop",
}  # fmt: skip

#: Measures over grids, which take as long as all others together and vary little between seeds.
_GRIDS = ("epsilon", "n_c", "taps")


def fit_rig(
    printed: Mapping[str, Any],
    on_rig: RigSettings,
    judgement: Mapping[str, Any],
    calibration: Mapping[str, Any],
    grids: Mapping[str, Sequence[float]],
    tracking: Mapping[str, Any],
    *,
    workers: int,
    checkpoint: str,
    version: str,
) -> tuple[Mapping[str, Any], dict[str, Any]]:
    """Fit the free parameters, starting at the rig of ``on_rig``.

    Values outside their range are first moved to its end. A first search asks for those terms of
    ``calibration.fit`` that ``calibration.first.fit`` names, if there are any, on the first seed
    only. It begins at several points, since a single one often leads to a valley without a good
    rig. Then one search for all of ``calibration.fit`` follows for each number in
    ``calibration.rounds``, on all seeds; each begins at the best point of the one before. All use
    cheap surrogates of the models. Where a search begins, the full models judge the rig on
    ``calibration.full_seeds``, and the search multiplies the surrogate's errors by the ratios of
    theirs to its own: the ratios change along the way, and few seeds are no fair sample. At the
    end the full models judge the fitted rig on these seeds.

    Parameters
    ----------
    printed : Mapping
        The published numbers.
    judgement : Mapping
        Arguments of ``Judgement`` without the seed.
    calibration, grids, tracking : Mapping
        Sections of the configuration.

    Returns
    -------
    dict, dict
        The fitted rig, and a summary of the fit. Losses are those of the last search;
        rounds and rigs are those of all.
    """
    free = free_parameters(calibration["free"], calibration["ranges"])
    seeds = calibration["seeds"]
    first = [term for term in calibration["first"]["fit"] if term in calibration["fit"]]
    planned = [
        {"fit": calibration["fit"], "rounds": rounds, "seeds": seeds, "starts": 1}
        for rounds in calibration["rounds"]
    ]
    if first:
        planned.insert(0, {**calibration["first"], "fit": first, "seeds": seeds[:1]})
    ends = time.monotonic() + 60.0 * calibration["minutes"]
    searched = partial(
        _searched, printed=printed, judgement=judgement, grids=grids, tracking=tracking,
        free=free, workers=workers, version=version, ends=ends,
    )  # fmt: skip
    start = encode(on_rig.rig, free)
    start_rig = replace(on_rig, rig=resolved(decode(start, on_rig.rig, free)))
    done: list[Searched] = []
    for number, plan in enumerate(planned, start=1):
        log.info("search %d of %d, for %s", number, len(planned), ", ".join(plan["fit"]))
        at = done[-1].best if done else start_rig
        changed = {**calibration, **plan}
        done.append(searched(at, calibration=changed, checkpoint=f"{checkpoint}.{number}"))
    best, objective, estimate, judge, _, result = done[-1]
    log.info("judging the fitted rig with the full models")
    summary = {
        "date": datetime.now(UTC).date().isoformat(),
        "software": f"fprc {__version__}",
        "seeds": list(seeds),
        "full_seeds": list(calibration["full_seeds"]),
        **_outcome(objective, judge(best), estimate(best, seeds)),
        "median_deviation_at_start": float(np.median(_off(done[0].began, objective.aim))),
        "loss_at_start": objective.loss(estimate(start_rig, seeds)),
        "loss": result.loss,
        "rig_sha256": hash_of(best.rig),
        "searches": [
            {"fit": list(plan["fit"]), "rounds": end.result.rounds}
            for plan, end in zip(planned, done, strict=True)
        ],
        "rounds": sum(end.result.rounds for end in done),
        "evaluations": sum(end.result.evaluations for end in done),
        "finished": all(end.result.finished for end in done),
        "parameters": [
            p._asdict() | {"began_at": before, "share": share}
            for p, before, share in zip(free, start.tolist(), result.point.tolist(), strict=True)
        ],
    }
    return best.rig, summary


class Searched(NamedTuple):
    """The end of a search."""

    best: RigSettings
    objective: Objective
    estimate: Callable[[RigSettings, Sequence[int]], list[dict[str, Any]]]  #: by the surrogate
    judge: Callable[[RigSettings], list[dict[str, dict[str, float]]]]  #: by the full models
    began: list[dict[str, dict[str, float]]]  #: of the rig where it began, by the full models
    result: SearchResult


def _searched(
    start_rig: RigSettings,
    *,
    printed: Mapping[str, Any],
    judgement: Mapping[str, Any],
    calibration: Mapping[str, Any],
    grids: Mapping[str, Sequence[float]],
    tracking: Mapping[str, Any],
    free: Sequence[Free],
    workers: int,
    checkpoint: str,
    version: str,
    ends: float,
) -> Searched:
    """Search for the terms of ``calibration.fit``, beginning at a rig, until the time ``ends``."""
    aim, seeds = aim_of(printed, calibration), calibration["seeds"]
    estimate = partial(
        judge_seeds,
        models=judgement["models"],
        calibration=calibration,
        grids=_in_order(grids, calibration["taps"]),
        tracking=tracking,
    )
    judge = partial(
        judge_fully,
        seeds=calibration["full_seeds"],
        workers=workers,
        judgement=judgement,
        tracking=tracking,
        loops={
            name: feedback for name, feedback in LOOPS.items() if name in _measures(calibration)
        },
    )
    log.info("judging the rig at which the search begins, with the full models")
    began, like = judge(start_rig), estimate(start_rig, seeds)
    objective = Objective(aim, ratios_to_full(began, like), like)
    # a search that ran out of time goes on if it is given more
    settings = {key: value for key, value in calibration.items() if key != "minutes"}
    depends_on = [asdict(start_rig), judgement, settings, grids, tracking, aim, version]
    result = search(
        partial(judge_point, on_rig=start_rig, free=free, seeds=seeds, estimate=estimate),
        lambda logs: np.concatenate([*objective.terms(objective.judged(logs)).values()]),
        starts_near(encode(start_rig.rig, free), calibration["starts"], seeds[0]),
        rounds=calibration["rounds"],
        workers=workers,
        checkpoint=checkpoint,
        key=hashlib.sha256(json.dumps(depends_on, sort_keys=True).encode()).hexdigest(),
        seconds=ends - time.monotonic(),
        progress=partial(log.info, "round %d of %d, least loss %.4f, %.0f s"),
    )
    best = replace(start_rig, rig=resolved(decode(result.point, start_rig.rig, free)))
    return Searched(best, objective, estimate, judge, began, result)


def _outcome(
    objective: Objective,
    full: Sequence[Mapping[str, Mapping[str, float]]],
    judged: Sequence[Mapping[str, Any]],
) -> dict[str, Any]:
    """Describe a rig by the full models' errors, and the surrogate's terms and properties.

    The median and the largest deviation are of Tables II and III.
    """
    off = _off(full, objective.aim)
    return {
        "fit": list(objective.aim.fit),
        "printed": objective.aim.printed,
        "residuals": relative(full, objective.aim),
        "median_deviation": float(np.median(off)),
        "largest_deviation": float(np.max(off)),
        "terms": objective.losses(judged),
        "properties": {
            name: float(np.mean([seed["properties"][name] for seed in judged]))
            for name in judged[0]["properties"]
        },
        "plausible": dict(objective.aim.ranges),
        "surrogate_ratios": objective.ratios,
    }


def _off(full: Sequence[Mapping[str, Mapping[str, float]]], aim: Aim) -> np.ndarray:
    return np.abs(list(relative(full, aim)["errors"].values()))


def judge_seeds(
    on_rig: RigSettings,
    seeds: Sequence[int],
    *,
    models: Mapping[str, Any],
    calibration: Mapping[str, Any],
    grids: Mapping[str, Sequence[float]],
    tracking: Mapping[str, Any],
) -> list[dict[str, Any]]:
    """Return the surrogate's measures of each seed; grids are judged on the first ones only."""
    wanted = _measures(calibration)
    surrogate = {key: calibration[key] for key in ("stride", "esn_nodes", "restarts")}
    return [
        judge_by_surrogate(
            on_rig, seed, models, surrogate, grids, tracking,
            wanted if i < calibration["grid_seeds"] else wanted.difference(_GRIDS),
        )
        for i, seed in enumerate(seeds)
    ]  # fmt: skip


def _measures(calibration: Mapping[str, Any]) -> set[str]:
    return {_NEEDS[term] for term in calibration["fit"] if term in _NEEDS}


def judge_point(
    point: np.ndarray,
    *,
    on_rig: RigSettings,
    free: Sequence[Free],
    seeds: Sequence[int],
    estimate: Any,
) -> list[float] | None:
    """Return the logarithms of the measures at a point; None if the rig is impossible."""
    rig = resolved(decode(point, on_rig.rig, free))
    try:
        Rig.model_validate(rig)
        logs = logs_of(estimate(replace(on_rig, rig=rig), seeds))
    except (FprcError, ValueError):
        return None
    return logs if np.isfinite(logs).all() else None


def relative(
    full: Sequence[Mapping[str, Mapping[str, float]]], aim: Aim
) -> dict[str, dict[str, float]]:
    """Return by what share each error, averaged over seeds, deviates from the printed one."""
    return {
        measure: {
            key: float(np.mean([seed[measure][key] for seed in full]) / printed - 1.0)
            for key, printed in aim.printed[measure].items()
        }
        for measure in full[0]
    }


def _in_order(grids: Mapping[str, Sequence[float]], taps: Sequence[int]) -> dict[str, Any]:
    """Return the grids of the search, sorted: the objective compares neighbours."""
    return {
        "epsilon": sorted(grids["epsilon"], reverse=True),
        "n_c": sorted(grids["n_c"]),
        **dict.fromkeys(("n_u", "n_y"), sorted(taps)),
    }
