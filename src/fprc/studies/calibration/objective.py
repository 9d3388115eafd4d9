"""What a fit asks of a rig: numbers, most of them logarithms, each with a range and a tolerance."""

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from itertools import pairwise
from typing import Any, NamedTuple

import numpy as np

from fprc.experiments.measures import measure_hysteresis
from fprc.paper import MODELS, PRINTED, REFERENCES
from fprc.signals import loop_width

Judged = Mapping[str, Any]

#: Tolerances: of the logarithms of errors in training, in test, in open loop and, in the sweep,
#: with feedback; of the share of the weights; of ratios that a claim limits.
_TRAIN, _TEST, _OPEN, _CLOSED, _SHARE, _RATIO = 0.03, 0.05, 0.08, 0.12, 0.2, 0.03

#: Values of epsilon in Fig. 10, falling.
EPSILONS = (1.0, 0.1, 0.01, 1e-3, 1e-4)

#: Margin to the limit of a ratio, as a logarithm: about what it varies by between seeds.
_MARGIN = 0.03

#: Most that feedback may leave of the open-loop error, at the printed gains and at 1.5 times them.
_LEFT = {"closed_loop": 0.8, "firm_loop": 0.95}

#: Plausible ranges of a rig's ``properties``, and their tolerances as logarithms.
PLAUSIBLE = {
    "angle_deg": (57.0, 63.0, 0.02),  # paper: about 60 deg
    "loop_kpa": (45.0, 75.0, 0.1),  # Fuzzy-linear's printed error
    "p_o_swing_kpa": (40.0, 80.0, 0.1),  # size of the chambers
    "p_o_loop": (0.17, 0.4, 0.1),  # paper, Fig. 5
}

#: Most by which loops may change over the sweep, as a logarithm, and its tolerance (C18).
_SAME, _SAME_TOLERANCE = math.log(1.15), 0.05


class Target(NamedTuple):
    """A number of a judged rig, and where it should lie."""

    term: str  #: its key in ``calibration.fit``
    name: str
    number: Callable[[Judged], float]
    low: float
    high: float
    tolerance: float


def targets(published: Mapping[str, Any], terms: Sequence[str]) -> list[Target]:
    """Return the targets of the terms of ``calibration.fit``."""
    return [target for target in _targets(published) if target.term in terms]


def numbers_of(judged: Sequence[Judged], of: Sequence[Target]) -> np.ndarray:
    """Return the numbers of targets, means over seeds; NaN for what was not measured."""

    def number(target: Target, seed: Judged) -> float:
        try:
            return target.number(seed)
        except KeyError:
            return math.nan

    return np.array([np.mean([number(target, seed) for seed in judged]) for target in of])


def misses(numbers: np.ndarray, of: Sequence[Target]) -> np.ndarray:
    """Return by how many tolerances numbers lie outside their ranges; 0 for NaN."""
    _, _, _, low, high, tolerance = zip(*of, strict=True)
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
        yield _near("tables", key, _log("errors", key), printed, tolerance)
    for log in ("sweep", "complex"):
        for other in ("esn", "fuzzy_linear"):
            keys = f"{log}/fprc/test", f"{log}/{other}/test"
            yield _below("orders", f"{log}/fprc/{other}", _errors_ratio(*keys))
    lowest = _errors_ratio("sweep/esn/train", "sweep/fprc/train")
    yield _below("C1b", "esn/fprc/train", lowest, margin=0.015, tolerance=0.01)
    shares = published["fig_portion_mean_weight_share_percent"]
    printed = shares["p_o"] / shares["theta_d"]
    yield _near("C8", "shares", _log("shares", "p_o_over_theta_d"), printed, _SHARE)
    for key, (low, high, tolerance) in PLAUSIBLE.items():
        yield Target(
            "plausible",
            key,
            _log("properties", key),
            math.log(low),
            math.log(high),
            tolerance,
        )
    for loop in ("actuator", "reservoir"):
        for measure in (
            "swing",
            "width_quarter",
            "width_half",
            "width_three_quarters",
            "slope",
        ):
            key = f"{loop} {measure}"
            number = _log("properties", key)
            yield Target("C18", key, number, -_SAME, _SAME, _SAME_TOLERANCE)
    # epsilon falls from value to value
    for before, after in pairwise(range(len(EPSILONS))):
        yield _below("C9a", f"epsilon {after}", _fall(before, after))
    table = published["table_4_tracking_rmse_deg"]
    for reference in REFERENCES:
        opened = _log("open_loop", reference)
        yield _near("open_loop", reference, opened, table["fprc"][reference], _OPEN)
        for term, loop in (("closed_loop", "closed_loop"), ("margin", "firm_loop")):
            most = math.log(_LEFT[loop])
            yield Target(
                term,
                f"{term} {reference}",
                _left(loop, reference),
                -math.inf,
                most,
                2.0 * _RATIO,
            )
    # how much feedback helps in the sweep says which inertia; the other references judge it
    closed, printed = _log("closed_loop", "sweep"), table["fprc_pd"]["sweep"]
    yield _near("closed_sweep", "closed sweep", closed, printed, _CLOSED)


def _near(
    term: str,
    name: str,
    number: Callable[[Judged], float],
    printed: float,
    tolerance: float,
) -> Target:
    return Target(term, name, number, math.log(printed), math.log(printed), tolerance)


def _below(
    term: str,
    name: str,
    number: Callable[[Judged], float],
    *,
    margin: float = _MARGIN,
    tolerance: float = _RATIO,
) -> Target:
    """Return a target of the logarithm of a ratio that should be below 1."""
    return Target(term, name, number, -math.inf, -margin, tolerance)


def _log(*keys: str) -> Callable[[Judged], float]:
    def number(judged: Any) -> float:
        for key in keys:
            judged = judged[key]
        return math.log(max(judged, 1e-3))  # a loop may have no width

    return number


def _left(loop: str, reference: str) -> Callable[[Judged], float]:
    """Return the error with feedback over that without."""
    closed, opened = _log(loop, reference), _log("open_loop", reference)
    return lambda judged: closed(judged) - opened(judged)


def _errors_ratio(key: str, other: str) -> Callable[[Judged], float]:
    ours, theirs = _log("errors", key), _log("errors", other)
    return lambda judged: ours(judged) - theirs(judged)


def _fall(before: int, after: int) -> Callable[[Judged], float]:
    """Return the training error with one epsilon over that with the next lower one."""
    return lambda judged: math.log(judged["epsilon"][before] / judged["epsilon"][after])
