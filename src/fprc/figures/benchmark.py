"""Growth of the cost with the size of the work."""

from matplotlib.axes import Axes
from pandas import DataFrame

from fprc.figures.style import COLOURS


def plot_growth(table: DataFrame, power: float, ax: Axes) -> Axes:
    """Draw seconds and memory over the size of one work, both axes logarithmic.

    Parameters
    ----------
    table : DataFrame
        ``size``, ``seconds``, ``peak_mb``.
    power : float
        Fitted exponent of the seconds, written above the panel.
    """
    ax.loglog(
        table["size"], table["seconds"], "o-", ms=2.5, color=COLOURS["theta"], label="time [s]"
    )
    ax.loglog(
        table["size"], table["peak_mb"] / 1e3, "s--", ms=2.5, color=COLOURS["pd"],
        label="peak memory [GB]",
    )  # fmt: skip
    ax.set_xticks(table["size"], [_short(size) for size in table["size"]])
    ax.minorticks_off()
    ax.set_title(f"$n^{{{power:.2f}}}$", loc="right")
    return ax


def _short(size: float) -> str:
    return f"{size:g}" if size < 1000 else f"{size / 1000:g}k"
