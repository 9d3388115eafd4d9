"""Value of the readout, over the settings of the filter and the taps."""

from typing import Any

from matplotlib.axes import Axes
from pandas import DataFrame

from fprc import escape
from fprc.figures.style import SIGNALS, line_of

#: Label and look of each readout; its colour is that of the signal.
_LOOKS: dict[str, tuple[str, dict[str, Any]]] = {
    "none": ("none (Fuzzy-linear)", line_of("fuzzy_linear")),
    "p_o": (r"$P_o$ (FPRC)", {"color": SIGNALS["p_o"]}),
    "theta": (r"$\theta$: the filter alone", {"color": SIGNALS["theta"], "linestyle": "-."}),
    "shifted": (r"$P_o$ shifted in time", {"color": SIGNALS["p_o"], "linestyle": ":"}),
}


def plot_readouts(table: DataFrame, setting: str, error: str, ax: Axes) -> Axes:
    """Draw one error over a setting, one line per readout; no readout is a horizontal line.

    Parameters
    ----------
    table : DataFrame
        ``readout``, the setting, the error, and its ``unit``.
    """
    for readout, (label, look) in _LOOKS.items():
        rows = table[table["readout"] == readout].sort_values(setting)
        if readout == "none":
            ax.axhline(rows[error].iloc[0], **look, label=label)
        else:
            ax.plot(rows[setting], rows[error], **look, marker="d", markersize=3.0, label=label)
    ax.set_ylabel(f"RMSE [{escape.figure(table['unit'].iloc[0])}]")
    ax.margins(y=0.1)
    ax.set_ylim(bottom=0)
    return ax
