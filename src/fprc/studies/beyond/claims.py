"""Claims W1-W4 and B1-B8: what P_o is worth, and what FPRC's readout is worth."""

from collections.abc import Mapping, Sequence
from itertools import product
from typing import Any

import numpy as np
import pandas as pd

from fprc.registry import SIDES, title_of
from fprc.signals import interval_of_mean
from fprc.studies.beyond.measurements import (
    BEST_MEASURES,
    LOOPS,
    MEASURES,
    family_title,
    measured,
    model_title,
)
from fprc.studies.beyond.verdicts import Claim, Numbers, Pair
from fprc.tables.text import format_mean, three_digits


def _pair(ours: str, other: str, measure: str = "forward") -> Pair:
    text = f"{model_title(ours)} / {model_title(other)} ({measure.replace('_', ' ')})"
    return Pair((ours, measure), (other, measure), text)


_FORWARD = ("FPRC", "FPRC's forward error, at epsilon 0.01")
_LOWEST = ("FPRC", "FPRC's error as the lowest of the paper's models")
_BOTH = ("FPRC", "the errors of both models, FPRC's lower on the test")
_TRACKING = ("FPRC", "FPRC's open-loop errors")
_CLOSED = ("FPRC", "the closed loop's error with FPRC")
_LOOPS = {"open_loop": _TRACKING, "closed_loop": _CLOSED, "closed_sweep": _CLOSED}
_SHARE = ("P_o", "P_o's share of the readout's weights")
_BEST = ("with_p_o", "without_p_o")
CLAIMS = {
    "W1": Claim(
        "P_o is worth a sensor, on unseen parts of the same motions",
        [_pair(*_BEST, "blocks")],
        {"C8": _SHARE},
    ),
    "W2": Claim(
        "P_o is worth a sensor, forward and reversed",
        [_pair(*_BEST, "forward"), _pair(*_BEST, "reversed")],
        {"C8": _SHARE},
    ),
    "W3": Claim(
        "P_o is worth a sensor in tracking, open and closed loop",
        [_pair(*_BEST, loop) for loop in LOOPS],
        {"C8": _SHARE},
    ),
    "W4": Claim(
        "FPRC beats the best other model of the same inputs, forward",
        [_pair("fprc", "other_p_o")],
        {"tables": _FORWARD, "orders": _LOWEST},
    ),
    "B1": Claim(
        "P_o beats low-passed theta_d, forward",
        [_pair("fprc", "fprc_lowpass")],
        {"tables": _FORWARD, "orders": _LOWEST, "C8": _SHARE},
    ),
    "B4": Claim(
        "the fuzzy readout beats a ridge on the same features, forward",
        [_pair("fprc", "ridge_p_o")],
        {"tables": _FORWARD, "orders": _LOWEST},
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
    "B8": Claim(
        "P_o has a nonlinear capacity of 0.1 or more, and its low-passes more memory than those of "
        "theta",
        [
            Pair(("threshold", "nonlinear"), ("p_o", "nonlinear"), "0.1 / nonlinear capacity"),
            Pair(("theta", "memory_s"), ("p_o", "memory_s"), "memory of theta / of P_o"),
        ],
        {"C8": _SHARE},
    ),
}


#: The best models of one side: their number among the two of ``SIDES``, and what is left out.
_SIDES: Mapping[str, tuple[int, Sequence[str]]] = {
    "with_p_o": (1, ()),
    "without_p_o": (0, ()),
    "other_p_o": (1, ("fprc",)),
}


def numbers_of(family: Mapping[str, Any]) -> Numbers:
    """Return the numbers of a family by model and measure, those of the best of each side too.

    The best of a unit is the model of that side with the lowest mean logarithm of this measure on
    the other units: the numbers of a unit do not choose what it is judged by.
    """
    table = measured([family])
    by_name = table.set_index(["unit", "seed"]).groupby(["model", "measure"])["value"]
    found: dict[tuple[Any, ...], pd.Series] = dict(iter(by_name))
    for side, measure in product(_SIDES, BEST_MEASURES):
        best = best_of(table, side, measure)
        if len(best):
            found[side, measure] = best["value"]
    return found


def best_of(table: pd.DataFrame, side: str, measure: str) -> pd.DataFrame:
    """Return the best model of one side for each unit, chosen on the others, and its numbers.

    Parameters
    ----------
    table : DataFrame
        See ``measurements.measured``, of one family.

    Returns
    -------
    DataFrame
        Index ``unit`` and ``seed``; columns ``model`` and ``value``. Empty if there are fewer than
        two units, or not one model has all numbers.
    """
    number, left_out = _SIDES[side]
    names = [pair[number] for pair in SIDES.values() if pair[number] not in left_out]
    rows = table[(table["measure"] == measure) & table["model"].isin(names)]
    wide = np.log(rows.pivot(index=["unit", "seed"], columns="model", values="value"))
    wide = wide.reindex(columns=[name for name in names if name in wide]).dropna(axis=1)
    units = wide.groupby(level="unit").mean()
    if len(units) < 2 or units.empty:
        return pd.DataFrame(columns=["model", "value"])
    others = (units.sum() - units) / (len(units) - 1)
    best = others.idxmin(axis=1).reindex(wide.index.get_level_values("unit")).to_numpy()
    values = [wide.loc[at, name] for at, name in zip(wide.index, best, strict=True)]
    return pd.DataFrame({"model": best, "value": np.exp(values)}, index=wide.index)


def best_page(families: Sequence[Mapping[str, Any]]) -> pd.DataFrame:
    """Return the best model of each side by rigs and measure, with its mean error."""
    rows = []
    for family in families:
        table = measured([family])
        for measure in BEST_MEASURES:
            row = {"Rigs": family_title(family["name"]), "Error": MEASURES[measure]}
            for side in ("without_p_o", "with_p_o"):
                best = best_of(table, side, measure)
                names = best["model"].value_counts().index[:1]
                means = best["value"].groupby(level="unit").mean() if len(best) else best["value"]
                text = f"{three_digits(means.mean())}, {title_of(names[0])}" if len(best) else "-"
                row[model_title(side)] = text
            rows.append(row)
    return pd.DataFrame(rows)


#: What the ratios of the short table are, by claim; its parts in their order.
_WORTH = {
    "W1": ["unseen parts of the same motions"],
    "W2": ["another motion", "another motion, reversed"],
    "W3": ["tracking, open loop", "tracking, closed loop"],
    "W4": ["FPRC over the best other model with P_o"],
}


def worth_page(verdicts: pd.DataFrame) -> pd.DataFrame:
    """Return the ratios of W1 to W4 by rigs, one row each; undecided ones in brackets."""
    page: dict[str, dict[str, str]] = {}
    for (name, title), parts in verdicts.groupby(["id", "title"], sort=False):
        for what, row in zip(_WORTH.get(name, []), parts.itertuples(), strict=False):
            within = row.low <= 1.0 <= row.high
            text = three_digits(row.mean) or "-"
            page.setdefault(what, {})[title] = f"({text})" if within else text
    return pd.DataFrame(page).T.reset_index(names="With P_o over without, best of each")


def memory_page(families: Sequence[Mapping[str, Any]]) -> pd.DataFrame:
    """Return memory and nonlinear capacity of P_o and of theta, mean and 95 % interval, by rigs."""
    table = measured(families)
    table = table[table["model"].isin(["p_o", "theta"])]
    by_unit = table.groupby(["world", "model", "measure", "unit"], sort=False)["value"].mean()
    words = {"memory_s": "memory [s]", "nonlinear": "nonlinear capacity"}
    page: dict[str, dict[str, str]] = {}
    for (world, model, measure), values in by_unit.groupby(level=[0, 1, 2], sort=False):
        ends = dict(zip(("mean", "low", "high"), interval_of_mean(values.to_numpy()), strict=True))
        heading = f"{'P_o' if model == 'p_o' else 'theta'}: {words[measure]}"
        page.setdefault(family_title(world), {})[heading] = format_mean(ends, "mean")
    return pd.DataFrame(page).T.reset_index(names="Rigs")
