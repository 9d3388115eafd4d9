"""What a fit asks of a rig: logarithms of numbers, each with a range and a tolerance.

The numbers of a judged rig are in groups, see ``surrogate``.
"""

import math
from collections.abc import Iterator, Mapping, Sequence
from itertools import pairwise
from typing import Any, NamedTuple

import numpy as np

from fprc.paper import MODELS, PRINTED, REFERENCES
from fprc.signals import loop_width, measure_hysteresis

#: Tolerances of the logarithms of ratios that a claim limits, and of what feedback leaves.
_RATIO, _HELP = 0.05, 0.06

#: Deviations of printed errors and of the open loop from which on they count more, as shares, and
#: their tolerance there: a fit that is to be a default has none above 15 % (``fit.LIMITS``).
_FAR, _MORE = 0.12, 0.01

#: Values of epsilon in Fig. 10, falling.
EPSILONS = (1.0, 0.1, 0.01, 1e-3, 1e-4)

#: Margin to the limit of a ratio, as a logarithm: about what it varies by between seeds.
_MARGIN = 0.03

#: Most that feedback may leave of the open-loop error, at the printed gains and at 1.5 times them.
_LEFT = {"closed_loop": ("closed_loop", 0.8), "margin": ("firm_loop", 0.95)}

#: Plausible ranges of a rig's ``properties``, and their tolerances as logarithms.
PLAUSIBLE = {
    "angle_deg": (57.0, 63.0, 0.04),  # paper: about 60 deg
    "loop_kpa": (45.0, 75.0, 0.1),  # Fuzzy-linear's printed error
    "p_o_swing_kpa": (40.0, 80.0, 0.1),  # size of the chambers
    "p_o_loop": (0.17, 0.4, 0.1),  # paper, Fig. 5
}

#: Most by which loops may change over the sweep (C18), and what is looked at.
_CHANGE = 1.15
_SHAPE = ("swing", "width_quarter", "width_half", "width_three_quarters", "slope")

Judged = Mapping[str, Any]


class Target(NamedTuple):
    """The logarithm of a number of a judged rig, or of a ratio, and where it should lie."""

    term: str  #: its key in ``calibration.fit``
    of: tuple[str, Any]  #: group and key of the number
    tolerance: float
    high: float
    low: float = -math.inf
    over: tuple[str, Any] | None = None  #: group and key of what it is divided by

    def number(self, judged: Judged) -> float:
        """Return the number of a rig; NaN if it was not measured."""
        if self.of[0] not in judged:
            return math.nan
        number = _log(judged, self.of)
        return number - _log(judged, self.over) if self.over else number


def targets(published: Mapping[str, Any], terms: Sequence[str]) -> list[Target]:
    """Return the targets of the terms of ``calibration.fit``."""
    return [target for target in _targets(published) if target.term in terms]


def numbers_of(judged: Sequence[Judged], of: Sequence[Target]) -> np.ndarray:
    """Return the numbers of targets, means over seeds; NaN for what was not measured."""
    return np.array([np.mean([target.number(seed) for seed in judged]) for target in of])


def misses(numbers: np.ndarray, of: Sequence[Target]) -> np.ndarray:
    """Return by how many tolerances numbers lie outside their ranges; 0 for NaN."""
    low, high, tolerance = np.array([(t.low, t.high, t.tolerance) for t in of]).T
    return np.nan_to_num((numbers - np.clip(numbers, low, high)) / tolerance)


def properties(sweep: Mapping[str, np.ndarray]) -> dict[str, float]:
    """Return properties of a rig's loops in the sweep.

    ``angle_deg`` is the largest angle, ``loop_kpa`` the full width of the loop of P_exp over theta
    at mid-angle, ``p_o_loop`` the width of P_o's loop over its swing; how loops change is by "loop
    measure", see ``measure_hysteresis``.
    """
    theta, p_o = sweep["theta_deg"], sweep["p_o_kpa"]
    swing = float(np.ptp(p_o))
    found = {
        "angle_deg": float(theta.max()),
        "loop_kpa": loop_width(theta, sweep["p_target_kpa"]),
        "p_o_swing_kpa": swing,
        "p_o_loop": loop_width(theta, p_o) / swing,
    }
    for loop, changes in measure_hysteresis(sweep).items():
        found |= {f"{loop} {measure}": change for measure, change in changes.items()}
    return found


def printed_errors(published: Mapping[str, Any]) -> dict[str, float]:
    """Return the training and test errors of Tables II and III, by "trained on/model/phase".

    Validation errors are left out: with shuffled folds they hardly differ from
    the training errors.
    """
    errors = {}
    for trained_on, table in PRINTED.items():
        for model in MODELS:
            printed = published[table][model]
            errors[f"{trained_on}/{model}/train"] = float(printed["train_rmse_kpa"][0])
            errors[f"{trained_on}/{model}/test"] = float(printed["test_rmse_kpa"])
    return errors


def _targets(published: Mapping[str, Any]) -> Iterator[Target]:
    for key, printed in printed_errors(published).items():
        yield from _printed("tables", ("errors", key), printed, 0.03 if "train" in key else 0.04)
    for log in ("sweep", "complex"):
        for other in ("esn", "fuzzy_linear"):
            of, over = ("errors", f"{log}/fprc/test"), ("errors", f"{log}/{other}/test")
            yield Target("orders", of, _RATIO, -_MARGIN, over=over)
    of, over = ("errors", "sweep/esn/train"), ("errors", "sweep/fprc/train")
    yield Target("C1b", of, 0.01, -0.015, over=over)
    shares = published["fig_portion_mean_weight_share_percent"]
    ratio = math.log(shares["p_o"] / shares["theta_d"])
    yield Target("C8", ("shares", "p_o_over_theta_d"), 0.2, ratio, ratio)
    for name, (low, high, tolerance) in PLAUSIBLE.items():
        yield Target("plausible", ("properties", name), tolerance, math.log(high), math.log(low))
    most = math.log(_CHANGE)
    for loop in ("actuator", "reservoir"):
        for measure in _SHAPE:
            yield Target("C18", ("properties", f"{loop} {measure}"), 0.1, most, -most)
    for higher, lower in pairwise(range(len(EPSILONS))):
        yield Target("C9a", ("epsilon", higher), _RATIO, -_MARGIN, over=("epsilon", lower))
    table = published["table_4_tracking_rmse_deg"]
    for reference in REFERENCES:
        opened = ("open_loop", reference)
        yield from _printed("open_loop", opened, table["fprc"][reference], 0.04)
        for term, (loop, left) in _LEFT.items():
            yield Target(term, (loop, reference), _HELP, math.log(left), over=opened)
    # how much feedback helps in the sweep says which inertia; the other references judge it
    closed = math.log(table["fprc_pd"]["sweep"])
    yield Target("closed_sweep", ("closed_loop", "sweep"), 0.12, closed, closed)


def _log(judged: Judged, of: tuple[str, Any]) -> float:
    group, key = of
    return math.log(max(judged[group][key], 1e-3))  # a loop may have no width


def _printed(term: str, of: tuple[str, Any], printed: float, tolerance: float) -> Iterator[Target]:
    """Yield that a number should be as printed, and what counts more if it is far from it."""
    at = math.log(printed)
    yield Target(term, of, tolerance, at, at)
    low, high = math.log(printed * (1.0 - _FAR)), math.log(printed * (1.0 + _FAR))
    yield Target(term, of, _MORE, high, low)
