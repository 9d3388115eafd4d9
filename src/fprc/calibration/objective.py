"""Objective of the fit: published errors, order of the models, plausible properties."""

import math
from collections.abc import Mapping, Sequence
from typing import NamedTuple

import numpy as np

from fprc.signals import loop_growth, width_at_middle

Channels = Mapping[str, np.ndarray]


class Aim(NamedTuple):
    """Targets of the search.

    ``errors`` are the published RMSEs by "trained on/model/phase"; ``ranges``
    are those of the rig's ``properties``; ``margin`` is the fraction by which
    FPRC's test error should be below the others' on every seed; ``ratio`` is the
    largest ratio of the ESN's and FPRC's training errors, either way round.
    """

    errors: Mapping[str, float]
    ranges: Mapping[str, tuple[float, float]]
    margin: float
    ratio: float


def properties(logs: Mapping[str, Channels]) -> dict[str, float]:
    """Return properties of the rig's loops in the sweep.

    Returns
    -------
    dict
        ``angle_deg`` largest angle; ``loop_kpa`` full width of the loop of P_exp
        over theta at mid-angle; ``loop_growth`` and ``p_o_loop_growth`` factors
        by which the loops widen from the first to the last quarter;
        ``p_o_swing_kpa``; ``p_o_loop`` width of P_o's loop over its swing.
    """
    log = logs["sweep"]
    time_s, theta, p_exp, p_o = (
        log[name] for name in ("time_s", "theta_deg", "p_target_kpa", "p_o_kpa")
    )
    swing = float(np.ptp(p_o))
    return {
        "angle_deg": float(theta.max()),
        "loop_kpa": width_at_middle(theta, p_exp),
        "loop_growth": loop_growth(time_s, theta, p_exp),
        "p_o_swing_kpa": swing,
        "p_o_loop": width_at_middle(theta, p_o) / swing,
        "p_o_loop_growth": loop_growth(time_s, theta, p_o),
    }


def residuals(errors: Sequence[Mapping[str, float]], target: Aim) -> dict[str, float]:
    """Return the relative deviation of each error, averaged over seeds, from the printed one."""
    return {
        key: float(np.mean([seed[key] for seed in errors]) / printed - 1.0)
        for key, printed in target.errors.items()
    }


def loss_of(
    errors: Sequence[Mapping[str, float]],
    measured: Sequence[Mapping[str, float]],
    target: Aim,
) -> float:
    """Return the loss that the search minimises.

    It is the sum of three mean squares: of log(ours / printed) over the published
    errors (means over seeds), of the logarithms by which the orders miss their
    margins on each seed, and of those by which each property's mean over seeds
    lies outside its range.

    Parameters
    ----------
    errors, measured : sequences of mapping
        Errors of the models and properties of the rig, one entry per seed.
    """
    deviations = [math.log1p(value) for value in residuals(errors, target).values()]
    misses = [miss for seed in errors for miss in _order_misses(seed, target)]
    outside = [
        _outside(float(np.mean([seed[name] for seed in measured])), *limits)
        for name, limits in target.ranges.items()
    ]
    return _mean_square(deviations) + _mean_square(misses) + _mean_square(outside)


def _order_misses(errors: Mapping[str, float], target: Aim) -> list[float]:
    misses = []
    for trained_on in ("sweep", "complex"):
        others = min(errors[f"{trained_on}/{model}/test"] for model in ("esn", "fuzzy_linear"))
        ratio = errors[f"{trained_on}/fprc/test"] * (1.0 + target.margin) / others
        misses.append(max(math.log(ratio), 0.0))
    apart = abs(math.log(errors["sweep/esn/train"] / errors["sweep/fprc/train"]))
    misses.append(max(apart - math.log(target.ratio), 0.0))
    return misses


def _outside(value: float, low: float, high: float) -> float:
    if not value > 0.0:
        return 3.0
    return max(math.log(low / value), math.log(value / high), 0.0)


def _mean_square(values: Sequence[float]) -> float:
    return float(np.mean(np.square(values))) if values else 0.0
