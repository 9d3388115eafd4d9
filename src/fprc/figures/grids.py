"""Figures 10 and 11: errors and times over settings of models."""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.cm import ScalarMappable
from matplotlib.colors import BoundaryNorm
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch, Rectangle
from matplotlib.ticker import MaxNLocator
from pandas import DataFrame, concat

from fprc import escape
from fprc.figures import style
from fprc.given import read_json, read_yaml
from fprc.intervals import mean_and_std
from fprc.paper import GRID_SETTINGS, PUBLISHED
from fprc.registry import title_of

_PHASES = {"train": "training", "validation": "validation", "test": "test"}
#: Panels of Fig. 10: title, and label and base of the axis of the setting.
_PANELS = {
    "a": ("Errors of FPRC", r"$\epsilon$", 10),
    "b": ("Errors", "$n_c$", 2),
    "c": ("Execution times, batch", "$n_c$", 2),
}
#: Edges of the grids' colours, as shares of the errors' range on a logarithmic scale.
_EDGES = np.linspace(0.0, 1.0, 11) ** 2
#: Colours of the frames of two cells, by what they frame.
_FRAMES = {"lowest": style.MARK, "paper's setting": "white"}


def draw_grids(
    grids: Sequence[str], times: str, fig10: Sequence[str], fig11: Sequence[str] = ()
) -> None:
    """Figures 10 and 11: errors over epsilon, n_c and the taps, execution times over n_c.

    The errors are over further seeds, or over the folds of one report. Without FPRC there are no
    errors over epsilon and over the taps.
    """
    reports, timed = [read_json(path) for path in grids], read_json(times)
    several = len(reports) > 1
    marks = {"seeds": [report["seed"] for report in reports]} if several else reports[0]
    batch = (entry for entry in timed["times"] if entry["mode"] == "batch")
    rows = (_row(x, "n_c", x["phase"], x["seconds"], "s", timed["source"]) for x in batch)
    panels = {"a": _grid_errors(reports, "epsilon"), "b": _grid_errors(reports, "n_c")}
    panels = {panel: table for panel, table in panels.items() if not table.empty}
    panels["c"] = DataFrame(rows)
    shown = concat(panels, names=["panel"]).reset_index("panel")
    fig = _draw_settings(panels, f"± std over {'seeds' if several else 'folds'}")
    style.save(fig, marks, *fig10, table=shown)
    if fig11:
        table = _grid_errors(reports, "taps")
        printed = read_yaml(PUBLISHED)["table_1_configuration"]
        papers = printed["fprc"]["n_u"], printed["shared"]["n_y"]
        style.save(_draw_taps(table, papers), marks, *fig11, table=table)


def _grid_errors(reports: Sequence[Mapping[str, Any]], grid: str) -> DataFrame:
    """Mean and standard deviation of each phase's RMSE over the settings of a grid, tidy.

    They are over further seeds, a report each, or over the folds of one report.
    """
    unit, source = reports[0].get("unit", "kPa"), reports[0]["source"]
    return DataFrame(
        _row(cells[0], grid, phase, [cell[f"{phase}_rmse_kpa"] for cell in cells], unit, source)
        for cells in zip(*(report[grid] for report in reports), strict=True)
        for phase in _PHASES
    )


def _row(
    cell: Mapping[str, Any], grid: str, phase: str, values: Any, unit: str, source: str
) -> dict[str, Any]:
    several = {name: cell[name] for name in GRID_SETTINGS[grid]}
    setting = several if len(several) > 1 else {"setting": grid, "value": cell[grid]}
    mean, std = mean_and_std(values)
    spread = {"mean": mean, "std": std, "values": np.size(values)}
    named = {"model": cell["model"], **setting, "phase": phase}
    return {**named, **spread, "unit": unit, "source": source}


def _draw_settings(panels: Mapping[str, DataFrame], spread: str) -> Figure:
    """Figure 10, the tables of its panels, one above the other; ``spread`` says what a band is."""
    fig, axes = style.figure(len(panels), 1, style.COLUMN_IN, 4.6 if "a" in panels else 3.4)
    for (panel, table), ax in zip(panels.items(), axes, strict=True):
        title, label, base = _PANELS[panel]
        _plot_over(table, ax, times=panel == "c")
        style.letter(ax, f"({panel}) {title}")
        ax.set_xscale("log", base=base)
        ax.set_xlabel(label)
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


def _plot_over(table: DataFrame, ax: Axes, *, times: bool) -> None:
    """Draw errors with bands of their standard deviation, or times with bars, over a setting.

    On the logarithmic axis of times, a band that reaches below zero would cover the rest.
    """
    for (model, phase), rows in table.groupby(["model", "phase"], sort=False):
        rows = rows.sort_values("value")
        x, mean, std = rows["value"], rows["mean"], rows["std"]
        look = style.line_of(model)
        ax.plot(x, mean, **look, **style.PHASES[phase], linewidth=0.8)
        if times:
            ax.errorbar(x, mean, yerr=std, fmt="none", ecolor=look["color"], elinewidth=0.6)
        else:
            ax.fill_between(x, mean - std, mean + std, color=look["color"], alpha=0.3, linewidth=0)
    ax.margins(y=0.12)
    if times:
        ax.set_yscale("log")
        ax.set_ylim(table["mean"].min() / 2.0, 2.0 * table["mean"].max())
    quantity = "Time" if times else "RMSE"
    ax.set_ylabel(f"{quantity} [{escape.figure(table['unit'].iloc[0])}]")


def _draw_taps(table: DataFrame, papers: tuple[int, int]) -> Figure:
    """Figure 11: the RMSE of each phase over n_u and n_y as a coloured grid.

    All grids share the colours, which are closer together at small errors, so that neither these
    nor the largest look alike. The lowest cell and that of the paper's setting, ``papers``, n_u and
    n_y, are framed, and the titles have their numbers.
    """
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
        style.letter(ax, f"({letter}) {title.capitalize()}\n{', '.join(numbers)}")
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
