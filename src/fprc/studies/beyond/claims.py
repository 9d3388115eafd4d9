"""Claims W1-W4, B1, B4, B7 and B8: what P_o is worth, and what FPRC's readout is worth."""

from collections.abc import Mapping, Sequence
from itertools import product
from typing import Any

import numpy as np
import pandas as pd

from fprc.registry import SIDES, title_of
from fprc.studies.verdicts import Claim, Numbers, Pair

#: Measures of every model, as readers see them, with their units; errors are RMSE.
MEASURES = {
    "train": "training [kPa]",
    "blocks": "unseen blocks [kPa]",
    "forward": "forward test [kPa]",
    "reversed": "reversed test [kPa]",
    "open_loop": "open loop [deg]",
    "closed_loop": "closed loop [deg]",
}

#: Measures by which the best model of each side is chosen and judged.
BEST_MEASURES = ("blocks", "forward", "reversed", "open_loop", "closed_loop")

#: Best models of a side: for readers, their number among the two of ``SIDES``, what is left out.
_BEST: Mapping[str, tuple[str, int, Sequence[str]]] = {
    "with_p_o": ("Best with P_o", 1, ()),
    "without_p_o": ("Best without P_o", 0, ()),
    "other_p_o": ("Best other with P_o", 1, ("fprc",)),
}


def model_title(name: str) -> str:
    """Return the name of a model, or of the best ones, for readers."""
    return _BEST[name][0] if name in _BEST else title_of(name)


def _pairs(ours: str, other: str, *measures: str, shift: str = "", note: str = "") -> list[Pair]:
    return [
        Pair(
            (ours, measure + shift),
            (other, measure),
            f"{model_title(ours)} / {model_title(other)} ({measure.replace('_', ' ')}{note})",
        )
        for measure in measures
    ]


_LOOPS = ("open_loop", "closed_loop")
_FPRC = dict.fromkeys(("tables", "orders"), "FPRC")
_P_O = {"C8": "P_o"}
CLAIMS = {
    "W1": Claim(
        "P_o is worth a sensor, on unseen parts of the same motions",
        _pairs("with_p_o", "without_p_o", "blocks"),
        _P_O,
    ),
    "W2": Claim(
        "P_o is worth a sensor, forward and reversed",
        _pairs("with_p_o", "without_p_o", "forward", "reversed"),
        _P_O,
    ),
    "W3": Claim(
        "P_o is worth a sensor in tracking, open and closed loop",
        _pairs("with_p_o", "without_p_o", *_LOOPS),
        _P_O,
    ),
    "W4": Claim(
        "FPRC beats the best other model of the same inputs, forward",
        _pairs("fprc", "other_p_o", "forward"),
        _FPRC,
    ),
    "B1": Claim(
        "P_o beats low-passed theta_d, forward",
        _pairs("fprc", "fprc_lowpass", "forward"),
        _FPRC | _P_O,
    ),
    "B4": Claim(
        "the fuzzy readout beats a ridge on the same features, forward",
        _pairs("fprc", "ridge_p_o", "forward"),
        _FPRC,
    ),
    "B7": Claim(
        "FPRC whose P_o is 2 kPa low still beats Fuzzy-linear, forward and in tracking, open and "
        "closed loop",
        _pairs("fprc", "fuzzy_linear", "forward", *_LOOPS, shift="/-2", note=", P_o 2 kPa low"),
        _FPRC | dict.fromkeys((*_LOOPS, "closed_sweep"), "FPRC"),
    ),
    "B8": Claim(
        "P_o has a nonlinear capacity of 0.1 or more, and its low-passes more memory than those of "
        "theta",
        [
            Pair(("threshold", "nonlinear"), ("p_o", "nonlinear"), "0.1 / nonlinear capacity"),
            Pair(("theta", "memory_s"), ("p_o", "memory_s"), "memory of theta / of P_o"),
        ],
        _P_O,
    ),
}


def measured(families: Sequence[Mapping[str, Any]]) -> pd.DataFrame:
    """Return every number of the models in families, tidy.

    Returns
    -------
    DataFrame
        ``family``, ``unit``, ``model``, ``measure`` and ``value``, see ``contest.judge_models``.
        What was not measured has no row, and neither has a model that could not be judged.
    """
    rows = [
        (family["name"], cell["unit"], model, measure, value)
        for family in families
        for cell in family["cells"]
        for model, report in cell.get("models", {}).items()
        if "failed" not in report
        for measure, value in report.items()
    ]
    columns = ["family", "unit", "model", "measure", "value"]
    return pd.DataFrame(rows, columns=columns).astype({"value": float})


def numbers_of(family: Mapping[str, Any]) -> Numbers:
    """Return the numbers of a family by model and measure, those of the best of each side too.

    The best of a unit is the model of that side with the lowest mean logarithm of this measure on
    the other units: the numbers of a unit do not choose what it is judged by.
    """
    table = measured([family])
    by_name = table.set_index("unit").groupby(["model", "measure"])["value"]
    found: dict[tuple[Any, ...], pd.Series] = dict(iter(by_name))
    for side, measure in product(_BEST, BEST_MEASURES):
        best = best_of(table, side, measure)
        if len(best):
            found[side, measure] = best["value"]
    return found


def best_of(table: pd.DataFrame, side: str, measure: str) -> pd.DataFrame:
    """Return the best model of one side for each unit, chosen on the others, and its numbers.

    Parameters
    ----------
    table : DataFrame
        See ``measured``, of one family.

    Returns
    -------
    DataFrame
        Index ``unit``; columns ``model`` and ``value``. Empty if there are fewer than two units, or
        not one model has all numbers.
    """
    _, number, left_out = _BEST[side]
    names = [pair[number] for pair in SIDES.values() if pair[number] not in left_out]
    rows = table[(table["measure"] == measure) & table["model"].isin(names)]
    units = np.log(rows.pivot(index="unit", columns="model", values="value"))
    units = units.reindex(columns=[name for name in names if name in units]).dropna(axis=1)
    if len(units) < 2 or units.empty:
        return pd.DataFrame(columns=["model", "value"])
    best = (units.sum() - units).idxmin(axis=1)
    values = [units.loc[at, name] for at, name in best.items()]
    return pd.DataFrame({"model": best, "value": np.exp(values)}, index=units.index)
