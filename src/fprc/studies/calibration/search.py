"""Search in the unit cube with a linear model of everything that was measured.

Near a point the numbers of a rig are almost linear in it; the loss, with its limits and squares, is
not. Each round measures how all numbers change along each parameter, minimises the loss over this
linear model within several distances, judges the points that this gives, goes on from the best of
them, and corrects the model by what they showed: the method of Gauss and Newton, with Broyden's
update. What judges is cheap and not exact: where a round begins, an exact judge corrects it.
"""

import logging
import math
from collections.abc import Callable, Iterator, Sequence
from typing import NamedTuple

import numpy as np
from scipy.optimize import least_squares

log = logging.getLogger(__name__)

#: Step of the finite differences, in units of the cube's edge.
_STEP = 0.03

#: Most steps of a round, how many in turn may lower the loss by less than a share of it, because
#: the slopes are worn out by then, and the distances that each tries, as multiples of the radius.
_STEPS, _FAILED, _GAIN, _REACH = 6, 2, 0.02, (0.2, 0.6, 1.5)

#: Radius with which a round begins, and limits of every radius, in units of the cube; the
#: factor after a step that found nothing better.
_RADIUS, _LEAST, _MOST, _SHRINK = 0.15, 0.01, 0.4, 0.4

#: Weight of the step's length beside the misses, and share of a correction that the model takes
#: over: numbers of one pair of points are noisy.
_DAMPING, _CORRECTED = 0.3, 0.7

#: Numbers of points, None for those that are impossible; all are judged beside the second point.
Judge = Callable[[Sequence[np.ndarray], np.ndarray], Sequence[np.ndarray | None]]


class Found(NamedTuple):
    """A point that was judged."""

    point: np.ndarray
    numbers: np.ndarray  #: corrected
    loss: float


def search(
    judge: Judge,
    correction_at: Callable[[np.ndarray], np.ndarray],
    misses_of: Callable[[np.ndarray], np.ndarray],
    start: np.ndarray,
    rounds: int,
) -> Found:
    """Minimise the sum of squares of ``misses_of`` over the unit cube, from one point.

    Parameters
    ----------
    judge : callable
        Cheap; see ``Judge``.
    correction_at : callable
        Takes a point where a round begins, or the search ends, and returns what is to be added to
        the numbers of all points of that round.
    """
    best = Found(start, np.empty(0), math.inf)
    point = start
    for number in range(rounds + 1):
        added = correction_at(point)

        def judged(
            points: Sequence[np.ndarray],
            begin: np.ndarray = point,
            added: np.ndarray = added,
        ) -> list[Found | None]:
            found = []
            for at, numbers in zip(points, judge(points, begin), strict=True):
                exact = None if numbers is None else numbers + added
                loss = math.inf if exact is None else float(np.sum(misses_of(exact) ** 2))
                found.append(None if exact is None else Found(at, exact, loss))
            return found

        (here,) = judged([point])
        if here is None:
            break
        best = min(best, here, key=_loss)
        if number == rounds:
            break
        for after in _steps(here, judged, misses_of):
            log.info("round %d of %d, misfit %.0f", number + 1, rounds, after.loss)
            point = after.point
    return best


#: As ``Judge``, with the correction of the round.
_Judged = Callable[[Sequence[np.ndarray]], list[Found | None]]

_Misses = Callable[[np.ndarray], np.ndarray]


def _steps(begin: Found, judged: _Judged, misses_of: _Misses) -> Iterator[Found]:
    """Yield the best point after each step of a round."""
    slopes, near = _slopes(begin, judged)
    here, radius, failed = min([begin, *near], key=_loss), _RADIUS, 0
    for _ in range(_STEPS):
        radii = [min(share * radius, _MOST) for share in _REACH]
        found = judged([_least_within(radius, here, slopes, misses_of) for radius in radii])
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
        yield here
        if failed == _FAILED:
            break


def _loss(judged: Found) -> float:
    return judged.loss


def _slopes(here: Found, judged: _Judged) -> tuple[np.ndarray, list[Found]]:
    """Return how the numbers change along each parameter, and the neighbours that show it.

    The slopes have the shape (n_numbers, n_parameters). A parameter whose neighbour is impossible
    has the slope 0.
    """
    steps = np.where(here.point + _STEP <= 1.0, _STEP, -_STEP)
    neighbours = judged(list(here.point + np.diag(steps)))
    slopes = np.column_stack([
        np.zeros(len(here.numbers)) if near is None else (near.numbers - here.numbers) / step
        for near, step in zip(neighbours, steps, strict=True)
    ])  # fmt: skip
    return slopes, [near for near in neighbours if near]


def _corrected(slopes: np.ndarray, here: Found, new: Found) -> np.ndarray:
    """Return the slopes that explain more of what was found at a new point (Broyden)."""
    step = new.point - here.point
    if not step.any():
        return slopes
    unexplained = new.numbers - here.numbers - slopes @ step
    return slopes + _CORRECTED * np.outer(unexplained, step) / (step @ step)


def _least_within(radius: float, here: Found, slopes: np.ndarray, misses_of: _Misses) -> np.ndarray:
    """Return the point within ``radius`` at which the linear model's loss is least.

    A parameter that moves the numbers more than most has a smaller radius in proportion, because
    what it does is far from linear sooner.
    """
    effects = np.linalg.norm(slopes, axis=0)
    radii = radius / np.maximum(effects / max(float(np.median(effects)), 1e-9), 1.0)

    def residuals(share: np.ndarray) -> np.ndarray:
        return np.concatenate(
            [misses_of(here.numbers + slopes @ (radii * share)), _DAMPING * share]
        )

    low, high = (
        np.maximum(-1.0, -here.point / radii),
        np.minimum(1.0, (1.0 - here.point) / radii),
    )
    # a start close to a bound costs the solver most of its steps
    inset = 0.05 * (high - low)
    begin = np.clip(np.zeros(len(low)), low + inset, high - inset)
    fit = least_squares(residuals, begin, bounds=(low, high), diff_step=1e-3, max_nfev=15)
    return np.clip(here.point + radii * fit.x, 0.0, 1.0)
