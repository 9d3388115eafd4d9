"""Sensitivity of every number that we show to each parameter of the rig, one at a time."""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.collections import QuadMesh
from matplotlib.colors import LogNorm
from pydantic import ValidationError

from fprc.config.rig import Rig
from fprc.errors import FprcError, in_one_line
from fprc.experiments.settings import RigSettings
from fprc.figures.style import symbols
from fprc.paper import MODELS, REFERENCE_NAMES, REFERENCES
from fprc.registry import title_of
from fprc.studies.calibration.space import decode, free_parameters
from fprc.studies.calibration.surrogate import judge_by_surrogate

_MEASURES = ("shares", "open_loop", "closed_loop")
_TABLES = {"sweep": "II", "complex": "III"}

#: Groups of numbers as columns of the page.
_GROUPS = {
    "train": "Training errors", "test": "Test errors", "open_loop": "Open loop",
    "closed_loop": "Closed loop", "shares": "Shares of the weights", "loops": "Loops",
}  # fmt: skip

#: Properties of the loops, as readers see them.
_LOOPS = {
    "angle_deg": "largest angle", "loop_kpa": "width of the loop", "loop_growth": "its growth",
    "measured_loop_growth": "growth, P measured", "p_o_swing_kpa": "swing of P_o",
    "p_o_loop": "width of P_o's loop", "p_o_loop_growth": "its growth ",
}  # fmt: skip


def names_of_numbers() -> dict[tuple[str, str], str]:
    """Return the name of each number by group and key."""
    names = {
        (phase, f"{log}/{model}/{phase}"): f"{number} {title_of(model)}"
        for phase in ("train", "test")
        for log, number in _TABLES.items()
        for model in MODELS
    }
    for loop in ("open_loop", "closed_loop"):
        names |= {(loop, key): REFERENCE_NAMES[key] for key in REFERENCES}
    names["shares", "shares"] = "ratio of the shares"
    return names | {("loops", key): name for key, name in _LOOPS.items()}


def judge_moved(
    cell: Mapping[str, Any],
    *,
    seeds: Sequence[int],
    surrogate: Mapping[str, int],
    on_rig: RigSettings,
    models: Mapping[str, Any],
    tracking: Mapping[str, Any],
) -> dict[str, Any]:
    """Return the surrogate's numbers, means over seeds, on a rig with one parameter changed.

    ``cell`` holds its ``path``, None for no change, and its value as a ``share`` of its range.

    Returns
    -------
    dict
        ``numbers``, by group and key, or with None and why it is ``impossible``.
    """
    moved = on_rig.rig
    if cell["path"] is not None:
        moved = decode(np.array([cell["share"]]), moved, free_parameters([cell["path"]]))
    try:
        Rig.model_validate(moved)
        settings = replace(on_rig, rig=moved)
        judged = [
            judge_by_surrogate(settings, seed, models, surrogate, {}, tracking, _MEASURES)
            for seed in seeds
        ]
    except (ValidationError, FprcError) as error:
        return {"numbers": None, "impossible": in_one_line(error)}
    source = {"train": "errors", "test": "errors", "loops": "properties"}
    numbers: dict[str, dict[str, float]] = {group: {} for group in _GROUPS}
    for group, key in names_of_numbers():
        found = [seed[source.get(group, group)] for seed in judged]
        values = found if group == "shares" else [row[key] for row in found]
        numbers[group][key] = float(np.mean(values))
    return {"numbers": numbers}


def changes(report: Mapping[str, Any]) -> pd.DataFrame:
    """Return all numbers with one parameter changed, relative to those of the rig itself, tidy.

    Raises
    ------
    FprcError
        The rig itself cannot be simulated.
    """
    still = next(cell["numbers"] for cell in report["cells"] if cell["path"] is None)
    if still is None:
        raise FprcError("the rig itself cannot be simulated; correct the section rig")
    return pd.DataFrame(
        {
            "parameter": cell["path"],
            "share_of_range": cell["share"],
            "group": group,
            "number": name,
            "value": cell["numbers"][group][key],
            "change": cell["numbers"][group][key] / still[group][key] - 1.0,
            "source": report["source"],
        }
        for cell in report["cells"]
        if cell["path"] is not None and cell["numbers"] is not None
        for (group, key), name in names_of_numbers().items()
    )


def page_of_changes(table: pd.DataFrame) -> pd.DataFrame:
    """Return the changes at both ends of each parameter's range, strongest parameter first.

    Of each group it is the change of the number that changes most. The closed loop is unstable
    where a reference is followed worse with feedback than without.
    """
    moved = ["parameter", "share_of_range"]
    changed = table.groupby([*moved, "group"])["change"].agg(lambda some: max(some, key=abs))
    texts = changed.map(lambda change: f"{round(100 * change):+d} %").unstack("group")
    errors = table.pivot(index=[*moved, "number"], columns="group", values="value")
    worse = errors["closed_loop"] > errors["open_loop"]
    texts["closed_loop"] = texts["closed_loop"].mask(worse.groupby(moved).any(), "unstable")
    ends = texts.groupby("parameter")
    page = ends.first() + ", " + ends.last()
    strongest = _largest(table).max(axis=1).sort_values(ascending=False).index
    return page.loc[strongest, list(_GROUPS)].rename(columns=_GROUPS).reset_index(names="Parameter")


def plot_changes(table: pd.DataFrame, ax: Axes) -> QuadMesh:
    """Draw the largest change of each number, a row per parameter and a column per number."""
    grid = _largest(table)[list(_in_order())]
    grid = grid.loc[grid.max(axis=1).sort_values(ascending=False).index]
    values = 100 * grid.to_numpy(float).clip(0.01)
    image = ax.pcolormesh(values, cmap="Greys", norm=LogNorm(1.0, 100.0))
    groups = [group for group, _ in grid.columns]
    for column in range(1, len(groups)):
        if groups[column] != groups[column - 1]:
            ax.axvline(column, color="tab:blue", linewidth=0.8)
    names = [symbols(name) for _, name in grid.columns]
    ax.set_xticks(np.arange(grid.shape[1]) + 0.5, names, rotation=90)
    ax.set_yticks(np.arange(grid.shape[0]) + 0.5, grid.index)
    ax.set_ylim(grid.shape[0], 0)
    ax.tick_params(length=0, labelsize=6.0)
    for group, title in _GROUPS.items():
        if group in groups:
            middle = groups.index(group) + groups.count(group) / 2
            ax.text(
                middle,
                -0.4,
                title.split()[0] if group == "shares" else title,
                ha="center",
                fontsize=6,
            )
    return image


def _in_order() -> list[tuple[str, str]]:
    return [(group, name) for (group, _), name in names_of_numbers().items()]


def _largest(table: pd.DataFrame) -> pd.DataFrame:
    """Return the largest absolute change, by parameter and by (group, number)."""
    by = table.assign(change=table["change"].abs()).groupby(["parameter", "group", "number"])
    return by["change"].max().unstack(["group", "number"])
