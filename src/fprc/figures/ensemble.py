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


def plot_front(table: DataFrame, ax: Axes) -> Axes:
    """Draw the end point of each search, and its front between tables and claims if it is known.

    Parameters
    ----------
    table : DataFrame
        ``search``, ``rigs``, ``kind`` (front or end), ``tables_percent`` and ``claims_loss``.
    """
    x, y = "tables_percent", "claims_loss"
    searches = table["search"].nunique()
    for number, (name, own) in enumerate(table.groupby("search", sort=False)):
        front, end = (own[own["kind"] == kind] for kind in ("front", "end"))
        grey = str(0.7 * number / max(searches - 1, 1))
        ax.step(front[x], front[y], "-", where="post", color=grey, linewidth=0.8)
        marker = _ENDS[number % len(_ENDS)]
        ax.plot(end[x], end[y], marker, color=grey)
        # without points: the legend has a line only where the front is known
        label = f"{name}, {own['rigs'].iloc[0]} rigs" if len(front) else name
        look = f"{marker}-" if len(front) else marker
        ax.plot([], [], look, color=grey, linewidth=0.8, label=label)
    ax.set_ylim(bottom=0.0)
    ax.set(
        xlabel="Deviation of the errors of Tables II and III, rms [%]",
        ylabel="Claims, sum of squared misses",
    )
    ax.legend(loc="lower left", bbox_to_anchor=(-0.03, 1.0), ncols=2)
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
