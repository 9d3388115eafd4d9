"""Fit the simulated rig to published numbers and claims, from the ranges of its parameters alone.

Rigs are drawn from the ranges. Searches start at those whose loops in the sweep look like Figs. 4
and 5 and whose numbers miss print the least; after some rounds (``search``) the better half of them
goes on, until one is left. A round uses cheap surrogates of the models, with the noise of one seed,
so that differences between rigs are not noise; where it begins, the full models with several seeds
correct them.
"""

import logging
import math
import textwrap
import time
from collections.abc import Callable, Iterable, Mapping, Sequence
from datetime import UTC, datetime
from typing import Any

import numpy as np
import yaml
from joblib import Parallel, delayed
from scipy.special import ndtr, ndtri

from fprc import __version__
from fprc.config.calibration import FIRST_SEED, SEEDS_PER_FIT
from fprc.config.rig import Rig, free_ranges
from fprc.errors import EvaluationError, FprcError
from fprc.experiments.data import RigSettings
from fprc.paper import REFERENCES
from fprc.studies.calibration.objective import misses, numbers_of, printed_errors, targets
from fprc.studies.calibration.search import search_round
from fprc.studies.calibration.space import decode, encode, value_at
from fprc.studies.calibration.surrogate import judge_by_surrogate, judge_fully, judge_loops

log = logging.getLogger(__name__)

#: A fitted rig may become the default if on seeds that no fit has seen its 18 errors are within 5 %
#: of print in the median and 15 % at most, open-loop Table IV within 15 %, closed-loop Table IV
#: within 20 % in the median and 35 % at most, and feedback helps with gains half again as large. Of
#: several, the one of the least misfit does. A fit says how its rig does on seeds of its own.
LIMITS = {"median": 0.05, "largest": 0.15, "open_loop": 0.15, "closed_median": 0.2, "closed": 0.35}

#: Rigs that are drawn for each one that is judged, and most that the square of a miss counts there;
#: seeds of the full models while several searches go on.
_DRAWN, _MOST, _FEW = 15, 100.0, 2

#: Offsets of the seeds of an ensemble, of the searches, and of the full models, from that of the
#: first draw.
_ENSEMBLE, _SEARCH, _FULL = 5000, 9000, 9500

#: Largest deviations of the 12 errors of Tables II and III from print, in the median and of any, on
#: a rig of the ensemble.
MEDIAN, LARGEST = 0.08, 0.25

#: Standard deviation of the rigs that are drawn for the ensemble, in normal units of the ranges, so
#: that a third of them fit; how many are drawn at most for each that is needed.
_SPREAD, _DRAWN_AROUND = 0.25, 10

Settings = Mapping[str, Any]
Judged = Mapping[str, Any]
Judge = Callable[..., Judged]


class Fit:
    """A fit of a rig's free parameters; EvaluationError: too few rigs can be simulated, or fit.

    ``printed`` are the published numbers, ``on_rig`` has the rig, ``calibration`` is the section;
    ``how`` has ``validation`` and ``tracking``, see ``surrogate.judge_fully``.
    """

    def __init__(
        self, printed: Settings, on_rig: RigSettings, calibration: Settings, pool: Parallel,
        **how: Settings,
    ):  # fmt: skip
        self.printed, self.on_rig, self.calibration = printed, on_rig, calibration
        self.how, self.pool = how, pool
        self.ranges = free_ranges(calibration["free"], calibration["ranges"])
        self.targets = targets(printed, calibration["fit"])
        #: seed of the first draw
        self.first = FIRST_SEED + SEEDS_PER_FIT * calibration["seed"]

    def rig_at(self, point: np.ndarray) -> dict[str, Any]:
        """Return the rig at a point of the unit cube."""
        return decode(point, self.on_rig.rig, self.ranges)

    def judge(
        self, judge: Judge, points: Sequence[np.ndarray], seeds: Iterable[int], *given: Any
    ) -> list[Judged | None]:
        """Judge points, each with its seed; those that are impossible give None."""
        return self.pool(
            delayed(_judged)(
                judge, self.on_rig.changed(rig=self.rig_at(point)), seed, *given, **self.how
            )
            for point, seed in zip(points, seeds, strict=True)
        )

    def full(self, point: np.ndarray, count: int) -> list[Judged] | None:
        """Judge a point by the full models, with several seeds; None if it is impossible."""
        first = self.first + _FULL
        judged = self.judge(judge_fully, [point] * count, range(first, first + count))
        possible = [one for one in judged if one]
        return possible if len(possible) == count else None

    def loss(self, judged: Sequence[Judged], most: float = math.inf) -> float:
        """Return the sum of squares of the misses of a rig."""
        off = misses(numbers_of(judged, self.targets), self.targets) ** 2
        return float(np.sum(np.minimum(off, most)))

    def starts(self) -> list[np.ndarray]:
        """Draw rigs from the ranges; return the best of those whose loops miss the least."""
        members, count = self.calibration["members"], self.calibration["starts"]
        rng = np.random.default_rng(self.first)
        points = list(rng.random((_DRAWN * members, len(self.ranges))))
        for judge, kept, *given in ((judge_loops, members), (judge_by_surrogate, count, {})):
            seeds = range(self.first, self.first + len(points))
            judged = self.judge(judge, points, seeds, *given)
            losses = [self.loss([one], _MOST) if one else math.inf for one in judged]
            order = np.argsort(losses, kind="stable")[:kept]
            most = losses[order[-1]]
            log.info("%d rigs judged, misfit of the best %d up to %.0f", len(points), kept, most)
            if math.isinf(most):
                raise EvaluationError(
                    "too few rigs of calibration.ranges can be simulated; change the ranges"
                )
            points = [points[k] for k in order]
        return points

    def knockout(self, points: list[np.ndarray]) -> np.ndarray:
        """Search from all points, go on with the better half until one is left; return the best."""
        counts = [len(points)]
        while counts[-1] > 1:
            counts.append(counts[-1] // 2)
        plan = [(count, self.calibration["rounds"], _FEW) for count in counts[:-1]]
        plan.append((1, self.calibration["last_rounds"], self.calibration["full_seeds"]))
        total, done = sum(count * rounds for count, rounds, _ in plan), 0
        begun = time.monotonic()
        losses, running = [math.inf] * len(points), [*range(len(points))]
        for count, rounds, full_seeds in plan:
            running = sorted(running, key=lambda k: losses[k])[:count]
            for k in running:
                known = []  # by the full models, of the last search
                for _ in range(rounds):
                    # noise of its own for each round: none fits the noise of one seed
                    begun_at, seed = points[k], self.first + _SEARCH + done
                    before, losses[k], points[k] = self.round(begun_at, seed, full_seeds)
                    known.append((before, begun_at))
                    done += 1
                    left = (time.monotonic() - begun) / done * (total - done) / 60.0
                    log.info("round %d of %d, search %d: misfit %.0f, then %.0f, %.0f min left",
                             done, total, k + 1, before, losses[k], left)  # fmt: skip
        if full := self.full(points[k], full_seeds):
            known.append((self.loss(full), points[k]))
        return min(known, key=lambda pair: pair[0])[1]

    def round(
        self, point: np.ndarray, seed: int, full_seeds: int
    ) -> tuple[float, float, np.ndarray]:
        """Search from a point with the noise of one seed.

        Return the loss of the full models there, and loss and point of the best that was found.
        """
        (begin,) = self.judge(judge_by_surrogate, [point], [seed], {})
        full = self.full(point, full_seeds)
        if begin is None or full is None:
            return math.inf, math.inf, point
        added = numbers_of(full, self.targets) - numbers_of([begin], self.targets)

        def numbers_at(points: Sequence[np.ndarray]) -> list[np.ndarray | None]:
            # clusterings begin where that of the first point ended: numbers do not jump
            seeds = [seed] * len(points)
            found = self.judge(judge_by_surrogate, points, seeds, begin["centers"])
            return [numbers_of([one], self.targets) + added if one else None for one in found]

        def misses_of(numbers: np.ndarray) -> np.ndarray:
            return misses(numbers, self.targets)

        return self.loss(full), *search_round(numbers_at, misses_of, point)

    def rig_file(self, name: str) -> str:
        """Fit the rig, whose own values play no part; return the text of its file."""
        found = self.knockout(self.starts())
        full = self.full(found, self.calibration["full_seeds"])
        if full is None:
            raise EvaluationError(
                "the best rig cannot be simulated with other noise; choose another calibration.seed"
            )
        shares, brief = dict(zip(self.ranges, found, strict=True)), in_brief(full, self.printed)
        for key, share in brief.items():
            log.info("%s: %.1f %% off print, at most %.0f", key, 100 * share, 100 * LIMITS[key])
        return parameter_file(name, self.rig_at(found), self.calibration, shares, brief)

    def ensemble(self, count: int) -> dict[str, Any]:
        """Return ``count`` rigs that fit the tables and have a stable loop: what print leaves open.

        Rigs are drawn around that of ``on_rig``, each with noise of its own; those that the full
        models find near print (``fits``) are kept. Returned are ``parameters``, paths of the free
        parameters, and ``rigs``, their values rig by rig.
        """
        rigs: list[list[float]] = []
        rng, first = np.random.default_rng(self.first + _ENSEMBLE), self.first + _ENSEMBLE
        middle = ndtri(np.clip(encode(self.on_rig.rig, self.ranges), 0.01, 0.99))
        for turn in range(1, _DRAWN_AROUND + 1):
            points = ndtr(middle + _SPREAD * rng.standard_normal((count, len(middle))))
            found = self.judge(judge_fully, points, range(first, first + count))
            first += count
            for point, judged in zip(points, found, strict=True):
                if judged and fits(judged, self.printed):
                    rig = self.rig_at(point)
                    rigs.append([value_at(rig, path) for path in self.ranges])
            log.info("%d of %d rigs fit, %d are needed", len(rigs), turn * count, count)
            if len(rigs) >= count:
                return {"source": "sim", "parameters": [*self.ranges], "rigs": rigs[:count]}
        raise EvaluationError(f"only {len(rigs)} of {_DRAWN_AROUND * count} rigs fit the tables")


def fits(judged: Judged, printed: Mapping[str, Any]) -> bool:
    """Return whether the full models' errors on a rig fit the tables, and feedback helps."""
    off, closed, opened = in_brief([judged], printed), judged["closed_loop"], judged["open_loop"]
    helps = all(closed[reference] < opened[reference] for reference in REFERENCES)
    return off["median"] <= MEDIAN and off["largest"] <= LARGEST and helps


def in_brief(full: Sequence[Judged], published: Mapping[str, Any]) -> dict[str, float]:
    """Return how far the full models are from print, by the keys of ``LIMITS``, as shares."""

    def off(measure: str, printed: Mapping[str, float]) -> np.ndarray:
        means = [np.mean([seed[measure][key] for seed in full]) for key in printed]
        return np.abs(np.array(means) / list(printed.values()) - 1.0)

    table = published["table_4_tracking_rmse_deg"]
    errors, closed = off("errors", printed_errors(published)), off("closed_loop", table["fprc_pd"])
    return {
        "median": float(np.median(errors)),
        "largest": float(errors.max()),
        "open_loop": float(off("open_loop", table["fprc"]).max()),
        "closed_median": float(np.median(closed)),
        "closed": float(closed.max()),
    }


_HEAD = """\
Parameters of the simulated rig that differ from their defaults. Written by `fprc calibrate`
(fprc {software}, {date}); docs/rigs.md explains it.

Fitted over {count} parameters, from the ranges of `calibration` alone, with the seed {seed}, to the
terms that `fitted.to` names. Everything else is predicted. How far the full models on {full_seeds}
seeds of the fit are from print, errors of Tables II and III, open and closed loop of Table IV:
{limits}
{edges}
"""


def parameter_file(
    name: str, rig: Settings, calibration: Settings, shares: Settings, brief: Mapping[str, float]
) -> str:
    """Return the text of a rig's file: what was fitted, and what differs from the defaults."""
    near = [path for path, share in shares.items() if not 0.02 <= share <= 0.98]
    edges = f"Within 2 % of an end of their range: {', '.join(near) or 'none'}."
    limits = (f"  {key}: {100 * share:.1f} %, at most {100 * LIMITS[key]:.0f}"
              for key, share in brief.items())  # fmt: skip
    head = _HEAD.format(
        software=__version__, date=datetime.now(UTC).date(), count=len(shares), **calibration,
        limits="\n".join(limits), edges=textwrap.fill(edges, 98),
    )  # fmt: skip
    values = {
        "fitted": {"name": name, "to": list(calibration["fit"])},
        "rig": Rig.model_validate(rig).model_dump(mode="json", exclude_defaults=True),
    }
    return textwrap.indent(head, "# ", lambda _: True) + yaml.safe_dump(
        values, sort_keys=False, default_flow_style=None
    )


def _judged(judge: Judge, on_rig: RigSettings, *given: Any, **how: Any) -> Judged | None:
    try:
        Rig.model_validate(on_rig.rig)
        return judge(on_rig, *given, **how)
    except (FprcError, ValueError):
        return None
