"""What a fit asks of a rig: logarithms of numbers, each with a range and a tolerance."""

import math
from collections.abc import Iterator, Mapping, Sequence
from functools import reduce
from itertools import pairwise
from operator import getitem
from typing import Any, NamedTuple

import numpy as np

from fprc.paper import MODELS, PRINTED, REFERENCES
from fprc.signals import loop_width, measure_hysteresis

#: Tolerances of the logarithms of errors in training, in test, in open loop and, in the sweep,
#: with feedback; of the share of the weights; of ratios that a claim limits; of what feedback
#: leaves; of how a loop changes over the sweep.
_TRAIN, _TEST, _OPEN, _CLOSED, _SHARE, _RATIO, _HELP, _SAME = (
    0.03, 0.04, 0.04, 0.12, 0.2, 0.05, 0.06, 0.1,
)  # fmt: skip

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
Path = tuple[Any, ...]


class Target(NamedTuple):
    """The logarithm of a number of a judged rig, or of a ratio, and where it should lie."""

    term: str  #: its key in ``calibration.fit``
    of: Path  #: keys that lead to the number
    over: Path | None  #: and to what it is divided by
    low: float
    high: float
    tolerance: float

    def number(self, judged: Judged) -> float:
        """Return the number of a rig; NaN if it was not measured."""
        try:
            return _log(judged, self.of) - (_log(judged, self.over) if self.over else 0.0)
        except KeyError:
            return math.nan


def targets(published: Mapping[str, Any], terms: Sequence[str]) -> list[Target]:
    """Return the targets of the terms of ``calibration.fit``."""
    return [target for target in _targets(published) if target.term in terms]


def numbers_of(judged: Sequence[Judged | None], of: Sequence[Target]) -> np.ndarray:
    """Return the numbers of targets, means over seeds; NaN for what was not measured."""
    return np.array([np.mean([target.number(seed) for seed in judged if seed]) for target in of])


def misses(numbers: np.ndarray, of: Sequence[Target]) -> np.ndarray:
    """Return by how many tolerances numbers lie outside their ranges; 0 for NaN."""
    *_, low, high, tolerance = zip(*of, strict=True)
    return np.nan_to_num((numbers - np.clip(numbers, low, high)) / tolerance)


def properties(sweep: Mapping[str, np.ndarray]) -> dict[str, float]:
    """Return properties of a rig's loops in the sweep.

    Returns
    -------
    dict
        ``angle_deg``, the largest angle; ``loop_kpa``, the full width of the loop of P_exp over
        theta at mid-angle; ``p_o_swing_kpa``; ``p_o_loop``, the width of P_o's loop over its
        swing; and how loops change, by "loop measure", see ``measure_hysteresis``.
    """
    theta, p_o = sweep["theta_deg"], sweep["p_o_kpa"]
    swing = float(np.ptp(p_o))
    return {
        "angle_deg": float(theta.max()),
        "loop_kpa": loop_width(theta, sweep["p_target_kpa"]),
        "p_o_swing_kpa": swing,
        "p_o_loop": loop_width(theta, p_o) / swing,
        **{
            f"{loop} {measure}": change
            for loop, changes in measure_hysteresis(sweep).items()
            for measure, change in changes.items()
        },
    }


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


def errors_of(compared: Mapping[str, Any]) -> dict[str, float]:
    """Return the errors of Tables II and III of one rig, by "trained on/model/phase"."""
    errors = {}
    for report in compared["models"]:
        key = f"{report['trained_on']}/{report['model']}"
        errors[f"{key}/train"] = float(np.mean(report["train_rmse_kpa"]))
        errors[f"{key}/test"] = float(report["test_rmse_kpa"])
    return errors


def _targets(published: Mapping[str, Any]) -> Iterator[Target]:
    for key, printed in printed_errors(published).items():
        tolerance = _TRAIN if key.endswith("train") else _TEST
        yield _near("tables", ("errors", key), printed, tolerance)
        yield _not_far("tables", ("errors", key), printed)
    for log in ("sweep", "complex"):
        for other in ("esn", "fuzzy_linear"):
            keys = ("errors", f"{log}/fprc/test"), ("errors", f"{log}/{other}/test")
            yield _below("orders", *keys, -_MARGIN, _RATIO)
    keys = ("errors", "sweep/esn/train"), ("errors", "sweep/fprc/train")
    yield _below("C1b", *keys, -0.015, 0.01)
    shares = published["fig_portion_mean_weight_share_percent"]
    share = ("shares", "p_o_over_theta_d")
    yield _near("C8", share, shares["p_o"] / shares["theta_d"], _SHARE)
    for name, (low, high, tolerance) in PLAUSIBLE.items():
        ends = math.log(low), math.log(high)
        yield Target("plausible", ("properties", name), None, *ends, tolerance)
    most = math.log(_CHANGE)
    for loop in ("actuator", "reservoir"):
        for measure in _SHAPE:
            yield Target("C18", ("properties", f"{loop} {measure}"), None, -most, most, _SAME)
    for higher, lower in pairwise(range(len(EPSILONS))):
        yield _below("C9a", ("epsilon", higher), ("epsilon", lower), -_MARGIN, _RATIO)
    table = published["table_4_tracking_rmse_deg"]
    for reference in REFERENCES:
        opened = ("open_loop", reference)
        yield _near("open_loop", opened, table["fprc"][reference], _OPEN)
        yield _not_far("open_loop", opened, table["fprc"][reference])
        for term, (loop, left) in _LEFT.items():
            yield _below(term, (loop, reference), opened, math.log(left), _HELP)
    # how much feedback helps in the sweep says which inertia; the other references judge it
    yield _near("closed_sweep", ("closed_loop", "sweep"), table["fprc_pd"]["sweep"], _CLOSED)


def _log(judged: Any, path: Path) -> float:
    return math.log(max(reduce(getitem, path, judged), 1e-3))  # a loop may have no width


def _near(term: str, of: Path, printed: float, tolerance: float) -> Target:
    return Target(term, of, None, math.log(printed), math.log(printed), tolerance)


def _not_far(term: str, of: Path, printed: float) -> Target:
    low, high = (math.log(printed * share) for share in (1.0 - _FAR, 1.0 + _FAR))
    return Target(term, of, None, low, high, _MORE)


def _below(term: str, of: Path, over: Path, most: float, tolerance: float) -> Target:
    return Target(term, of, over, -math.inf, most, tolerance)
