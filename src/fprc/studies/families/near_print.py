"""Rigs near print: rigs drawn at random, moved until their errors are near the printed ones.

An ensemble smoother with multiple data assimilation (Emerick and Reynolds, Computers & Geosciences
55, 2013) moves drawn rigs towards the errors, and sweeps of an ensemble sampler refine them: the
logarithms of a rig's errors deviate from the printed ones by a normal error. Each rig is simulated
once, with its own noise, as the paper's rig was recorded once. The deviation still falls when the
sweeps end, so the rigs are no draws from a posterior.
"""

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from typing import Any

import emcee
import numpy as np
from scipy.special import ndtr, ndtri

from fprc.config.rig import Rig
from fprc.errors import EvaluationError, FprcError, in_one_line
from fprc.experiments.settings import RigSettings
from fprc.studies.calibration.space import Free, decode
from fprc.studies.calibration.surrogate import judge_by_surrogate
from fprc.studies.families.family import draw_rig, is_plausible

#: Takes points of shape (n, parameters); returns the logarithms of the errors of each, or None
#: where the rig is impossible or implausible.
Simulate = Callable[[np.ndarray], Sequence[Sequence[float] | None]]

#: Second seed of the smoother's random numbers.
_SMOOTHER = 20242

#: Shares of a range are kept this far from its ends, where normal scores are infinite.
_EDGE = 1e-3

#: Proposals of the sampler: steps along the difference of two other rigs, short ones that are often
#: accepted and longer ones. Not DESnookerMove, whose draws are too narrow in emcee 3.1.6.
_MOVES = [
    (emcee.moves.DEMove(gamma0=0.08, sigma=0.5), 0.7),
    (emcee.moves.DEMove(gamma0=0.25), 0.3),
]


def move_near(
    prior: np.ndarray,
    simulate: Simulate,
    target: np.ndarray,
    *,
    tolerance: float,
    assimilations: int,
    sweeps: int,
    seed: int,
) -> np.ndarray:
    """Return points of a standard normal prior, moved near a target.

    Parameters
    ----------
    prior : ndarray of shape (n, parameters)
    target : ndarray of shape (errors,)
        Logarithms of the printed errors.
    tolerance : float
        Standard deviation of the deviation from ``target``.

    Raises
    ------
    EvaluationError
        Fewer points are possible than the sampler (two for each parameter) or the smoother
        (three) needs.
    """
    rng = np.random.default_rng([seed, _SMOOTHER])
    # the sampler steps along differences of points, which must span the space
    least = 2 * prior.shape[1] if sweeps else 3
    points, logs = _judged(prior, simulate, least)
    for _ in range(assimilations):
        moved = assimilate(points, logs, target, tolerance, assimilations, rng)
        points, logs = _judged(moved, simulate, least)
    if not sweeps:
        return points

    def log_probabilities(
        points: np.ndarray, logs: Sequence[Sequence[float] | None] | np.ndarray
    ) -> np.ndarray:
        return np.array([
            -np.inf if row is None
            else -0.5 * (np.sum(((row - target) / tolerance) ** 2) + np.sum(point**2))
            for point, row in zip(points, logs, strict=True)
        ])  # fmt: skip

    sampler = emcee.EnsembleSampler(
        *points.shape,
        lambda batch: log_probabilities(batch, simulate(batch)),
        moves=_MOVES,
        vectorize=True,
    )
    random = np.random.RandomState(seed).get_state()
    start = emcee.State(points, log_prob=log_probabilities(points, logs), random_state=random)
    return np.asarray(sampler.run_mcmc(start, sweeps).coords)


def assimilate(
    points: np.ndarray,
    logs: np.ndarray,
    target: np.ndarray,
    tolerance: float,
    assimilations: int,
    rng: np.random.Generator,
) -> np.ndarray:
    """Move points towards the target by one of several equal assimilations.

    The likelihood's variance is multiplied by the number of assimilations. After all of them the
    points deviate from the target by ``tolerance`` if ``logs`` are linear in them.

    Parameters
    ----------
    points, logs : ndarray of shape (n, parameters), (n, errors)
    """
    noise = tolerance * np.sqrt(assimilations)
    off = (points - points.mean(axis=0)) / (len(points) - 1)
    spread = logs - logs.mean(axis=0)
    innovation = target + noise * rng.standard_normal(logs.shape) - logs
    covariance = spread.T @ spread / (len(points) - 1) + noise**2 * np.eye(len(target))
    return np.asarray(points + np.linalg.solve(covariance, innovation.T).T @ (off.T @ spread).T)


def draw_member(
    cell: Mapping[str, int], drawn: Mapping[str, Any], free: Sequence[Free], on_rig: RigSettings
) -> dict[str, list[float]]:
    """Draw a rig at random by the seed ``draw`` and return the normal scores of its parameters."""
    _, shares = draw_rig(cell["draw"], drawn, free, on_rig)
    return {"point": ndtri(np.clip(shares, _EDGE, 1.0 - _EDGE)).tolist()}


def rig_at(point: Sequence[float], free: Sequence[Free], on_rig: RigSettings) -> RigSettings:
    """Return the settings with the rig whose parameters have these normal scores."""
    return replace(on_rig, rig=decode(ndtr(point), on_rig.rig, free))


def judge_member(
    cell: Mapping[str, Any],
    *,
    drawn: Mapping[str, Any],
    free: Sequence[Free],
    on_rig: RigSettings,
    models: Mapping[str, Any],
    surrogate: Mapping[str, int],
    ratios: Mapping[str, float],
) -> dict[str, Any]:
    """Return the logarithms of a rig's errors by the surrogate models, or why there are none.

    Parameters
    ----------
    cell : Mapping
        ``point``, normal scores of the parameters, and the ``seed`` of the noise.
    ratios : Mapping
        Ratios of the full models' errors to the surrogate's.
    """
    try:
        moved = rig_at(cell["point"], free, on_rig)
        Rig.model_validate(moved.rig)
        judged = judge_by_surrogate(moved, cell["seed"], models, surrogate, {}, {})
        logs = [math.log(ratio * judged["errors"][key]) for key, ratio in ratios.items()]
    except (FprcError, ValueError) as error:  # ValueError: from pydantic, or log(0)
        return {"impossible": in_one_line(error)}
    if not np.isfinite(logs).all():
        return {"impossible": "an error is not finite"}
    if not is_plausible(judged["properties"], drawn):
        return {"impossible": "its angle or its swing of P_o is implausible"}
    return {"logs": logs}


def _judged(points: np.ndarray, simulate: Simulate, least: int) -> tuple[np.ndarray, np.ndarray]:
    logs = simulate(points)
    kept = [i for i, row in enumerate(logs) if row is not None]
    if len(kept) < least:
        raise EvaluationError(
            f"{len(kept)} of {len(points)} rigs are possible and plausible, and {least} are "
            "needed; draw more rigs (near_print.rigs), or widen drawn.angle_deg or "
            "drawn.p_o_swing_kpa"
        )
    return points[kept], np.array([logs[i] for i in kept], dtype=float)
