"""Claims over an ensemble of rigs: share of rigs on which they hold, and correlations."""

import numpy as np
from matplotlib.axes import Axes
from matplotlib.cm import ScalarMappable
from matplotlib.collections import QuadMesh
from pandas import DataFrame

from fprc.figures.style import COLOURS

Colours = ScalarMappable | QuadMesh


def plot_shares_of_rigs(table: DataFrame, ax: Axes) -> Axes:
    """Draw the share of rigs on which each claim holds, with its interval.

    Parameters
    ----------
    table : DataFrame
        ``id``, ``share``, ``low``, ``high``, in the order from top to bottom.
    """
    rows = np.arange(len(table))
    arms = np.abs(np.array([table["share"] - table["low"], table["high"] - table["share"]]))
    ax.errorbar(table["share"], rows, xerr=arms, fmt="o", color=COLOURS["fprc_pd"],
                markersize=3, capsize=2, linewidth=0.8)  # fmt: skip
    ax.set(xlim=(-0.03, 1.03), xlabel="Share of rigs", yticks=rows, yticklabels=table["id"])
    ax.set_ylim(len(table) - 0.5, -0.5)
    ax.grid(axis="y", color="0.9", linewidth=0.5)
    return ax


def plot_front(table: DataFrame, ax: Axes) -> Axes:
    """Draw the fronts between tables and claims, a line and an end point per search.

    Parameters
    ----------
    table : DataFrame
        ``search``, ``rigs``, ``kind`` (front or end), ``tables_percent`` and ``claims_loss``.
    """
    for number, (name, own) in enumerate(table.groupby("search", sort=False)):
        front, end = (own[own["kind"] == kind] for kind in ("front", "end"))
        colour = f"C{number}"
        ax.step(front["tables_percent"], front["claims_loss"], "-", where="post", color=colour,
                linewidth=0.8)  # fmt: skip
        label = f"{name}, {own['rigs'].iloc[0]} rigs" if len(front) else name
        ax.plot(end["tables_percent"], end["claims_loss"], "*", color=colour, label=label)
    ax.set_yscale("symlog", linthresh=10.0)
    ax.set_ylim(bottom=0.0)
    ax.set(
        xlabel="Deviation of the 12 errors of Tables II and III, rms [%]",
        ylabel="Orders and claims, sum of squared misses",
    )
    ax.legend(fontsize=6, loc="lower left")
    return ax


def plot_correlations(grid: DataFrame, limit: float, ax: Axes) -> Colours:
    """Draw rank correlations, one row per claim and one column per parameter.

    A cross marks values beyond ``limit``; a claim without correlations is grey.
    """
    ax.set_facecolor("0.93")
    image = ax.pcolormesh(grid.to_numpy(float), cmap="PuOr", vmin=-1, vmax=1)
    strong = np.argwhere(np.abs(grid.to_numpy(float)) > limit)
    ax.plot(strong[:, 1] + 0.5, strong[:, 0] + 0.5, "x", color="black", markersize=3)
    ax.set_xticks(np.arange(grid.shape[1]) + 0.5, grid.columns, rotation=90, fontsize=5.5)
    ax.set_yticks(np.arange(grid.shape[0]) + 0.5, grid.index)
    ax.set_ylim(grid.shape[0], 0)
    ax.tick_params(length=0)
    return image
