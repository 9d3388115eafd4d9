"""Claims B1-B7: what the reservoir is worth, compared with models without one.

docs/archive/preregistration.md has them with their limits.
"""

from collections.abc import Mapping, Sequence
from typing import Any

import pandas as pd

from fprc.registry import title_of
from fprc.studies.beyond.measurements import LOOPS, family_title, measured
from fprc.studies.beyond.verdicts import Claim, Numbers, Pair, part_of
from fprc.tables.text import format_mean


def _of_fprc(other: str, measure: str = "forward", ours: str = "fprc") -> Pair:
    text = f"{title_of(ours)} / {title_of(other)} ({measure.replace('_', ' ')})"
    return Pair((ours, measure), (other, measure), text)


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
            Pair(
                ("fprc", f"{measure}/-2"),
                ("fuzzy_linear", measure),
                f"FPRC / Fuzzy-linear ({measure.replace('_', ' ')}, P_o 2 kPa low)",
            )
            for measure in ("forward", *LOOPS)
        ],
        {"tables": _BOTH, "orders": _LOWEST, **_LOOPS},
    ),
}

#: By family, the lowest level that decides B8: P_o has a nonlinear capacity of 0.1 or more, and its
#: taps more memory than taps of low-passed theta_d. In November 2026 it did not hold on these rigs;
#: since then it is not measured (commit d4274ff3 has the code), but counts in Holm's procedure, so
#: that the levels of the others stay.
B8 = {"paper": 2.1e-11, "bouc_wen": 9.7e-10, "dry": 2.8e-13, "viscous": 3.6e-12}


def numbers_of(family: Mapping[str, Any]) -> Numbers:
    """Return the numbers of a family by model and measure."""
    by_name = measured([family]).set_index(["unit", "seed"]).groupby(["model", "measure"])["value"]
    return dict(iter(by_name))


#: Ratios of forward test errors beside B1, which no verdict rests on: with settings tuned alike,
#: and with another substitute for P_o.
BESIDE = {
    "FPRC / FPRC on low-passed theta_d, both tuned alike": _of_fprc(
        "fprc_lowpass_tuned", ours="fprc_tuned"
    ),
    "FPRC / ridge on low-passes of theta_d": _of_fprc("bank"),
    "the same, both tuned alike": _of_fprc("bank_tuned", ours="fprc_tuned"),
}


def beside_page(families: Sequence[Mapping[str, Any]]) -> pd.DataFrame:
    """Return the ratios of ``BESIDE`` with their 95 % intervals, a column per family."""
    page = {}
    for family in families:
        numbers = numbers_of(family)
        parts = {text: part_of(pair, numbers, family) for text, pair in BESIDE.items()}
        page[family_title(family["name"])] = {
            text: format_mean(part.ends(0.05), "mean") if len(part.values) > 1 else "-"
            for text, part in parts.items()
        }
    return pd.DataFrame(page).reset_index(names="Ratio")
