"""Rounds of a search in the unit cube with a linear model of everything that was measured.

Near a point the numbers of a rig are almost linear in it; the loss, with its limits and squares, is
not. A round measures how all numbers change along each parameter, minimises the loss over this
linear model within several distances, judges the points that this gives, goes on from the best of
them, and corrects the model by what they showed: the method of Gauss and Newton, with Broyden's
update.
"""

import math
from collections.abc import Callable, Sequence
from typing import NamedTuple

import numpy as np
from scipy.optimize import least_squares

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

Misses = Callable[[np.ndarray], np.ndarray]


class _Judged(NamedTuple):
    point: np.ndarray
    numbers: np.ndarray
    loss: float


def search_round(
    numbers_at: Callable[[Sequence[np.ndarray]], Sequence[np.ndarray | None]],
    misses_of: Misses,
    start: np.ndarray,
) -> tuple[float, np.ndarray]:
    """Lower the sum of squares of ``misses_of`` over the unit cube by one round from a point.

    ``numbers_at`` gives None for an impossible point. Return the loss and the point of the best;
    infinity and the start if that is impossible.
    """

    def judged(points: Sequence[np.ndarray]) -> list[_Judged | None]:
        return [
            None if found is None else _Judged(at, found, float(np.sum(misses_of(found) ** 2)))
            for at, found in zip(points, numbers_at(points), strict=True)
        ]

    (begin,) = judged([start])
    if begin is None:
        return math.inf, start
    steps = np.where(start + _STEP <= 1.0, _STEP, -_STEP)
    neighbours = judged(list(start + np.diag(steps)))
    # a parameter whose neighbour is impossible has no effect
    slopes = np.zeros((len(begin.numbers), len(start)))
    for k, near in enumerate(neighbours):
        if near:
            slopes[:, k] = (near.numbers - begin.numbers) / steps[k]
    here = min([begin, *filter(None, neighbours)], key=lambda found: found.loss)
    radius, failed = _RADIUS, 0
    for _ in range(_STEPS):
        radii = [min(share * radius, _MOST) for share in _REACH]
        found = judged([_least_within(reach, here, slopes, misses_of) for reach in radii])
        tried = [(new, reach) for new, reach in zip(found, radii, strict=True) if new]
        for new, _ in sorted(tried, key=lambda pair: -pair[0].loss):
            if (step := new.point - here.point).any():  # Broyden
                unexplained = new.numbers - here.numbers - slopes @ step
                slopes = slopes + _CORRECTED * np.outer(unexplained, step) / (step @ step)
        best, reached = min(tried, key=lambda pair: pair[0].loss, default=(here, 0.0))
        failed = 0 if best.loss < (1.0 - _GAIN) * here.loss else failed + 1
        better = best.loss < here.loss
        here, radius = (best, reached) if better else (here, radius * _SHRINK)
        radius = max(radius, _LEAST)
        if failed == _FAILED:
            break
    return here.loss, here.point


def _least_within(
    radius: float, here: _Judged, slopes: np.ndarray, misses_of: Misses
) -> np.ndarray:
    """Return the point within ``radius`` at which the linear model's loss is least.

    A parameter that moves the numbers more than most has a smaller radius in proportion, because
    what it does is far from linear sooner.
    """
    effects = np.linalg.norm(slopes, axis=0)
    radii = radius / np.maximum(effects / max(float(np.median(effects)), 1e-9), 1.0)

    def residuals(share: np.ndarray) -> np.ndarray:
        missed = misses_of(here.numbers + slopes @ (radii * share))
        return np.concatenate([missed, _DAMPING * share])

    low = np.maximum(-1.0, -here.point / radii)
    high = np.minimum(1.0, (1.0 - here.point) / radii)
    # a start close to a bound costs the solver most of its steps
    inset = 0.05 * (high - low)
    begin = np.clip(0.0, low + inset, high - inset)
    fit = least_squares(residuals, begin, bounds=(low, high), diff_step=1e-3, max_nfev=15)
    return np.clip(here.point + radii * fit.x, 0.0, 1.0)
