"""Search in the unit cube with linear models of everything that was measured.

Judging a point yields many numbers, and the loss is a known function of them. Near a point the
numbers are almost linear in it; the loss, with its limits and squares, is not. The search
therefore fits a linear model of the numbers to the judged points around the best one, minimises
the loss over the model, and judges the points that this gives. It needs far fewer judgements
than a search by the loss alone, and resumes from a checkpoint after a kill.
"""

import math
import time
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import NamedTuple

import numpy as np
from joblib import Parallel, delayed, parallel_config
from scipy.optimize import least_squares

from fprc.artifacts import resuming

#: Points of a generation: minima of the model within these multiples of the radius around the best
#: point, the minimum around another good point, and random points around these.
_REACH = (0.4, 1.0, 2.0)
_POPULATION = 8

#: Radius of the first proposals, and its limits, in units of the cube; factors after a generation
#: with and without a better point.
_RADIUS, _LEAST, _MOST, _GROW, _SHRINK = 0.12, 0.02, 0.4, 1.15, 0.85

#: Weight of the step's length beside the deviations, and ridge of the linear model.
_DAMPING, _RIDGE = 0.5, 0.15


class SearchResult(NamedTuple):
    """Result of a search."""

    point: np.ndarray  #: the best point; the start if none was possible
    loss: float  #: infinite if none was possible
    generations: int
    evaluations: int
    finished: bool  #: False if the time limit ended the search
    numbers: list[np.ndarray]  #: those of every possible point


class _Archive:
    """Judged points with their numbers and losses."""

    def __init__(self, deviations_of: Callable[[Sequence[float]], np.ndarray]):
        self.deviations_of = deviations_of
        self.points: list[np.ndarray] = []
        self.numbers: list[np.ndarray] = []
        self.losses: list[float] = []

    def add(self, points: Sequence[np.ndarray], judged: Sequence[Sequence[float] | None]) -> None:
        for point, numbers in zip(points, judged, strict=True):
            if numbers is None:
                continue
            loss = float(np.sum(self.deviations_of(numbers) ** 2))
            if math.isfinite(loss):
                self.points.append(point)
                self.numbers.append(np.asarray(numbers))
                self.losses.append(loss)

    @property
    def least(self) -> float:
        return min(self.losses, default=math.inf)

    @property
    def best(self) -> int:
        return int(np.argmin(self.losses))

    def minimum_near(self, center: np.ndarray, radius: float) -> np.ndarray:
        """Return the point within ``radius`` at which the linear model's loss is least."""
        away = np.array(self.points) - center
        numbers = np.array(self.numbers)
        distance2, size = np.sum(away**2, axis=1), center.size
        nearest = np.sort(distance2)[min(len(away) - 1, int(2.2 * size))]
        spread = max(nearest, 0.2 * size * radius**2)
        weighted = away * np.exp(-0.5 * distance2 / spread)[:, None]
        closest = int(np.argmin(distance2))
        ridge = _RIDGE * spread / size * np.exp(-0.5 * distance2 / spread).sum()
        slopes = np.linalg.solve(
            weighted.T @ away + ridge * np.eye(size), weighted.T @ (numbers - numbers[closest])
        )

        def residuals(point: np.ndarray) -> np.ndarray:
            step = point - center
            deviations = self.deviations_of((numbers[closest] + step @ slopes).tolist())
            return np.concatenate([deviations, _DAMPING * step / radius])

        low, high = np.maximum(center - radius, 0.0), np.minimum(center + radius, 1.0)
        inside = np.clip(center, low + 1e-9, high - 1e-9)
        fit = least_squares(residuals, inside, bounds=(low, high), diff_step=1e-3, max_nfev=12)
        return fit.x


def search(
    judge: Callable[[np.ndarray], list[float] | None],
    deviations_of: Callable[[Sequence[float]], np.ndarray],
    start: np.ndarray,
    *,
    step: float,
    generations: int,
    seed: int,
    workers: int,
    checkpoint: Path | str,
    key: str,
    seconds: float = np.inf,
    progress: Callable[[int, int, float, float], None] = lambda done, total, best, elapsed: None,
) -> SearchResult:
    """Minimise the sum of squares of ``deviations_of(judge(point))`` over the unit cube.

    The points are a function of the seed and of what was judged, so the checkpoint holds only the
    judgements of each generation; a resumed search replays them.

    Parameters
    ----------
    judge : callable
        Picklable; takes a point and returns its numbers, or None if it is impossible.
    start : ndarray of shape (n_parameters,)
        First point to judge.
    step : float
        Standard deviation of the first points around the start, as a share of the cube's edge.
        There are twice as many of them as the cube has dimensions.
    checkpoint : path
        See ``artifacts.resuming``; the head is ``key`` with ``start``, ``step`` and ``seed``, the
        entries are the judgements of each generation. A file with another head is kept.
    key : str
        Hash of everything that the judgements depend on.
    seconds : float
        No generation but the first starts after this time, s.
    progress : callable
        Called after each generation with the generations done and planned, the
        least loss, and the time, s.
    """
    start = np.asarray(start, dtype=float)
    head = {"key": key, "start": start.tolist(), "step": step, "seed": seed}
    archive, rng, radius = _Archive(deviations_of), np.random.default_rng(seed), _RADIUS
    first = -(-2 * start.size // _POPULATION)
    begin_s, done, judged = time.monotonic(), 0, 0
    with (
        resuming(checkpoint, head, keep=True) as (known, append),
        parallel_config("loky", inner_max_num_threads=1),
        Parallel(n_jobs=workers) as pool,
    ):
        while done < generations and (
            done < max(len(known), 1) or time.monotonic() - begin_s < seconds
        ):
            if done < first or not archive.points:
                points = list(start + step * rng.standard_normal((_POPULATION, start.size)))
                if done == 0:
                    points[0] = start
            else:
                points = _proposed(archive, radius, rng)
            points = [np.clip(point, 0.0, 1.0) for point in points]
            before = archive.least
            if done < len(known):
                archive.add(points, known[done])
            else:
                new = pool(delayed(judge)(point) for point in points)
                archive.add(points, new)
                append(new)
                progress(done + 1, generations, archive.least, time.monotonic() - begin_s)
            if done >= first:
                better = archive.least < 0.999 * before
                radius = min(max(radius * (_GROW if better else _SHRINK), _LEAST), _MOST)
            done += 1
            judged += len(points)
    best = archive.points[archive.best] if archive.points else start
    return SearchResult(best, archive.least, done, judged, done >= generations, archive.numbers)


def _proposed(archive: _Archive, radius: float, rng: np.random.Generator) -> list[np.ndarray]:
    best = archive.points[archive.best]
    points = [archive.minimum_near(best, reach * radius) for reach in _REACH]
    runner_up = archive.points[int(rng.choice(np.argsort(archive.losses)[:6]))]
    points.append(archive.minimum_near(runner_up, radius))
    around = [(points[1], 0.25), (points[1], 0.5), (best, 0.5), (best, 1.0)]
    return points + [
        center + share * radius * rng.standard_normal(best.size) for center, share in around
    ]
