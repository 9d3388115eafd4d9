"""Sensitivity of every number that we show to each parameter of the rig, one at a time."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from functools import reduce
from operator import getitem
from typing import Any

import numpy as np
import pandas as pd
from matplotlib import colormaps
from matplotlib.axes import Axes
from matplotlib.collections import QuadMesh
from matplotlib.colors import LogNorm
from pydantic import ValidationError

from fprc.config.rig import Rig
from fprc.errors import FprcError, in_one_line
from fprc.experiments.settings import RigSettings, Unit
from fprc.figures.style import symbols
from fprc.paper import LOOPS, MODELS, REFERENCE_NAMES, REFERENCES
from fprc.registry import title_of
from fprc.studies.calibration.space import decode, free_parameters
from fprc.studies.calibration.surrogate import FURTHER, judge_by_surrogate

Judged = Mapping[str, Any]

_MEASURES = ("shares", "epsilon", "n_c", "taps", *FURTHER)
_TABLES = {"sweep": "II", "complex": "III"}

#: Groups of numbers: as columns of the page, and as headings of the figure.
_GROUPS = {
    "train": ("Training errors", "Training errors"),
    "test": ("Test errors", "Test errors"),
    "halves": ("Halves of the reversed test (C7d)", "C7d"),
    "substitutes": ("FPRC over its substitutes (B1, B2, B4)", "B1, 2, 4"),
    "shares": ("Shares of the weights (C8a, C8b)", "C8"),
    "bias": ("Share of the bias (C8c)", ""),
    "grids": ("Grids (C9, C11, C12)", "C9, C11, C12"),
    "open_loop": ("Open loop", "Open loop"),
    "closed_loop": ("Closed loop", "Closed"),
    "control": ("Other numbers of the closed loop (C14 to C17)", "C14 to C17"),
    "pressure": ("Pressure errors (C19)", "C19"),
    "loops": ("Loops (C18)", "Loops (C18)"),
}

#: Groups that mean little where feedback does not help.
_NEED_STABILITY = ["closed_loop", "control"]

#: Properties of the loops, as readers see them.
_LOOPS = {
    "angle_deg": "largest angle", "loop_kpa": "width of the loop", "loop_growth": "its growth",
    "measured_loop_growth": "growth, P measured", "p_o_swing_kpa": "swing of P_o",
    "p_o_loop": "width of P_o's loop", "p_o_loop_growth": "growth of P_o's loop",
    "p_o_swing_growth": "growth of the swing",
}  # fmt: skip


#: Substitutes for P_o, and for the rules, as readers see them.
_SUBSTITUTES = {
    "sweep/fprc_lowpass": "low-passed theta_d", "sweep/bank": "ridge on low-passes",
    "complex/fprc_lowpass": "low-passed, reversed", "sweep/ridge_p_o": "ridge on all features",
}  # fmt: skip


def _at(*keys: str) -> Callable[[Judged], float]:
    def of(judged: Any) -> float:
        return float(reduce(getitem, keys, judged))

    return of


def _over_substitute(key: str) -> Callable[[Judged], float]:
    train, _ = key.split("/")
    return lambda judged: judged["errors"][f"{train}/fprc/test"] / judged["substitutes"][key]


def _largest_ratio(ours: Sequence[float], theirs: Sequence[float]) -> float:
    return float(max(np.divide(ours, theirs), default=1.0))


def _over_medium(judged: Judged, axis: int, end: int) -> float:
    """Return the training error with few or many taps over that with a medium number."""
    means = np.mean(judged["taps"], axis=axis)
    return float(means[end] / means[len(means) // 2])


def _errors(judged: Judged, controller: str) -> list[float]:
    """Return a controller's errors on the references of Fig. 16."""
    return [judged["control"]["rmse_deg"][f"{name}/{controller}"] for name in LOOPS]


def _widths(judged: Judged, controller: str) -> list[float]:
    """Return the widths of a controller's loops on the references of Fig. 16."""
    loops = judged["control"]["loops"]
    return [loops[f"{name}/{controller}"]["width_over_span"] for name in LOOPS]


#: Every number, by group and name. Of several references it is the one nearest to its limit.
NUMBERS: dict[tuple[str, str], Callable[[Judged], float]] = {
    **{
        (phase, f"{table} {title_of(model)}"): _at("errors", f"{log}/{model}/{phase}")
        for phase in ("train", "test")
        for log, table in _TABLES.items()
        for model in MODELS
    },
    **{("halves", title_of(model)): _at("halves", model) for model in MODELS},
    **{("substitutes", name): _over_substitute(key) for key, name in _SUBSTITUTES.items()},
    ("shares", "ratio of the shares"): _at("shares", "p_o_over_theta_d"),
    ("bias", "share of the bias"): _at("bias"),
    # the settings' values fall for epsilon and rise for n_c
    ("grids", "largest step over epsilon"): lambda judged: _largest_ratio(
        judged["epsilon"][:-1], judged["epsilon"][1:]
    ),
    ("grids", "largest step over n_c"): lambda judged: _largest_ratio(
        judged["n_c"]["fprc"]["train"][1:], judged["n_c"]["fprc"]["train"][:-1]
    ),
    ("grids", "FPRC / Fuzzy-linear, training"): lambda judged: _largest_ratio(
        judged["n_c"]["fprc"]["train"], judged["n_c"]["fuzzy_linear"]["train"]
    ),
    ("grids", "FPRC / Fuzzy-linear, test"): lambda judged: _largest_ratio(
        judged["n_c"]["fprc"]["test"], judged["n_c"]["fuzzy_linear"]["test"]
    ),
    ("grids", "few / medium n_u"): lambda judged: _over_medium(judged, 1, 0),
    ("grids", "many / medium n_y"): lambda judged: _over_medium(judged, 0, -1),
    **{
        (loop, REFERENCE_NAMES[name]): _at("control", "rmse_deg", f"{name}/{controller}")
        for loop, controller in (("open_loop", "fprc"), ("closed_loop", "fprc_pd"))
        for name in REFERENCES
    },
    ("control", "P_fb / P_ff"): lambda judged: max(judged["control"]["effort"].values()),
    ("control", "largest error"): _at("control", "sweep", "largest_error_deg"),
    ("control", "last / first third"): lambda judged: (
        judged["control"]["sweep"]["last_third_deg"] / judged["control"]["sweep"]["first_third_deg"]
    ),
    ("control", "loop of PD"): lambda judged: min(_widths(judged, "pd")),
    ("control", "loop, FPRC+PD / PD"): lambda judged: _largest_ratio(
        _widths(judged, "fprc_pd"), _widths(judged, "pd")
    ),
    ("control", "error, FPRC+PD / PD"): lambda judged: _largest_ratio(
        _errors(judged, "fprc_pd"), _errors(judged, "pd")
    ),
    ("control", "bending, pushed"): _at("control", "disturbance", "bending"),
    ("control", "P_o, pushed"): _at("control", "disturbance", "p_o"),
    ("control", "error, pushed / not"): _at("control", "disturbance", "error_ratio"),
    ("pressure", "actuator"): _at("control", "pressure_error", "main"),
    ("pressure", "reservoir"): _at("control", "pressure_error", "reservoir"),
    **{("loops", name): _at("properties", key) for key, name in _LOOPS.items()},
}


def numbers_of(
    on_rig: RigSettings, centers: Mapping[int, dict[str, np.ndarray]], **how: Any
) -> dict[str, dict[str, float]]:
    """Return the surrogate's numbers on a rig, means over seeds, by group and name.

    ``centers`` are those of ``judge_by_surrogate``, by seed, and ``how`` its settings.
    """
    judged = [
        judge_by_surrogate(on_rig, seed, _MEASURES, of_seed, **how)
        for seed, of_seed in centers.items()
    ]
    numbers: dict[str, dict[str, float]] = {group: {} for group in _GROUPS}
    for (group, name), number in NUMBERS.items():
        numbers[group][name] = float(np.mean([number(seed) for seed in judged]))
    return numbers


def judge_parameter(
    unit: Unit, *, paths: Sequence[str], steps: int, seeds: Sequence[int], **how: Any
) -> list[dict[str, Any]]:
    """Move one parameter, that of the unit's number, over its range.

    All clusterings begin at those of the rig itself.

    Parameters
    ----------
    **how
        ``models``, ``grids`` and ``tracking`` of ``judge_by_surrogate``.

    Returns
    -------
    list of dict
        For each value of the parameter, and from the first unit also for the rig itself: the
        ``seeds``, the ``path`` of the parameter, None for no change, and its ``share`` of the
        range; ``numbers``, see ``numbers_of``, or None with why they are ``impossible``.
    """
    on_rig, _ = unit.rigs[0]
    centers: dict[int, dict[str, np.ndarray]] = {seed: {} for seed in seeds}
    numbers_of(on_rig, centers, **how)
    moves: list[tuple[str | None, float | None]] = []
    if unit.number == 0:
        moves.append((None, None))
    moves += [(paths[unit.number], share) for share in np.linspace(0.0, 1.0, steps).tolist()]
    cells = []
    for path, share in moves:
        moved = on_rig.rig
        if path is not None:
            moved = decode(np.array([share]), moved, free_parameters([path]))
        cell: dict[str, Any] = {"seeds": list(seeds), "path": path, "share": share}
        try:
            Rig.model_validate(moved)
            begin = {seed: dict(of_seed) for seed, of_seed in centers.items()}
            cell["numbers"] = numbers_of(replace(on_rig, rig=moved), begin, **how)
        except (ValidationError, FprcError) as error:
            cell |= {"numbers": None, "impossible": in_one_line(error)}
        cells.append(cell)
    return cells


def changes(report: Mapping[str, Any]) -> pd.DataFrame:
    """Return all numbers with one parameter changed, relative to those of the rig itself, tidy."""
    still = next(cell["numbers"] for cell in report["cells"] if cell["path"] is None)
    return pd.DataFrame(
        {
            "parameter": cell["path"],
            "share_of_range": cell["share"],
            "group": group,
            "number": name,
            "value": value,
            "change": value / still[group][name] - 1.0,
            "source": report["source"],
        }
        for cell in report["cells"]
        if cell["path"] is not None and cell["numbers"] is not None
        for group, numbers in cell["numbers"].items()
        for name, value in numbers.items()
    )


def page_of_changes(table: pd.DataFrame) -> pd.DataFrame:
    """Return the changes at both ends of each parameter's range, strongest parameter first.

    Of each group it is the change of the number that changes most. The closed loop is unstable
    where a reference is followed worse with feedback than without.
    """
    moved = ["parameter", "share_of_range"]
    changed = table.groupby([*moved, "group"])["change"].agg(lambda some: max(some, key=abs))
    texts = changed.map(lambda change: f"{round(100 * change):+d} %").unstack("group")
    for group in _NEED_STABILITY:
        texts[group] = texts[group].mask(_unstable(table, moved), "unstable")
    ends = texts.groupby("parameter")
    page = ends.first() + ", " + ends.last()
    strongest = _largest(table).max(axis=1).sort_values(ascending=False).index
    titles = {group: title for group, (title, _) in _GROUPS.items()}
    return page.loc[strongest, list(titles)].rename(columns=titles).reset_index(names="Parameter")


def _unstable(table: pd.DataFrame, by: str | list[str]) -> pd.Series:
    """Return whether some reference is followed worse with feedback than without."""
    cells = ["parameter", "share_of_range", "number"]
    errors = table.pivot(index=cells, columns="group", values="value")
    return (errors["closed_loop"] > errors["open_loop"]).groupby(by).any()


def plot_changes(table: pd.DataFrame, ax: Axes) -> QuadMesh:
    """Draw the largest change of each number, a row per parameter and a column per number.

    Numbers of a loop that becomes unstable are orange.
    """
    grid = _largest(table)[list(NUMBERS)]
    grid = grid.loc[grid.max(axis=1).sort_values(ascending=False).index]
    values = 100 * grid.to_numpy(float).clip(0.01)
    groups = [group for group, _ in grid.columns]
    unstable = _unstable(table, "parameter")[grid.index].to_numpy()
    hidden = unstable[:, None] & np.isin(groups, _NEED_STABILITY)
    colors = colormaps["Greys"].with_extremes(bad="sandybrown")
    image = ax.pcolormesh(np.ma.array(values, mask=hidden), cmap=colors, norm=LogNorm(1.0, 100.0))
    for column in range(1, len(groups)):
        if groups[column] != groups[column - 1]:
            ax.axvline(column, color="tab:blue", linewidth=0.8)
    names = [symbols(name) for _, name in grid.columns]
    ax.set_xticks(np.arange(grid.shape[1]) + 0.5, names, rotation=90)
    ax.set_yticks(np.arange(grid.shape[0]) + 0.5, grid.index)
    ax.set_ylim(grid.shape[0], 0)
    ax.tick_params(length=0, labelsize=6.0)
    for group, (_, heading) in _GROUPS.items():
        middle = groups.index(group) + groups.count(group) / 2
        ax.text(middle, -0.4, heading, ha="center", fontsize=6)
    return image


def _largest(table: pd.DataFrame) -> pd.DataFrame:
    """Return the largest absolute change, by parameter and by (group, number)."""
    by = table.assign(change=table["change"].abs()).groupby(["parameter", "group", "number"])
    return by["change"].max().unstack(["group", "number"])
