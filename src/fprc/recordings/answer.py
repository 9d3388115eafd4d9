"""The answer of `fprc readout`: whether P_o of a recording is worth a second sensor.

The limits below were written down before they were run on any recording.
"""

import math
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from fprc.evaluation.paired import EQUIVALENT_WITHIN, LEAST_UNITS, Part
from fprc.evaluation.sides import (
    PURGE_S,
    PURGES,
    WARM_UP_S,
    Recordings,
    best_of_side,
    error_when_shifted,
    p_o_repeats,
    period_of,
    shifts_of,
)
from fprc.tables.text import three_digits

YES, NO, UNDECIDED = "Yes", "No", "Not decided"
#: P_o is worth a second sensor if it lowers the error by more than this factor.
MARGIN = EQUIVALENT_WITHIN
#: Chance that the interval of the ratio errs.
LEVEL = 0.05
#: The theta side explains little if it leaves more than this share of the target's variance.
LITTLE = 0.5
#: A recording is called too short if one of at most this many times its length would decide;
#: beyond that its parts disagree.
MOST_TIMES = 10.0
#: Share of the blocks at either end that show how far the parts disagree.
_ENDS = 0.25


def answer_recordings(
    recordings: Recordings,
    models: Mapping[str, Any],
    seed: int,
    unit: str = "kPa",
) -> dict[str, Any]:
    """Compare the best models with and without P_o, and P_o with itself at other times.

    ``models`` is the configuration's section, for 200 samples a second; ``seed`` is of rules and
    networks. Returned are ``verdict``, ``reason`` (why it is not decided, else empty), ``words``
    (the first line); ``ratio`` with P_o over without, ``low`` and ``high``; of ``without`` and
    ``with``: ``error`` (geometric mean over blocks, ``unit`` of the target), ``family``,
    ``families`` (error of each) and ``blocks``; ``shifts``, the errors with P_o of other times;
    ``period_s`` of the motion or None; ``needed_s``, which length would decide, or None;
    ``explained``, share of the target's variance that the side without P_o explains; ``block_s``,
    ``duration_s``.
    """
    thin = recordings.thinned()
    folds, period_s = thin.folds(), period_of(thin)
    sides = {name: best_of_side(thin, name == "with", models, seed) for name in ("without", "with")}
    ratios = np.log(sides["with"].errors / sides["without"].errors)
    overlap = float(np.mean([len(block) / len(rows) for rows, block in folds]))
    mean, low, high = Part("", dict(enumerate(ratios)), overlap=overlap).interval(LEVEL)
    shifts = [
        error_when_shifted(thin.shifted(share), sides["with"], models, seed)
        for share in shifts_of(thin, period_s)
    ]
    left = float(np.mean(sides["without"].errors ** 2)) / float(np.var(thin.target))
    found: dict[str, Any] = {
        name: {
            "error": side.error,
            "family": side.family,
            "families": {of: float(np.exp(np.log(e).mean())) for of, e in side.each.items()},
            "blocks": side.errors.tolist(),
            "chosen": [family for family, _ in side.chosen],
        }
        for name, side in sides.items()
    }
    found |= {
        "ratio": math.exp(mean),
        "low": math.exp(low),
        "high": math.exp(high),
        "shifts": shifts,
        "period_s": period_s,
        "p_o_repeats": bool(period_s and p_o_repeats(thin, period_s)),
        "explained": max(0.0, 1.0 - left),
        "block_s": [len(block) / thin.rate_hz for _, block in folds],
        "duration_s": len(thin.theta) / thin.rate_hz,
    }
    verdict, reason, needed_s = decide(found, ratios)
    found |= {"verdict": verdict, "reason": reason, "needed_s": needed_s}
    return found | {"words": first_line(found, unit)}


def decide(found: Mapping[str, Any], ratios: Sequence[float]) -> tuple[str, str, float | None]:
    """Return the verdict, why it is not decided, and which length would decide, s.

    Yes: the whole interval of the ratio lies below 1/1.05, P_o beats all its shifts, and does not
    repeat with the motion. No: the whole interval lies above 1/1.05. Otherwise it is not decided,
    for the one reason that matters most.
    """

    def time(seconds: float) -> str:
        minutes = seconds >= 100.0
        return f"{math.ceil(seconds / 60.0)} minutes" if minutes else f"{math.ceil(seconds)} s"

    margin, mean, high = math.log(MARGIN), math.log(found["ratio"]), math.log(found["high"])
    shifts, needed_s = found["shifts"], None
    beaten = sum(found["with"]["error"] < error for error in shifts)
    if len(ratios) < LEAST_UNITS:
        needed_s = WARM_UP_S + LEAST_UNITS * PURGES * PURGE_S
        return UNDECIDED, f"The recording is too short: it takes {time(needed_s)}.", needed_s
    if math.log(found["low"]) > -margin:
        return NO, "", None
    if high < -margin and not found["p_o_repeats"] and shifts and beaten == len(shifts):
        return YES, "", None
    if found["period_s"]:
        reason = (
            f"The motion repeats every {found['period_s']:.3g} s, so each part has a twin in the "
            "rest: record one that does not repeat."
        )
    elif high < -margin:
        reason = (
            f"P_o of another time does as well in {len(shifts) - beaten} of {len(shifts)} trials: "
            "it tells the time, not what the chamber remembers."
        )
    elif found["explained"] < LITTLE:
        share = 100.0 * found["explained"]
        reason = f"theta explains only {share:.0f} % of P_exp: check the columns."
    else:
        needed_s = found["duration_s"] * ((high - mean) / abs(mean + margin)) ** 2
        best, worst = np.exp(np.quantile(ratios, (_ENDS, 1.0 - _ENDS)))
        reason = (
            f"The recording is too short: if its ratio, {found['ratio']:.2f}, stays, it takes "
            f"{time(needed_s)} of this motion."
            if needed_s <= MOST_TIMES * found["duration_s"]
            else f"Its parts disagree: the ratio is below {best:.2f} in a quarter of them and "
            f"above {worst:.2f} in another."
        )
    return UNDECIDED, reason, needed_s


def first_line(found: Mapping[str, Any], unit: str) -> str:
    """Return verdict, both errors and families, and the reason."""
    fuzzy = {"with": "FPRC", "without": "FPRC on low-passed theta"}
    errors, families = [], []
    for side, ending in {"with": " + P_o", "without": ""}.items():
        errors.append(three_digits(found[side]["error"]))
        family = found[side]["family"]
        families.append(fuzzy[side] if family == "fuzzy" else f"{family}{ending}")
    more = found["reason"]
    if found["verdict"] == NO and found["period_s"]:
        more = f"The motion repeats every {found['period_s']:.3g} s; on another one it may differ."
    line = f"{found['verdict']}: with P_o {errors[0]} {unit} ({families[0]}), "
    return f"{line}without {errors[1]} ({families[1]}). {more}".rstrip()
