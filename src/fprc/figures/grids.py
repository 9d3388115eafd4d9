"""Figures 10 and 11: errors and times over the settings of the models."""

import numpy as np
from matplotlib.axes import Axes
from matplotlib.patches import Rectangle
from pandas import DataFrame

from fprc import escape
from fprc.figures.style import COLOURS

_PHASES = {"train": "Training", "validation": "Validation", "test": "Test"}
_STYLES = {"fprc": "-", "fuzzy_linear": "--"}
_MARKERS = {"train": "o", "validation": "s", "test": "^"}


def plot_errors_over(table: DataFrame, setting: str, label: dict[str, str], ax: Axes) -> Axes:
    """Draw training, validation and test RMSE over a setting, one line style per model.

    Parameters
    ----------
    table : DataFrame
        ``model``, the setting, ``phase``, ``mean``, ``std``, ``unit``.
    """
    _plot_over(table, setting, label, ax)
    ax.set_ylabel(f"RMSE [{escape.figure(table['unit'].iloc[0])}]")
    return ax


def plot_times_over(table: DataFrame, setting: str, label: dict[str, str], ax: Axes) -> Axes:
    """Draw training and test times over a setting; ``table`` is as for ``plot_errors_over``."""
    _plot_over(table, setting, label, ax)
    ax.set_ylabel("Time [s]")
    ax.set_yscale("log")
    return ax


def _plot_over(table: DataFrame, setting: str, label: dict[str, str], ax: Axes) -> None:
    for (model, phase), rows in table.groupby(["model", "phase"], sort=False):
        rows = rows.sort_values(setting)
        ax.errorbar(
            rows[setting], rows["mean"], yerr=rows["std"], color=COLOURS[phase],
            linestyle=_STYLES[model], marker=_MARKERS[phase], markersize=2.5, linewidth=0.8,
            capsize=1.5, label=f"{label[model]}{_PHASES[phase]}",
        )  # fmt: skip


def plot_grid(table: DataFrame, phase: str, ax: Axes) -> Axes:
    """Draw the RMSE of one phase over n_u and n_y as a coloured grid.

    Every cell shows its number; the lowest is framed.
    """
    grid = table[table["phase"] == phase].pivot(index="n_y", columns="n_u", values="mean")
    image = ax.pcolormesh(grid.columns, grid.index, grid, cmap="cividis", shading="nearest")
    middle = (grid.to_numpy().max() + grid.to_numpy().min()) / 2.0
    for n_y, row in grid.iterrows():
        for n_u, value in row.items():
            shade = "black" if value > middle else "white"
            ax.text(n_u, n_y, f"{value:.1f}", ha="center", va="center", fontsize=4.2, color=shade)
    best_y, best_u = np.unravel_index(np.argmin(grid.to_numpy()), grid.shape)
    corner = grid.columns[best_u] - 0.5, grid.index[best_y] - 0.5
    ax.add_patch(Rectangle(corner, 1, 1, fill=False, edgecolor="#d62728", linewidth=1.2))
    ax.set(xlabel="$n_u$", ylabel="$n_y$", xticks=grid.columns, yticks=grid.index)
    ax.tick_params(length=0)  # beside a number a tick looks like a minus sign
    unit = escape.figure(table["unit"].iloc[0])
    ax.figure.colorbar(image, ax=ax, label=f"{_PHASES[phase]} RMSE [{unit}]", pad=0.02)
    return ax
