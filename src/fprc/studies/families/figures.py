"""Claims on sets of rigs: shares of rigs, correlations, and trade-offs found by searches."""

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import QuadMesh
from pandas import DataFrame

#: Markers of the ends of searches.
_ENDS = "*osD^v"


def plot_shares_of_rigs(table: DataFrame, ax: Axes) -> Axes:
    """Draw the share of rigs on which each claim holds, with its interval.

    Parameters
    ----------
    table : DataFrame
        ``id``, ``share``, ``low``, ``high``, in the order from top to bottom.
    """
    rows = np.arange(len(table))
    arms = np.abs(np.array([table["share"] - table["low"], table["high"] - table["share"]]))
    ax.errorbar(table["share"], rows, xerr=arms, fmt="o", color="black",
                markersize=3, capsize=2, linewidth=0.8)  # fmt: skip
    ax.set(
        xlim=(-0.03, 1.03),
        xlabel="Share of rigs, 95 % interval",
        yticks=rows,
        yticklabels=table["id"],
    )
    ax.set_ylim(len(table) - 0.5, -0.5)
    ax.grid(axis="y", color="0.9", linewidth=0.5)
    return ax


def plot_correlations(grid: DataFrame, limit: float, ax: Axes) -> QuadMesh:
    """Draw rank correlations, one row per parameter and one column per claim.

    A cross marks values beyond ``limit``; a claim without correlations is grey.
    """
    values = grid.to_numpy(float)
    ax.set_facecolor("0.93")
    image = ax.pcolormesh(values, cmap="PuOr", vmin=-limit, vmax=limit)
    strong = np.argwhere(np.abs(values) > limit)
    ax.plot(strong[:, 1] + 0.5, strong[:, 0] + 0.5, "x", color="white", markersize=5)
    ax.set_xticks(np.arange(grid.shape[1]) + 0.5, grid.columns, rotation=90)
    ax.set_yticks(np.arange(grid.shape[0]) + 0.5, grid.index)
    ax.set_ylim(grid.shape[0], 0)
    ax.tick_params(length=0)
    return image
