"""One look for every figure: journal widths, colours, saving."""

from collections.abc import Mapping
from pathlib import Path

import matplotlib

matplotlib.use("Agg")

import matplotlib.pyplot as plt
from matplotlib.figure import Figure

from fprc.artifacts import replacing

#: Widths of a journal's column and page, inches.
COLUMN_IN = 3.5
PAGE_IN = 7.16

#: Colour of each signal and model; a name that is not here is an error.
COLOURS = {
    "p_exp": "#0b3c5d",
    "theta": "#0b3c5d",
    "p_o": "#8a3324",
    "esn": "#b8860b",
    "fprc": "#c0392b",
    "fuzzy_linear": "#4b7f52",
}

_STYLE = {
    "font.family": "DejaVu Sans",
    "font.size": 7,
    "axes.titlesize": 7,
    "axes.labelsize": 7,
    "xtick.labelsize": 6.5,
    "ytick.labelsize": 6.5,
    "legend.fontsize": 6.5,
    "axes.linewidth": 0.6,
    "xtick.major.width": 0.6,
    "ytick.major.width": 0.6,
    "xtick.direction": "in",
    "ytick.direction": "in",
    "axes.spines.top": False,
    "axes.spines.right": False,
    "lines.linewidth": 0.8,
    "legend.frameon": False,
    "savefig.dpi": 300,
    "pdf.fonttype": 42,
}


def figure(rows: int, columns: int, width_in: float, height_in: float, **options: object):
    """Return a figure with a grid of axes in the house style."""
    plt.rcParams.update(_STYLE)
    return plt.subplots(
        rows, columns, figsize=(width_in, height_in), layout="constrained", **options
    )


def letter(ax: plt.Axes, text: str) -> None:
    """Put a panel's letter and title above its left edge."""
    ax.set_title(text, loc="left")


def save(fig: Figure, attributes: Mapping[str, object], pdf: str, png: str) -> None:
    """Write a figure as PDF and PNG, marked with the source of its data.

    The same figure gives the same bytes: no creation date is written.
    """
    if attributes["source"] == "sim":
        mark = f"simulated rig, seed {attributes['seed']}"
    else:
        mark = "measured data"
    fig.text(0.995, 0.005, mark, ha="right", va="bottom", fontsize=5.5, color="0.45")
    for path, metadata in ((pdf, {"CreationDate": None}), (png, {"Software": None})):
        with replacing(Path(path)) as temporary:
            fig.savefig(temporary, metadata=metadata)
    plt.close(fig)
