"""What a rig is fitted to: published errors, orders of the models, plausible properties."""

import math
from collections.abc import Mapping, Sequence
from typing import NamedTuple

import numpy as np

from fprc.signals import loop_growth, width_at_middle

Channels = Mapping[str, np.ndarray]


class Aim(NamedTuple):
    """What the search aims at.

    ``errors`` are the published RMSEs by "trained on/model/phase"; ``ranges``
    what each of the rig's ``properties`` should lie in; ``margin`` by what part
    FPRC's test error should be below the others' on every seed, and ``ratio``
    how far the training errors of ESN and FPRC may be apart.
    """

    errors: Mapping[str, float]
    ranges: Mapping[str, tuple[float, float]]
    margin: float
    ratio: float


def properties(logs: Mapping[str, Channels]) -> dict[str, float]:
    """Return what is known of the rig's loops beside the errors of models.

    Returns
    -------
    dict
        ``angle_deg`` largest angle of the sweep; ``loop_kpa`` full width of its
        P_exp over theta at mid-angle; ``loop_growth`` and ``p_o_loop_growth``
        by what factor the loops widen from the first to the last quarter of
        the sweep; ``p_o_swing_kpa``; ``p_o_loop`` width over swing.
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
    """Return the relative deviation of each mean error from print, one mapping a seed."""
    return {
        key: float(np.mean([seed[key] for seed in errors]) / printed - 1.0)
        for key, printed in target.errors.items()
    }


def loss_of(
    errors: Sequence[Mapping[str, float]],
    found: Sequence[Mapping[str, float]],
    target: Aim,
) -> float:
    """Return what the search minimises.

    The mean square of log(ours / print) over the published errors (means over
    seeds), plus the mean square by which the orders miss their margin on each
    seed, plus the mean square of the logarithm by which each property's mean
    lies outside its range.

    Parameters
    ----------
    errors, found : sequences of mapping
        Errors of the models and properties of the rig, one entry a seed.
    """
    deviations = [math.log1p(value) for value in residuals(errors, target).values()]
    misses = [miss for seed in errors for miss in _order_misses(seed, target)]
    outside = [
        _outside(float(np.mean([seed[name] for seed in found])), *limits)
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
