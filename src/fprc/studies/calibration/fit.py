"""Fit the simulated rig to published numbers and claims."""

import copy
import logging
import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict, replace
from datetime import UTC, datetime
from functools import partial
from typing import Any, NamedTuple

import numpy as np
from joblib import Parallel, delayed, parallel_config

from fprc import __version__
from fprc.config.rig import Rig
from fprc.errors import FprcError
from fprc.evaluation.cells import checkpoint_key
from fprc.experiments.settings import RigSettings
from fprc.provenance import hash_of
from fprc.studies.calibration.full_models import judge_fully, ratios_to_full
from fprc.studies.calibration.objective import (
    Aim,
    aim_of,
    deviations,
    judged_of,
    numbers_of,
    scaled,
)
from fprc.studies.calibration.search import SearchResult, search
from fprc.studies.calibration.space import (
    Free,
    decode,
    encode,
    free_parameters,
    resolved,
    starts_near,
)
from fprc.studies.calibration.surrogate import judge_by_surrogate

log = logging.getLogger(__name__)

#: Measure that a term of the objective needs besides errors and properties.
_NEEDS = {
    "C8": "shares", "C9a": "epsilon", "C9b": "n_c", "C11": "n_c", "C12": "taps",
    "open_loop": "open_loop", "closed_loop": "closed_loop",
    "closed_sweep": "closed_loop", "margin": "firm_loop",
}  # fmt: skip


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
    rig. The search for all of ``calibration.fit`` follows from its best point, on all seeds. Both
    use cheap surrogates of the models. Where a round begins, the full models judge the rig, in the
    first search on its seed, then on ``calibration.full_seeds``, since few seeds are no fair
    sample; the surrogate's errors of the round, and its shares of the weights, are multiplied by
    the ratios of theirs to its own.
    At the end the full models judge the fitted rig on these seeds.

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
        The fitted rig, and a summary of the fit. Losses are of the last search's terms, with the
        surrogate corrected at the rig that has them; rounds and rigs are those of all searches.
    """
    free = free_parameters(calibration["free"], calibration["ranges"])
    seeds = calibration["seeds"]
    first = [term for term in calibration["first"]["fit"] if term in calibration["fit"]]
    planned = [{"rounds": calibration["rounds"], "starts": 1}]
    if first:
        one = seeds[:1]
        planned.insert(0, {**calibration["first"], "fit": first, "seeds": one, "full_seeds": one})
    ends = time.monotonic() + 60.0 * calibration["minutes"]
    searched = partial(
        _searched, printed=printed, judgement=judgement, grids=grids, tracking=tracking,
        free=free, workers=workers, version=version, ends=ends,
    )  # fmt: skip
    start = encode(on_rig.rig, free)
    start_rig = _rig_at(start, on_rig, free)
    done: list[Searched] = []
    for number, plan in enumerate(planned, start=1):
        changed = {**calibration, **plan}
        log.info("search %d of %d, for %s", number, len(planned), ", ".join(changed["fit"]))
        at = done[-1].best if done else start_rig
        done.append(searched(at, calibration=changed, checkpoint=f"{checkpoint}.{number}"))
    best, aim, judge, result = done[-1]
    log.info("judging the first and the fitted rig with the full models")
    at_start, at_end = judge(start_rig, workers), judge(best, workers)
    summary = {
        "date": datetime.now(UTC).date().isoformat(),
        "software": f"fprc {__version__}",
        "seeds": list(seeds),
        "full_seeds": list(calibration["full_seeds"]),
        **_outcome(at_end, aim),
        "median_deviation_at_start": float(np.median(_off(at_start.full, aim))),
        "loss_at_start": sum(_losses(at_start, aim).values()),
        "loss": sum(_losses(at_end, aim).values()),
        "rig_sha256": hash_of(best.rig),
        "searches": [
            {"fit": list(search.aim.fit), "rounds": search.result.rounds} for search in done
        ],
        "rounds": sum(search.result.rounds for search in done),
        "evaluations": sum(search.result.evaluations for search in done),
        "finished": all(search.result.finished for search in done),
        "parameters": [
            p._asdict() | {"began_at": before, "share": share}
            for p, before, share in zip(free, start.tolist(), result.point.tolist(), strict=True)
        ],
    }
    return best.rig, summary


class Corrected(NamedTuple):
    """A rig as the full models and the surrogate judge it, one mapping per seed."""

    full: list[dict[str, dict[str, float]]]
    estimated: list[dict[str, Any]]
    ratios: dict[str, dict[str, float]]  #: see ``ratios_to_full``


class Searched(NamedTuple):
    """The end of a search."""

    best: RigSettings
    aim: Aim
    judge: Callable[[RigSettings, int], Corrected]  #: of a rig, by so many processes
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
        grids=grids,
        tracking=tracking,
    )

    def judge(on_rig: RigSettings, workers: int) -> Corrected:
        full = judge_fully(
            on_rig, calibration["full_seeds"], workers=workers,
            judgement=judgement, tracking=tracking, measures=_measures(calibration),
        )  # fmt: skip
        estimated = estimate(on_rig, seeds)
        return Corrected(full, estimated, ratios_to_full(full, estimated))

    like = estimate(start_rig, seeds)
    # a search that ran out of time goes on if it is given more
    settings = {key: value for key, value in calibration.items() if key != "minutes"}
    key = checkpoint_key([asdict(start_rig), judgement, settings, grids, tracking, aim, version])
    result = search(
        partial(judge_point, on_rig=start_rig, free=free, seeds=seeds, estimate=estimate, key=key),
        partial(corrections, on_rig=start_rig, free=free, judge=judge, workers=workers),
        lambda found: np.concatenate([*deviations(judged_of(found, like), aim).values()]),
        starts_near(encode(start_rig.rig, free), calibration["starts"], seeds[0]),
        rounds=calibration["rounds"],
        workers=workers,
        checkpoint=checkpoint,
        key=key,
        seconds=ends - time.monotonic(),
        progress=partial(log.info, "round %d of %d, least loss %.4f, %.0f s"),
    )
    return Searched(_rig_at(result.point, start_rig, free), aim, judge, result)


def _rig_at(point: np.ndarray, on_rig: RigSettings, free: Sequence[Free]) -> RigSettings:
    return replace(on_rig, rig=resolved(decode(point, on_rig.rig, free)))


def corrections(
    points: Sequence[np.ndarray],
    *,
    on_rig: RigSettings,
    free: Sequence[Free],
    judge: Callable[[RigSettings, int], Corrected],
    workers: int,
) -> list[list[list[float]] | None]:
    """Return the numbers of the surrogate at points, and what the full models add to them.

    None stands for a rig on which the full models are impossible.
    """
    # one rig's seeds or several rigs are judged side by side
    at_once = min(workers, len(points))
    with parallel_config("loky", inner_max_num_threads=1):
        return Parallel(n_jobs=at_once)(
            delayed(_correction)(_rig_at(point, on_rig, free), judge, workers // at_once)
            for point in points
        )


def _correction(
    on_rig: RigSettings, judge: Callable[[RigSettings, int], Corrected], workers: int
) -> list[list[float]] | None:
    try:
        Rig.model_validate(on_rig.rig)
        _, estimated, ratios = judge(on_rig, workers)
    except (FprcError, ValueError):
        return None
    numbers = numbers_of(estimated)
    added = np.subtract(numbers_of(scaled(estimated, ratios)), numbers)
    finite = np.isfinite(numbers).all() and np.isfinite(added).all()
    return [numbers, added.tolist()] if finite else None


def _losses(judged: Corrected, aim: Aim) -> dict[str, float]:
    """Return the sum of squares of each term."""
    terms = deviations(scaled(judged.estimated, judged.ratios), aim)
    return {name: float(np.sum(values**2)) for name, values in terms.items()}


def _outcome(judged: Corrected, aim: Aim) -> dict[str, Any]:
    """Describe a rig by the full models' errors, and the surrogate's terms and properties.

    The median and the largest deviation are of Tables II and III.
    """
    off = _off(judged.full, aim)
    return {
        "fit": list(aim.fit),
        "printed": aim.printed,
        "residuals": relative(judged.full, aim),
        "median_deviation": float(np.median(off)),
        "largest_deviation": float(np.max(off)),
        "terms": _losses(judged, aim),
        "properties": {
            name: float(np.mean([seed["properties"][name] for seed in judged.estimated]))
            for name in judged.estimated[0]["properties"]
        },
        "plausible": dict(aim.ranges),
        "surrogate_ratios": judged.ratios,
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
    centers: dict[int, dict[str, np.ndarray]] | None = None,
) -> list[dict[str, Any]]:
    """Return the surrogate's measures of each seed.

    ``centers`` are those of ``judge_by_surrogate``, by seed.
    """
    wanted, centers = _measures(calibration), {} if centers is None else centers
    return [
        judge_by_surrogate(
            on_rig, seed, models, calibration, grids, tracking, wanted, centers.setdefault(seed, {})
        )
        for seed in seeds
    ]


def _measures(calibration: Mapping[str, Any]) -> set[str]:
    return {_NEEDS[term] for term in calibration["fit"] if term in _NEEDS}


def judge_point(
    point: np.ndarray,
    beside: np.ndarray,
    *,
    on_rig: RigSettings,
    free: Sequence[Free],
    seeds: Sequence[int],
    estimate: Any,
    key: str,
) -> list[float] | None:
    """Return the numbers of the measures at a point; None if the rig is impossible.

    Its clusterings begin at those of the point ``beside``. ``key`` says what is measured.
    """
    at, near = (_rig_at(each, on_rig, free) for each in (point, beside))
    try:
        Rig.model_validate(at.rig)
        centers = centers_of(near, seeds, estimate, key)
        numbers = numbers_of(estimate(at, seeds, centers=copy.deepcopy(centers)))
    except (FprcError, ValueError):
        return None
    return numbers if np.isfinite(numbers).all() else None


#: Centres of the clusterings of the last rig around which others were judged, in this process.
_LAST: dict[str, dict[int, dict[str, np.ndarray]]] = {}


def centers_of(
    on_rig: RigSettings, seeds: Sequence[int], estimate: Any, key: str
) -> dict[int, dict[str, np.ndarray]]:
    """Return the centres of a rig's clusterings, by seed; those of the last rig are kept."""
    of = hash_of({"rig": on_rig.rig, "of": key})
    if of not in _LAST:
        centers: dict[int, dict[str, np.ndarray]] = {}
        estimate(on_rig, seeds, centers=centers)
        _LAST.clear()
        _LAST[of] = centers
    return _LAST[of]


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
        if measure in aim.printed
    }
