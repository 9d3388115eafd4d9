"""Search in the unit cube with a linear model of everything that was measured.

Judging a point yields many numbers, and the loss is a known function of them. Near a point the
numbers are almost linear in it; the loss, with its limits and squares, is not. Each round of the
search therefore measures how all numbers change along each parameter, minimises the loss over this
linear model within several distances, judges the points that this gives, goes on from the best of
them, and corrects the model by what they showed: the method of Gauss and Newton, with Broyden's
update. The numbers have more than one valley, so a search may begin at several points; before each
round it leaves the worse half of them. What judges is cheap and not exact: where a round begins,
an exact judge corrects it. It resumes from a checkpoint after a kill.
"""

import logging
import math
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from joblib import Parallel, delayed, parallel_config
from scipy.optimize import least_squares

from fprc.artifacts import resuming

log = logging.getLogger(__name__)

#: Steps of the finite differences, in units of the cube's edge: the first one, the least and the
#: largest, and by how much the numbers should change (norm). A longer step sees the curvature, a
#: shorter one the noise.
_STEP, _FINEST, _COARSEST, _CHANGE = 0.03, 0.01, 0.06, 0.1

#: Most steps of a round, how many in turn may lower the loss by less than a share of it, because
#: the slopes are worn out by then, and the distances that each tries, as multiples of the radius.
_STEPS, _FAILED, _GAIN, _REACH = 6, 2, 0.02, (0.2, 0.6, 1.5)

#: Radius with which a round begins, and limits of every radius, in units of the cube; the
#: factor after a step that found nothing better.
_RADIUS, _LEAST, _MOST, _SHRINK = 0.15, 0.01, 0.4, 0.4

#: Weight of the step's length beside the deviations, and share of a correction that the model takes
#: over: numbers of one pair of points are noisy.
_DAMPING, _CORRECTED = 0.3, 0.7

#: Where the solver of a step begins, as the least distance from a bound in shares of the range, and
#: the most steps that it takes.
_INSET, _SOLVED = 0.05, 15

#: So many rounds in turn that lower the loss by a smaller share are the last.
_IDLE, _WORTH = 2, 0.01


class SearchResult(NamedTuple):
    """Result of a search."""

    point: np.ndarray  #: the best point
    loss: float  #: infinite if every start was impossible
    ends: list[np.ndarray]  #: where those of the last round ended, the best first
    rounds: int  #: those that were begun
    evaluations: int


class _Here(NamedTuple):
    """A point that was judged."""

    point: np.ndarray
    numbers: np.ndarray  #: corrected
    loss: float
    correction: np.ndarray  #: what was added to the numbers
    slopes: np.ndarray | None = None  #: as the steps that led here had corrected them


def search(
    judge: Callable[[np.ndarray, np.ndarray], list[float] | None],
    correct: Callable[[Sequence[np.ndarray]], list[list[list[float]] | None]],
    deviations_of: Callable[[Sequence[float]], np.ndarray],
    starts: np.ndarray,
    *,
    rounds: int,
    workers: int,
    checkpoint: Path | str,
    key: str,
) -> SearchResult:
    """Minimise the sum of squares of ``deviations_of`` over the unit cube.

    The points are a function of what was judged, so the checkpoint holds only the judgements; a
    resumed search replays them.

    Parameters
    ----------
    judge : callable
        Picklable; takes a point, and the point where its round begins, and returns the numbers of
        the first; None if it is impossible.
    correct : callable
        Takes points, and returns for each its numbers, and what is to be added to the numbers of
        all points that are judged in the round that begins there; None if it is impossible.
    starts : ndarray of shape (n_starts, n_parameters)
        The search begins at each of them. Each round goes on from the better half of those of the
        round before.
    rounds : int
        Those of the start that is best. A round judges a point for each parameter, and then up to
        18 more.
    checkpoint : path
        See ``artifacts.resuming``; the head is ``key`` with ``starts`` and ``rounds``, the entries
        are the judgements of points that were judged together, and the corrections of a round. A
        file with another head is kept.
    key : str
        Hash of everything that the judgements depend on.
    """
    head = {"key": key, "starts": np.asarray(starts).tolist(), "rounds": rounds}
    evaluations = begun = 0
    best = _Here(starts[0], np.empty(0), math.inf, np.empty(0))
    with (
        resuming(checkpoint, head, keep=True) as (known, append),
        parallel_config("loky", inner_max_num_threads=1),
        Parallel(n_jobs=workers) as pool,
    ):
        replayed = iter(known)

        def found_by(judging: Callable[[], list[Any]], count: int) -> list[Any]:
            nonlocal evaluations
            found = next(replayed, None)
            if found is None:
                found = judging()
                append(found)
            evaluations += count
            return found

        def here_of(point: np.ndarray, numbers: list[float], correction: np.ndarray) -> _Here:
            exact = np.asarray(numbers) + correction
            loss = float(np.sum(deviations_of(exact.tolist()) ** 2))
            return _Here(point, exact, loss, correction)

        def corrected(points: Sequence[_Here]) -> list[_Here]:
            if not points:
                return []
            found = found_by(lambda: correct([here.point for here in points]), len(points))
            return [
                here_of(here.point, pair[0], np.asarray(pair[1]))._replace(slopes=here.slopes)
                for here, pair in zip(points, found, strict=True)
                if pair
            ]

        def judged(points: Sequence[np.ndarray], begin: _Here) -> list[_Here | None]:
            found = found_by(
                lambda: pool(delayed(judge)(point, begin.point) for point in points), len(points)
            )
            return [
                numbers and here_of(point, numbers, begin.correction)
                for point, numbers in zip(points, found, strict=True)
            ]

        def solved(radii: Sequence[float], here: _Here, slopes: np.ndarray) -> list[np.ndarray]:
            least = delayed(_least_within)
            return list(pool(least(radius, here, slopes, deviations_of) for radius in radii))

        points = ended = [best._replace(point=start) for start in starts]
        idle = 0
        planned = [math.ceil(len(starts) / 2**round_) for round_ in range(rounds)]
        for count in planned:
            points, ended, before = sorted(corrected(ended), key=_loss)[:count], [], best.loss
            best = lowest = min([best, *points], key=_loss)
            # by the exact judge: one round often gains what the next one's correction takes
            idle = 0 if count > 1 or best.loss < (1.0 - _WORTH) * before else idle + 1
            if idle == _IDLE:
                break
            for here in points:
                begun += 1
                for after in _steps(here, judged, solved):
                    lowest = min(lowest, after, key=_loss)
                    log.info("round %d of %d, least loss %.4f", begun, sum(planned), lowest.loss)
                ended.append(after)
        else:
            points = sorted(corrected(ended), key=_loss)
            best = min([best, *points], key=_loss)
    ends = [here.point for here in points]
    return SearchResult(best.point, best.loss, ends, begun, evaluations)


def _steps(
    begin: _Here,
    judged: Callable[[Sequence[np.ndarray], _Here], list[_Here | None]],
    solved: Callable[[Sequence[float], _Here, np.ndarray], list[np.ndarray]],
) -> Iterator[_Here]:
    """Yield the best point after each step of a round."""
    slopes, near = _slopes(begin, judged)
    here, radius, failed = min(begin, *near, key=_loss), _RADIUS, 0
    for _ in range(_STEPS):
        radii = [min(share * radius, _MOST) for share in _REACH]
        found = judged(solved(radii, here, slopes), begin)
        tried = [(new, r) for new, r in zip(found, radii, strict=True) if new]
        for new, _ in sorted(tried, key=lambda pair: -pair[0].loss):
            slopes = _corrected(slopes, here, new)
        best, reached = min(tried, key=lambda pair: pair[0].loss, default=(here, 0.0))
        failed = 0 if best.loss < (1.0 - _GAIN) * here.loss else failed + 1
        if best.loss < here.loss:
            here, radius = best, reached
        else:
            radius *= _SHRINK
        radius = max(radius, _LEAST)
        yield here._replace(slopes=slopes)
        if failed == _FAILED:
            break


def _loss(judged: _Here) -> float:
    return judged.loss


def _slopes(
    here: _Here, judged: Callable[[Sequence[np.ndarray], _Here], list[_Here | None]]
) -> tuple[np.ndarray, list[_Here]]:
    """Return how the numbers change along each parameter, and the neighbours that show it.

    The slopes have the shape (n_numbers, n_parameters). A parameter whose neighbour is impossible
    has the slope 0. Where slopes are known from the round before, they say how far the neighbours
    are.
    """
    lengths = np.full(len(here.point), _STEP)
    if here.slopes is not None:
        changes = np.linalg.norm(here.slopes, axis=0)
        lengths = np.clip(_CHANGE / np.maximum(changes, 1e-9), _FINEST, _COARSEST)
    steps = np.where(here.point + lengths <= 1.0, lengths, -lengths)
    points = [
        here.point + step * axis for step, axis in zip(steps, np.eye(len(steps)), strict=True)
    ]
    neighbours = judged(points, here)
    slopes = np.column_stack([
        np.zeros(len(here.numbers)) if near is None else (near.numbers - here.numbers) / step
        for near, step in zip(neighbours, steps, strict=True)
    ])  # fmt: skip
    return slopes, [near for near in neighbours if near]


def _corrected(slopes: np.ndarray, here: _Here, new: _Here) -> np.ndarray:
    """Return the slopes that explain more of what was found at a new point (Broyden)."""
    step = new.point - here.point
    if not step.any():
        return slopes
    unexplained = new.numbers - here.numbers - slopes @ step
    return slopes + _CORRECTED * np.outer(unexplained, step) / (step @ step)


def _least_within(
    radius: float,
    here: _Here,
    slopes: np.ndarray,
    deviations_of: Callable[[Sequence[float]], np.ndarray],
) -> np.ndarray:
    """Return the point within ``radius`` at which the linear model's loss is least.

    A parameter that moves the numbers more than most has a smaller radius in proportion, because
    what it does is far from linear sooner.
    """
    effects = np.linalg.norm(slopes, axis=0)
    radii = radius / np.maximum(effects / max(float(np.median(effects)), 1e-9), 1.0)

    def residuals(share: np.ndarray) -> np.ndarray:
        deviations = deviations_of((here.numbers + slopes @ (radii * share)).tolist())
        return np.concatenate([deviations, _DAMPING * share])

    low, high = np.maximum(-1.0, -here.point / radii), np.minimum(1.0, (1.0 - here.point) / radii)
    # a start close to a bound costs the solver most of its steps
    inset = _INSET * (high - low)
    begin = np.clip(np.zeros(len(low)), low + inset, high - inset)
    fit = least_squares(residuals, begin, bounds=(low, high), diff_step=1e-3, max_nfev=_SOLVED)
    return np.clip(here.point + radii * fit.x, 0.0, 1.0)
