"""Figures 10 and 11: errors and times over settings of models."""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from matplotlib.cm import ScalarMappable
from matplotlib.colors import BoundaryNorm
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch, Rectangle
from matplotlib.ticker import MaxNLocator
from pandas import DataFrame, Series, concat

from fprc import escape
from fprc.figures import style
from fprc.given import read_yaml
from fprc.paper import GRID_SETTINGS, PUBLISHED
from fprc.registry import title_of

_PHASES = {"train": "training", "validation": "validation", "test": "test"}
#: Panels of Fig. 10: title, label and base of the axis of the setting, and what is shown.
_PANELS = {
    "a": ("Errors of FPRC", r"$\epsilon$", 10, "RMSE"),
    "b": ("Errors", "$n_c$", 2, "RMSE"),
    "c": ("Execution times, batch", "$n_c$", 2, "Time"),
}
#: Edges of the grids' colours, as shares of the errors' range on a logarithmic scale.
_EDGES = np.linspace(0.0, 1.0, 11) ** 2
#: Colours of the frames of two cells, by what they frame.
_FRAMES = {"lowest": style.MARK, "paper's setting": "white"}


def draw_grids(
    reports: Sequence[Mapping[str, Any]], timed: Mapping[str, Any],
    fig10: Sequence[str], fig11: Sequence[str] = (),
) -> None:  # fmt: skip
    """Figures 10 and 11: errors over epsilon, n_c and the taps, execution times over n_c.

    The errors are over further seeds, or over the folds of one report. Without FPRC there are no
    errors over epsilon and over the taps.
    """
    several = len(reports) > 1
    marks = {"seeds": [report["seed"] for report in reports]} if several else reports[0]
    batch = DataFrame(entry for entry in timed["times"] if entry["mode"] == "batch")
    batch = batch.set_index(["model", "n_c", "phase"])["seconds"]
    panels = {"a": _errors(reports, "epsilon"), "b": _errors(reports, "n_c")}
    panels = {panel: table for panel, table in panels.items() if not table.empty}
    panels["c"] = _statistics(batch, "n_c", "s", timed["source"])
    shown = concat(panels, names=["panel"]).reset_index("panel")
    fig = _draw_settings(panels, f"± std over {'seeds' if several else 'folds'}")
    style.save(fig, marks, *fig10, table=shown)
    if fig11:
        taps = _errors(reports, "taps")
        style.save(_draw_taps(taps), marks, *fig11, table=taps)


def _errors(reports: Sequence[Mapping[str, Any]], grid: str) -> DataFrame:
    """Statistics of each phase's RMSE over further seeds, a report each, or over folds."""
    unit = reports[0].get("unit", "kPa")
    cells = DataFrame(cell for report in reports for cell in report[grid])
    if cells.empty:
        return cells
    cells = cells.set_index(["model", *GRID_SETTINGS[grid]]).rename_axis(columns="phase")
    cells = cells.rename(columns={f"{phase}_rmse_kpa": phase for phase in _PHASES})
    return _statistics(cells[[*_PHASES]].stack(), grid, unit, reports[0]["source"])


def _statistics(values: Series, grid: str, unit: str, source: str) -> DataFrame:
    """Mean and standard deviation of values by model, setting of a grid and phase, tidy."""
    groups = values.explode().astype(float).groupby(level=values.index.names, sort=False)
    table = groups.agg(["mean", "std", "count"]).reset_index()
    if grid != "taps":
        table = table.rename(columns={grid: "value"})
        table.insert(1, "setting", grid)
    return table.rename(columns={"count": "values"}).assign(unit=unit, source=source)


def _draw_settings(panels: Mapping[str, DataFrame], spread: str) -> Figure:
    """Draw Fig. 10, the tables of its panels, one above the other; ``spread``: what a band is.

    Errors have bands of their standard deviation, times bars: on a logarithmic axis, a band that
    reaches below zero would cover the rest.
    """
    fig, axes = style.figure(len(panels), 1, style.COLUMN_IN, 4.6 if "a" in panels else 3.4)
    for (panel, table), ax in zip(panels.items(), axes, strict=True):
        for (model, phase), rows in table.groupby(["model", "phase"], sort=False):
            rows = rows.sort_values("value")
            x, mean, std = rows["value"], rows["mean"], rows["std"]
            look = style.line_of(model)
            colour = look["color"]
            ax.plot(x, mean, **look, **style.PHASES[phase], linewidth=0.8)
            if panel == "c":
                ax.errorbar(x, mean, yerr=std, fmt="none", ecolor=colour, elinewidth=0.6)
            else:
                ax.fill_between(x, mean - std, mean + std, color=colour, alpha=0.3, linewidth=0)
        ax.margins(y=0.12)
        title, label, base, quantity = _PANELS[panel]
        if panel == "c":
            ax.set_yscale("log")
            ax.set_ylim(table["mean"].min() / 2.0, 2.0 * table["mean"].max())
        unit = escape.figure(table["unit"].iloc[0])
        ax.set(title=f"({panel}) {title}", xlabel=label, ylabel=f"{quantity} [{unit}]")
        ax.set_xscale("log", base=base)
        if base == 2:
            ax.set_xticks(sorted(table["value"].unique()))
            ax.xaxis.set_major_formatter("{x:g}")
    models = panels["b"]["model"].unique()
    marks: list[Any] = [Line2D([], [], **style.line_of(model)) for model in models]
    marks += [Line2D([], [], color="black", linestyle="", **look) for look in style.PHASES.values()]
    names = [*map(title_of, models), *_PHASES.values(), spread]
    fig.legend([*marks, Patch(facecolor="0.7")], names, loc="outside upper center", ncols=3,
               handlelength=2.2, columnspacing=1.2)  # fmt: skip
    return fig


def _draw_taps(table: DataFrame) -> Figure:
    """Draw Fig. 11: the RMSE of each phase over n_u and n_y as a coloured grid.

    All grids share the colours, which are closer together at small errors, so that neither these
    nor the largest look alike. The titles have the numbers of the framed cells.
    """
    printed = read_yaml(PUBLISHED)["table_1_configuration"]
    papers = printed["fprc"]["n_u"], printed["shared"]["n_y"]
    fig, axes = style.figure(1, 3, style.COLUMN_IN, 2.5, sharey=True)
    least, most = table["mean"].min(), max(table["mean"].max(), 1.01 * table["mean"].min())
    norm = BoundaryNorm(least * (most / least) ** _EDGES, 256)
    colours = ScalarMappable(norm, "cividis")
    for ax, letter, (phase, title) in zip(axes, "abc", _PHASES.items(), strict=True):
        errors = table[table["phase"] == phase].set_index(["n_u", "n_y"])["mean"]
        grid = errors.unstack("n_u")
        ax.pcolormesh(grid.columns, grid.index, grid, cmap=colours.cmap, norm=norm,
                      shading="nearest")  # fmt: skip
        numbers = []
        for cell, colour in zip((errors.idxmin(), papers), _FRAMES.values(), strict=True):
            if cell in errors.index:
                numbers.append(f"{errors[cell]:.1f}")
                ax.add_patch(Rectangle(np.subtract(cell, 0.5), 1, 1, fill=False, clip_on=False,
                                       edgecolor=colour, linewidth=1.0))  # fmt: skip
        # on two lines, as a panel is not as wide as both
        ax.set_title(f"({letter}) {title.capitalize()}\n{', '.join(numbers)}")
        ax.set(xlabel="$n_u$", ylabel="$n_y$")
        for axis in (ax.xaxis, ax.yaxis):
            axis.set_major_locator(MaxNLocator(5, integer=True))
        ax.label_outer()
    bar = fig.colorbar(colours, ax=axes, location="bottom", aspect=40, format="%.3g")
    bar.set_label(f"RMSE [{escape.figure(table['unit'].iloc[0])}]")
    frames = [Patch(fill=False, edgecolor=colour, linewidth=1.2) for colour in _FRAMES.values()]
    # on grey as one frame is white
    fig.legend(frames, _FRAMES, loc="outside upper right", ncols=2, frameon=True, facecolor="0.7",
               edgecolor="none", handlelength=0.9, handleheight=0.9)  # fmt: skip
    return fig
