"""Growth of the cost with the size of the work."""

import numpy as np
from matplotlib.axes import Axes
from numpy.typing import ArrayLike
from pandas import DataFrame

#: A power law fits if no point lies off it by more than this factor.
_FITS = 1.25
_TIME, _MEMORY = "black", "#8c8c8c"


def plot_growth(table: DataFrame, ax: Axes) -> Axes:
    """Draw seconds over the size of one work, and memory on a second axis; all logarithmic.

    If a power law fits three points or more, it is drawn, with its exponent above the panel.

    Parameters
    ----------
    table : DataFrame
        ``size``, ``seconds``, ``peak_mb``.

    Returns
    -------
    Axes
        The second axis.
    """
    size, seconds = table["size"].to_numpy(float), table["seconds"].to_numpy(float)
    memory = ax.twinx()
    memory.spines.right.set_visible(True)
    memory.loglog(size, table["peak_mb"], "s--", ms=3, color=_MEMORY, label="peak memory")
    ax.loglog(size, seconds, "o-", ms=3, color=_TIME, label="time")
    power, level = np.polyfit(np.log(size), np.log(seconds), 1)
    law = np.exp(level) * size**power
    if len(size) > 2 and np.exp(np.abs(np.log(law / seconds)).max()) < _FITS:
        ax.plot(size, law, ":", color=_TIME, linewidth=1.2)
        ax.set_title(f"$n^{{{power:.2f}}}$", loc="right")
    ax.set_xticks(size, [f"{n:g}" if n < 1000 else f"{n / 1000:g}k" for n in size])
    ax.set_ylabel("Time [s]")
    memory.set_ylabel("Memory [MB]", color=_MEMORY)
    for axis, values in ((ax, seconds), (memory, table["peak_mb"])):
        axis.minorticks_off()
        axis.set_ylim(*_decades(values))
    return memory


def _decades(values: ArrayLike) -> tuple[float, float]:
    """Return the powers of ten around the values."""
    low, high = np.log10([np.min(values) / 1.1, np.max(values) * 1.1])
    return 10.0 ** np.floor(low), 10.0 ** np.ceil(high)
