"""Claims B1-B8: what the reservoir is worth, compared with models without one.

docs/archive/preregistration.md has them with their limits.
"""

import operator
from collections.abc import Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np
import pandas as pd

from fprc.claims.paired import Part, judge_together, verdict_in_words
from fprc.registry import title_of
from fprc.studies.beyond.measurements import capacities, family_title, measured

#: Capacity of degree two or more from which P_o counts as nonlinear, of 1 for a single signal.
LEAST_NONLINEAR = 0.1


class Pair(NamedTuple):
    """A measure of a model over that of another, or a capacity less another, or less a constant.

    A ratio below 1 is better, and so is a difference above 0.
    """

    ours: tuple[str, str]  #: model and measure, or set of states and quantity
    theirs: Any  #: the same, or a constant
    words: str  #: what is measured, for readers
    ratio: bool = True


class Claim(NamedTuple):
    """What is claimed, what is compared, and which fits of the rig favour a side."""

    text: str
    parts: Sequence[Pair]
    #: By term of the calibration's objective: what its fit favours, and what was fitted.
    favours: Mapping[str, tuple[str, str]]


def _of_fprc(other: str, measure: str = "forward", ours: str = "fprc") -> Pair:
    return Pair((ours, measure), (other, measure), measure.replace("_", " "))


_FORWARD = ("FPRC", "FPRC's forward error, at epsilon 0.01")
_REVERSED = ("FPRC", "FPRC's reversed error, at epsilon 0.01")
_LOWEST = ("FPRC", "FPRC's error as the lowest of the paper's models")
_BOTH = ("FPRC", "the errors of both models, FPRC's lower on the test")
_RISE = ("FPRC", "a rise of the ESN's error from training to test")
_TRACKING = ("FPRC", "FPRC's open-loop errors")
_CLOSED = ("FPRC", "the closed loop's error with FPRC")
_LOOPS = {"open_loop": _TRACKING, "closed_loop": _CLOSED, "closed_sweep": _CLOSED}
_SHARE = ("P_o", "P_o's share of the readout's weights")
CLAIMS = {
    "B1": Claim(
        "P_o beats low-passed theta_d, forward",
        [_of_fprc("fprc_lowpass")],
        {"tables": _FORWARD, "orders": _LOWEST, "C8": _SHARE},
    ),
    "B2": Claim(
        "P_o beats low-passed theta_d, reversed",
        [_of_fprc("fprc_lowpass", "reversed")],
        {"tables": _REVERSED, "orders": _LOWEST, "C8": _SHARE},
    ),
    "B3": Claim(
        "P_o beats low-passed theta_d in tracking, open and closed loop",
        [_of_fprc("fprc_lowpass", "open_loop"), _of_fprc("fprc_lowpass", "closed_loop")],
        {**_LOOPS, "C8": _SHARE},
    ),
    "B4": Claim(
        "the fuzzy readout beats a ridge on the same features, forward",
        [_of_fprc("ridge_p_o")],
        {"tables": _FORWARD, "orders": _LOWEST},
    ),
    "B5": Claim(
        "an ESN with the same training error generalises worse, forward",
        [_of_fprc("esn_matched")],
        {"tables": _BOTH, "orders": _RISE},
    ),
    "B6": Claim(
        "FPRC beats an ESN that was tuned as much, forward",
        [_of_fprc("esn_tuned", ours="fprc_tuned")],
        {"tables": _BOTH, "orders": _LOWEST},
    ),
    "B7": Claim(
        "FPRC whose P_o is 2 kPa low still beats Fuzzy-linear, forward and in tracking, open and "
        "closed loop",
        [
            Pair(("fprc", f"{measure}/-2"), ("fuzzy_linear", measure), f"{words}, P_o 2 kPa low")
            for measure, words in (
                ("forward", "forward"),
                ("open_loop", "open loop"),
                ("closed_loop", "closed loop"),
            )
        ],
        {"tables": _BOTH, "orders": _LOWEST, **_LOOPS},
    ),
    "B8": Claim(
        "P_o has a nonlinear capacity of 0.1 or more, and its taps more memory than taps of "
        "low-passed theta_d",
        [Pair(("p_o", "nonlinear"), LEAST_NONLINEAR, "nonlinear capacity of P_o - 0.1", False),
         Pair(("p_o_taps", "memory"), ("theta_lowpass_taps", "memory"),
              "memory of taps of P_o - of taps of low-passed theta_d", False)],
        {"C8": _SHARE},
    ),
}  # fmt: skip


def judge_family(family: Mapping[str, Any]) -> list[dict[str, Any]]:
    """Judge B1-B8 in one family.

    Parameters
    ----------
    family : Mapping
        See ``fprc.studies.beyond.measurements``; ``fitted``: the terms its rigs were fitted to.

    Returns
    -------
    list of dict
        ``world``, ``title``, ``id``, ``claim``, ``verdict``, ``words`` (the verdict, as
        readers see it), ``p`` (after Holm), ``stable`` (share of subsets, or None), ``units``,
        ``dropped`` (units without the pair), ``fitted`` (the fits that bear on the claim:
        what each favours, and what was fitted), and ``parts``: ``text``, ``ratio``, ``mean``,
        ``low``, ``high`` (interval at the level that Holm's procedure gives). A ratio below 1
        supports the claim, as does a difference above 0.
    """
    numbers = _numbers(family)
    found = [[_part(pair, numbers, family) for pair in claim.parts] for claim in CLAIMS.values()]
    rows = []
    for (name, claim), parts, judged in zip(
        CLAIMS.items(), found, judge_together(found), strict=True
    ):
        rows.append(
            {
                "world": family["name"],
                "title": family_title(family["name"]),
                "id": name,
                "claim": claim.text,
                "verdict": judged.verdict,
                "words": verdict_in_words(judged.verdict, claim.parts[0].ratio, judged.turned),
                "p": judged.p,
                "stable": judged.stable,
                "units": min(len(part.values) for part in parts),
                "dropped": max(part.dropped for part in parts),
                "fitted": list(
                    dict.fromkeys(
                        why for term, why in claim.favours.items() if term in family["fitted"]
                    )
                ),
                "parts": [
                    {"text": part.text, "ratio": part.ratio, **part.ends(judged.level)}
                    for part in parts
                    if len(part.values) > 1
                ],
            }
        )
    return rows


#: Ratios of forward test errors beside B1, which no verdict rests on: with settings tuned alike,
#: and with another substitute for P_o.
BESIDE = (
    ("FPRC / FPRC on low-passed theta_d, both tuned alike", "fprc_tuned", "fprc_lowpass_tuned"),
    ("FPRC / ridge on low-passes of theta_d", "fprc", "bank"),
    ("the same, both tuned alike", "fprc_tuned", "bank_tuned"),
)


def beside_b1(family: Mapping[str, Any]) -> dict[str, dict[str, float] | None]:
    """Return ``mean``, ``low`` and ``high`` (95 %) of ``BESIDE``; None if not measured."""
    numbers, found = _numbers(family), {}
    for text, ours, theirs in BESIDE:
        part = _part(_of_fprc(theirs, ours=ours), numbers, family)
        found[text] = part.ends(0.05) if len(part.values) > 1 else None
    return found


#: Numbers by model and measure, or by set of states and quantity, one per simulated rig.
Numbers = Mapping[tuple[str, str], pd.Series]
_NONE = pd.Series(index=pd.MultiIndex.from_arrays([[], []], names=["unit", "seed"]), dtype=float)


def _numbers(family: Mapping[str, Any]) -> Numbers:
    of_states = {"set": "model", "quantity": "measure"}
    found = pd.concat([measured([family]), capacities([family]).rename(columns=of_states)])
    by_name = found.set_index(["unit", "seed"]).groupby(["model", "measure"])["value"]
    return dict(iter(by_name))


def _part(pair: Pair, numbers: Numbers, family: Mapping[str, Any]) -> Part:
    ours, constant = numbers.get(pair.ours, _NONE), isinstance(pair.theirs, float)
    theirs: Any = pair.theirs if constant else numbers.get(pair.theirs, _NONE)
    # below 0 supports the claim; of a difference, readers see ours less theirs
    values = (np.log(ours) - np.log(theirs) if pair.ratio else theirs - ours).dropna()
    # simulations of one rig with several seeds are one unit
    by_unit = values.groupby(level="unit").mean().to_dict()
    if not pair.ratio:
        dropped = len({entry["unit"] for entry in family.get("capacity", ())}) - len(by_unit)
        return Part(pair.words, by_unit, False, operator.neg, dropped)
    text = f"{title_of(pair.ours[0])} / {title_of(pair.theirs[0])} ({pair.words})"
    lost = len({cell["unit"] for cell in family["cells"]}) - len(by_unit)
    return Part(text, by_unit, dropped=lost)
