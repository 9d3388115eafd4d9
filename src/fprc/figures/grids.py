"""Figures 10 and 11: errors and times over settings of models."""

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Patch, Rectangle
from pandas import DataFrame

from fprc import escape
from fprc.figures.style import MARK, MARK_PT, PHASES, line_of
from fprc.registry import title_of

_PHASES = {"train": "training", "validation": "validation", "test": "test"}
#: Share of the cells whose errors have colours of their own; larger errors share the last colour.
_CLIPPED = 0.9
#: Colours of the frames of two cells, by what they frame.
_FRAMES = {"lowest error": MARK, "setting of the paper": "white"}


def plot_over(table: DataFrame, ax: Axes, *, times: bool = False) -> None:
    """Draw training, validation and test RMSE, or execution times, over a setting.

    A line style is a model, a marker is a phase. The standard deviation of an error is a band
    either way, that of a time a bar: on a logarithmic axis, a band that reaches below zero would
    cover the rest. If there are several models, each is named at the end of its first phase.

    Parameters
    ----------
    table : DataFrame
        ``model``, ``value`` of the setting, ``phase``, ``mean``, ``std``, ``unit``.
    """
    ends: dict[str, tuple[float, float]] = {}
    for (model, phase), rows in table.groupby(["model", "phase"], sort=False):
        rows = rows.sort_values("value")
        x, mean, std = rows["value"], rows["mean"], rows["std"]
        look = line_of(model)
        ends.setdefault(model, (x.iloc[-1], mean.iloc[-1]))
        label = _PHASES[phase] if len(ends) == 1 else ""
        ax.plot(x, mean, **look, **PHASES[phase], linewidth=0.8, label=label)
        if times:
            ax.errorbar(x, mean, yerr=std, fmt="none", ecolor=look["color"], elinewidth=0.6)
        else:
            ax.fill_between(x, mean - std, mean + std, color=look["color"], alpha=0.3, linewidth=0)
    ax.margins(y=0.12)
    if len(ends) > 1:
        upwards = sorted(ends, key=lambda model: ends[model][1])
        for model, shift in zip(upwards, np.linspace(-4.0, 4.0, len(ends)), strict=True):
            ax.annotate(title_of(model), ends[model], (8.0, shift), va="center",
                        textcoords="offset points")  # fmt: skip
    if times:
        ax.set_yscale("log")
        ax.set_ylim(table["mean"].min() / 2.0, 2.0 * table["mean"].max())
    quantity = "Time" if times else "RMSE"
    ax.set_ylabel(f"{quantity} [{escape.figure(table['unit'].iloc[0])}]")


def plot_grid(table: DataFrame, phase: str, ax: Axes, papers: tuple[int, int]) -> None:
    """Draw the RMSE of one phase over n_u and n_y as a coloured grid.

    The lowest cell and that of the paper's setting are framed and have their numbers.

    Parameters
    ----------
    papers : (int, int)
        n_u and n_y of the paper; not drawn if the grid does not contain them.
    """
    grid = table[table["phase"] == phase].pivot(index="n_y", columns="n_u", values="mean")
    values = grid.to_numpy()
    last = float(np.quantile(values, _CLIPPED))
    image = ax.pcolormesh(grid.columns, grid.index, grid, cmap="cividis", shading="nearest",
                          vmin=values.min(), vmax=last)  # fmt: skip
    row, column = np.unravel_index(np.argmin(values), grid.shape)
    lowest, of_paper = _FRAMES.values()
    cells = {papers: of_paper, (grid.columns[column], grid.index[row]): lowest}
    for (n_u, n_y), colour in cells.items():
        if n_u in grid.columns and n_y in grid.index:
            value = grid.loc[n_y, n_u]
            ax.add_patch(Rectangle((n_u - 0.5, n_y - 0.5), 1, 1, fill=False, edgecolor=colour,
                                   linewidth=1.2, clip_on=False))  # fmt: skip
            dark = value < (values.min() + last) / 2
            ax.text(n_u, n_y, f"{value:.1f}", ha="center", va="center", fontsize=MARK_PT,
                    color="white" if dark else "black")  # fmt: skip
    ax.set(xlabel="$n_u$", ylabel="$n_y$", xticks=grid.columns, yticks=grid.index)
    ax.tick_params(length=0)  # beside a number a tick looks like a minus sign
    unit = escape.figure(table["unit"].iloc[0])
    ax.set_title(f"{_PHASES[phase].capitalize()} RMSE [{unit}]")
    ax.figure.colorbar(image, ax=ax, pad=0.02, extend="max", aspect=30)


def explain_frames(fig: Figure) -> None:
    """Put a key to the frames of ``plot_grid`` above the grids, on grey as one frame is white."""
    frames = [Patch(fill=False, edgecolor=colour, linewidth=1.2) for colour in _FRAMES.values()]
    fig.legend(frames, _FRAMES, loc="outside upper right", ncols=2, frameon=True, facecolor="0.75",
               edgecolor="none", handlelength=0.9, handleheight=0.9)  # fmt: skip
