"""Value of the readout, over the settings of the filter and the taps."""

from matplotlib.axes import Axes
from pandas import DataFrame

from fprc import escape
from fprc.figures.style import COLOURS

#: Label, colour and marker of each readout.
_LOOKS = {
    "none": ("none (Fuzzy-linear)", "fuzzy_linear", ""),
    "p_o": (r"$P_o$ (FPRC)", "fprc", "o"),
    "theta": (r"$\theta$: the filter alone", "theta", "s"),
    "shuffled": (r"$P_o$ shuffled in time", "bias", "^"),
}


def plot_readouts(table: DataFrame, setting: str, error: str, ax: Axes) -> Axes:
    """Draw one error over a setting, one line per readout; no readout is a horizontal line.

    Parameters
    ----------
    table : DataFrame
        ``readout``, the setting, the error, and its ``unit``.
    """
    for readout, (label, colour, marker) in _LOOKS.items():
        rows = table[table["readout"] == readout].sort_values(setting)
        if readout == "none":
            ax.axhline(rows[error].iloc[0], color=COLOURS[colour], linestyle="--", label=label)
        else:
            ax.plot(rows[setting], rows[error], color=COLOURS[colour], marker=marker,
                    markersize=2.5, label=label)  # fmt: skip
    ax.set_ylabel(f"RMSE [{escape.figure(table['unit'].iloc[0])}]")
    ax.set_ylim(bottom=0)
    return ax
