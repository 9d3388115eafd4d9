"""Fit the simulated rig to published numbers and claims."""

import copy
import logging
from collections.abc import Mapping, Sequence
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
    rig. The search for all of ``calibration.fit`` follows on all seeds, from where the last round
    of the first search ended and from where that began. ``calibration.passes`` repeats both, each
    time from where they ended and with the next seed as the first one.

    All searches use cheap surrogates of the models. Where a round begins, the full models judge the
    rig, in the first search on its seed, then on ``calibration.full_seeds``, since few seeds are no
    fair sample; the surrogate's errors of the round, and its shares of the weights, are multiplied
    by the ratios of theirs to its own. At the end the full models judge the fitted rig on these
    seeds.

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
        The fitted rig, and a summary of the fit. Losses are of all terms, with the surrogate
        corrected at the rig that has them; rounds and rigs are those of all searches.
    """
    free = free_parameters(calibration["free"], calibration["ranges"])
    planned = _searches(calibration)
    start = encode(on_rig.rig, free)
    start_rig = _rig_at(start, on_rig, free)
    starts, results = [start], []
    for number, plan in enumerate(planned, start=1):
        log.info("search %d of %d, for %s", number, len(planned), ", ".join(plan["fit"]))
        aim = aim_of(printed, plan)
        judge = Judge(aim, start_rig, free, judgement, plan, grids, tracking)
        is_first = "starts" in plan
        begins = starts_near(starts[0], plan["starts"], plan["seeds"][0]) if is_first else starts
        result = _searched(judge, np.array(begins), workers, f"{checkpoint}.{number}", version)
        starts = [*result.ends, *starts] if is_first else [result.point]
        results.append(result)
    best = _rig_at(result.point, on_rig, free)
    log.info("judging the first and the fitted rig with the full models")
    before, after = (_outcome(judge.corrected(rig, workers), aim) for rig in (start_rig, best))
    summary = {
        "date": datetime.now(UTC).date().isoformat(),
        "software": f"fprc {__version__}",
        "seeds": list(calibration["seeds"]),
        "full_seeds": list(calibration["full_seeds"]),
        **after,
        "median_deviation_at_start": before["median_deviation"],
        "loss_at_start": before["loss"],
        "rig_sha256": hash_of(best.rig),
        "searches": [
            {"fit": list(plan["fit"]), "rounds": result.rounds}
            for plan, result in zip(planned, results, strict=True)
        ],
        "rounds": sum(result.rounds for result in results),
        "evaluations": sum(result.evaluations for result in results),
        "parameters": [
            p._asdict() | {"began_at": began_at, "share": share}
            for p, began_at, share in zip(free, start.tolist(), result.point.tolist(), strict=True)
        ],
    }
    off, off_before = after["median_deviation"], before["median_deviation"]
    if off > off_before:
        log.warning(
            "warning: with the full models the starting rig is closer to Tables II and III than "
            "the fitted one (median %.1f %%, %.1f %%); keep it, or use more calibration.seeds",
            100 * off_before, 100 * off,
        )  # fmt: skip
    log.info(
        "median deviation %.1f %%, largest %.1f %%", 100 * off, 100 * after["largest_deviation"]
    )
    return best.rig, summary


def _searches(calibration: Mapping[str, Any]) -> list[dict[str, Any]]:
    """Return the settings of each search, in their order."""
    seeds = calibration["seeds"]
    first = [term for term in calibration["first"]["fit"] if term in calibration["fit"]]
    planned = []
    for turn in range(calibration["passes"]):
        turned = [seeds[(turn + i) % len(seeds)] for i in range(len(seeds))]
        if first:
            only = {"fit": first, "seeds": turned[:1], "full_seeds": turned[:1]}
            planned.append({**calibration, **calibration["first"], **only})
        planned.append({**calibration, "seeds": turned})
    return planned


class Corrected(NamedTuple):
    """A rig as the full models and the surrogate judge it, one mapping per seed."""

    full: list[dict[str, dict[str, float]]]
    estimated: list[dict[str, Any]]
    ratios: dict[str, dict[str, float]]  #: see ``ratios_to_full``


class Judge(NamedTuple):
    """Judges rigs for the terms of ``calibration.fit``, with surrogate and with full models."""

    aim: Aim
    on_rig: RigSettings  #: the rig at which the search begins
    free: Sequence[Free]  #: in what other rigs differ from it
    judgement: Mapping[str, Any]  #: arguments of ``Judgement`` without the seed
    calibration: Mapping[str, Any]
    grids: Mapping[str, Sequence[float]]
    tracking: Mapping[str, Any]

    def rig_at(self, point: np.ndarray) -> RigSettings:
        """Return the rig at a point."""
        return _rig_at(point, self.on_rig, self.free)

    def measures(self) -> set[str]:
        """Return what the terms need besides errors and properties."""
        return {_NEEDS[term] for term in self.calibration["fit"] if term in _NEEDS}

    def estimate(
        self, on_rig: RigSettings, centers: dict[int, dict[str, np.ndarray]] | None = None
    ) -> list[dict[str, Any]]:
        """Return the surrogate's measures of each seed.

        ``centers`` are those of ``judge_by_surrogate``, by seed.
        """
        centers = {} if centers is None else centers
        return [
            judge_by_surrogate(
                on_rig, seed, self.measures(), centers.setdefault(seed, {}),
                models=self.judgement["models"], tracking=self.tracking,
                grids={**self.grids, "taps": self.calibration["taps"]},
            )
            for seed in self.calibration["seeds"]
        ]  # fmt: skip

    def numbers(self, point: np.ndarray, beside: np.ndarray, key: str) -> list[float] | None:
        """Return the numbers of the measures at a point; None if the rig is impossible.

        Its clusterings begin at those of the point ``beside``. ``key`` says what is measured.
        """
        at, near = self.rig_at(point), self.rig_at(beside)
        try:
            Rig.model_validate(at.rig)
            centers = self._centers(near, key)
            numbers = numbers_of(self.estimate(at, copy.deepcopy(centers)))
        except (FprcError, ValueError):
            return None
        return numbers if np.isfinite(numbers).all() else None

    def _centers(self, on_rig: RigSettings, key: str) -> dict[int, dict[str, np.ndarray]]:
        """Return the centres of a rig's clusterings, by seed; those of the last rig are kept."""
        of = hash_of({"rig": on_rig.rig, "of": key})
        if of not in _LAST:
            centers: dict[int, dict[str, np.ndarray]] = {}
            self.estimate(on_rig, centers)
            _LAST.clear()
            _LAST[of] = centers
        return _LAST[of]

    def corrected(self, on_rig: RigSettings, workers: int) -> Corrected:
        """Judge a rig with the surrogate and, by so many processes, with the full models."""
        full = judge_fully(
            on_rig, self.calibration["full_seeds"], workers=workers, judgement=self.judgement,
            tracking=self.tracking, measures=self.measures(),
        )  # fmt: skip
        estimated = self.estimate(on_rig)
        return Corrected(full, estimated, ratios_to_full(full, estimated))

    def corrections(
        self, points: Sequence[np.ndarray], workers: int
    ) -> list[list[list[float]] | None]:
        """Return the numbers of the surrogate at points, and what the full models add to them.

        None stands for a rig on which the full models are impossible.
        """
        # one rig's seeds or several rigs are judged side by side
        at_once = min(workers, len(points))
        with parallel_config("loky", inner_max_num_threads=1):
            return Parallel(n_jobs=at_once)(
                delayed(self._correction)(point, workers // at_once) for point in points
            )

    def _correction(self, point: np.ndarray, workers: int) -> list[list[float]] | None:
        on_rig = self.rig_at(point)
        try:
            Rig.model_validate(on_rig.rig)
            _, estimated, ratios = self.corrected(on_rig, workers)
        except (FprcError, ValueError):
            return None
        numbers = numbers_of(estimated)
        added = np.subtract(numbers_of(scaled(estimated, ratios)), numbers)
        finite = np.isfinite(numbers).all() and np.isfinite(added).all()
        return [numbers, added.tolist()] if finite else None


#: Centres of the clusterings of the last rig around which others were judged, in this process.
_LAST: dict[str, dict[int, dict[str, np.ndarray]]] = {}


def _rig_at(point: np.ndarray, on_rig: RigSettings, free: Sequence[Free]) -> RigSettings:
    return replace(on_rig, rig=resolved(decode(point, on_rig.rig, free)))


def _searched(
    judge: Judge, starts: np.ndarray, workers: int, checkpoint: str, version: str
) -> SearchResult:
    """Search for the terms of ``calibration.fit``, beginning at several points."""
    aim, on_rig, _, judgement, calibration, grids, tracking = judge
    like = judge.estimate(on_rig)
    key = checkpoint_key([asdict(on_rig), judgement, calibration, grids, tracking, aim, version])
    return search(
        partial(judge.numbers, key=key),
        partial(judge.corrections, workers=workers),
        lambda found: np.concatenate([*deviations(judged_of(found, like), aim).values()]),
        starts,
        rounds=calibration["rounds"],
        workers=workers,
        checkpoint=checkpoint,
        key=key,
    )


def _outcome(judged: Corrected, aim: Aim) -> dict[str, Any]:
    """Describe a rig by the full models' errors, and the surrogate's terms and properties.

    ``residuals`` are shares of the printed errors; the median and the largest deviation are of
    Tables II and III; a term is a sum of squares.
    """
    residuals = {
        measure: {
            key: float(np.mean([seed[measure][key] for seed in judged.full]) / printed - 1.0)
            for key, printed in aim.printed[measure].items()
        }
        for measure in judged.full[0]
        if measure in aim.printed
    }
    off = np.abs(list(residuals["errors"].values()))
    apart = deviations(scaled(judged.estimated, judged.ratios), aim)
    terms = {name: float(np.sum(values**2)) for name, values in apart.items()}
    return {
        "fit": list(aim.fit),
        "printed": aim.printed,
        "residuals": residuals,
        "median_deviation": float(np.median(off)),
        "largest_deviation": float(np.max(off)),
        "terms": terms,
        "loss": sum(terms.values()),
        "properties": {
            name: float(np.mean([seed["properties"][name] for seed in judged.estimated]))
            for name in judged.estimated[0]["properties"]
        },
        "plausible": dict(aim.ranges),
        "surrogate_ratios": judged.ratios,
    }
