"""Figures 10 and 11: errors and times over settings of models."""

from collections.abc import Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.cm import ScalarMappable
from matplotlib.colors import BoundaryNorm
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch, Rectangle
from matplotlib.ticker import MaxNLocator
from pandas import DataFrame

from fprc import escape
from fprc.figures.style import MARK, PHASES, line_of
from fprc.registry import title_of

_PHASES = {"train": "training", "validation": "validation", "test": "test"}
#: Edges of the grids' colours, as shares of the errors' range on a logarithmic scale.
_EDGES = np.linspace(0.0, 1.0, 11) ** 2
#: Colours of the frames of two cells, by what they frame.
_FRAMES = {"lowest": MARK, "paper's setting": "white"}


def plot_over(table: DataFrame, ax: Axes, *, times: bool = False) -> None:
    """Draw training, validation and test RMSE, or execution times, over a setting.

    A line style is a model, a marker is a phase. The standard deviation of an error is a band
    either way, that of a time a bar: on a logarithmic axis, a band that reaches below zero would
    cover the rest.

    Parameters
    ----------
    table : DataFrame
        ``model``, ``value`` of the setting, ``phase``, ``mean``, ``std``, ``unit``.
    """
    for (model, phase), rows in table.groupby(["model", "phase"], sort=False):
        rows = rows.sort_values("value")
        x, mean, std = rows["value"], rows["mean"], rows["std"]
        look = line_of(model)
        ax.plot(x, mean, **look, **PHASES[phase], linewidth=0.8)
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


def explain_lines(fig: Figure, models: Sequence[str], spread: str) -> None:
    """Put a key to the lines, markers and bands of ``plot_over`` above the figure."""
    marks: list[Any] = [Line2D([], [], **line_of(model)) for model in models]
    marks += [Line2D([], [], color="black", linestyle="", **look) for look in PHASES.values()]
    names = [*map(title_of, models), *_PHASES.values(), spread]
    fig.legend([*marks, Patch(facecolor="0.7")], names, loc="outside upper center", ncols=3,
               handlelength=2.2, columnspacing=1.2)  # fmt: skip


def plot_grids(table: DataFrame, axes: Sequence[Axes], papers: tuple[int, int]) -> ScalarMappable:
    """Draw the RMSE of each phase over n_u and n_y as a coloured grid; return the colours.

    All grids share the colours, which are closer together at small errors, so that neither these
    nor the largest look alike. The lowest cell and that of the paper's setting are framed, and the
    titles have their numbers.

    Parameters
    ----------
    papers : (int, int)
        n_u and n_y of the paper; not drawn if the grid does not contain them.
    """
    least, most = table["mean"].min(), max(table["mean"].max(), 1.01 * table["mean"].min())
    norm = BoundaryNorm(least * (most / least) ** _EDGES, 256)
    colours = ScalarMappable(norm, "cividis")
    for ax, phase in zip(axes, PHASES, strict=True):
        rows = table[table["phase"] == phase]
        grid = rows.pivot(index="n_y", columns="n_u", values="mean")
        ax.pcolormesh(grid.columns, grid.index, grid, cmap=colours.cmap, norm=norm,
                      shading="nearest")  # fmt: skip
        lowest = rows.loc[rows["mean"].idxmin()]
        cells = [(lowest["n_u"], lowest["n_y"]), papers]
        numbers = []
        for (n_u, n_y), colour in zip(cells, _FRAMES.values(), strict=True):
            if n_u in grid.columns and n_y in grid.index:
                numbers.append(f"{grid.loc[n_y, n_u]:.1f}")
                ax.add_patch(Rectangle((n_u - 0.5, n_y - 0.5), 1, 1, fill=False, clip_on=False,
                                       edgecolor=colour, linewidth=1.0))  # fmt: skip
        # on two lines, as a panel is not as wide as both
        ax.set_title(f"{_PHASES[phase].capitalize()}\n{', '.join(numbers)}", loc="left")
        ax.set(xlabel="$n_u$", ylabel="$n_y$")
        ax.xaxis.set_major_locator(MaxNLocator(5, integer=True))
        ax.yaxis.set_major_locator(MaxNLocator(5, integer=True))
    return colours


def explain_grids(fig: Figure, axes: Sequence[Axes], colours: ScalarMappable, unit: str) -> None:
    """Put a bar for the colours below the grids, and a key to the frames above them.

    The key is on grey as one frame is white.
    """
    bar = fig.colorbar(colours, ax=axes, location="bottom", aspect=40, format="%.3g")
    bar.set_label(f"RMSE [{escape.figure(unit)}]")
    frames = [Patch(fill=False, edgecolor=colour, linewidth=1.2) for colour in _FRAMES.values()]
    fig.legend(frames, _FRAMES, loc="outside upper right", ncols=2, frameon=True, facecolor="0.7",
               edgecolor="none", handlelength=0.9, handleheight=0.9)  # fmt: skip
