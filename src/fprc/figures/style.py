"""One look for every figure: journal widths, type, saving.

A colour is a signal, a grey and a line style are a model or a controller, a marker is a phase.
"""

import warnings
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import matplotlib
import numpy as np
from matplotlib.axes import Axes

matplotlib.use("Agg")

import matplotlib.pyplot as plt
from matplotlib.figure import Figure
from pandas import DataFrame

from fprc.artifacts import replacing, write_csv
from fprc.paper import SOURCES

Look = dict[str, Any]

#: Widths of a column and of a page of the journal, inches.
COLUMN_IN, PAGE_IN = 3.5, 7.16
#: Size of type and of the mark of the source, points; the journal's text has 8 to 10.
TEXT_PT, MARK_PT = 8.0, 7.0

#: Colour of each signal, safe for colour-blind readers (Okabe-Ito and Tol).
SIGNALS = {
    "theta_d": "#e69f00",
    "theta": "#0072b2",
    "p_exp": "#56b4e9",
    "p_ff": "#d55e00",
    "p_fb": "#009e73",
    "p_i": "#999933",
    "p_o": "#882255",
    "phi": "#332288",
    "valve": "#555555",
}
#: Grey and line style of the paper's models and controllers; hues are for signals.
_LINES = {
    "esn": ("#777777", "-."),
    "fprc": ("#000000", "-"),
    "fuzzy_linear": ("#8c8c8c", "--"),
    "pd": ("#909090", "-"),
    "fprc_pd": ("#303030", "-"),
}
#: Marker of each phase; that of validation is hollow, so that it is seen around another.
PHASES: dict[str, Look] = {
    "train": {"marker": "o", "markersize": 3.0},
    "validation": {"marker": "s", "markersize": 5.5, "markerfacecolor": "none"},
    "test": {"marker": "^", "markersize": 4.0},
}
#: Colour that marks a place in a figure: the least value, a fault.
MARK = "#ee3377"
#: Times of a run, behind its lines: settling (not judged), quiet, and pushed.
TIMES: dict[str, Look] = {
    "settling": {"facecolor": "white", "edgecolor": "0.8", "hatch": "/////"},
    "quiet": {"facecolor": "#fff6d5"},
    "pushed": {"facecolor": "0.9"},
}


def line_of(name: str) -> Look:
    """Return grey and line style of a model or a controller."""
    colour, line = _LINES.get(name, ("#505050", ":"))
    return {"color": colour, "linestyle": line}


_STYLE: dict[Any, Any] = {
    # looks like Times, the journal's font, and comes with Matplotlib
    "font.family": ["STIXGeneral", "DejaVu Sans"],
    "mathtext.fontset": "stix",
    "font.size": TEXT_PT,
    **dict.fromkeys(("axes.titlesize", "figure.titlesize"), TEXT_PT),
    "axes.titlepad": 4.0,
    "axes.titlelocation": "left",
    **dict.fromkeys(("axes.linewidth", "xtick.major.width", "ytick.major.width"), 0.6),
    **dict.fromkeys(("xtick.direction", "ytick.direction"), "in"),
    **dict.fromkeys(("axes.spines.top", "axes.spines.right", "legend.frameon"), False),
    "lines.linewidth": 0.8,
    "hatch.linewidth": 0.4,
    "savefig.dpi": 300,
    "pdf.fonttype": 42,
}  # fmt: skip


def figure(
    rows: int, columns: int, width_in: float, height_in: float, **options: Any
) -> tuple[Figure, Any]:
    """Return a figure with a grid of axes in the house style, whatever a matplotlibrc says."""
    matplotlib.rcdefaults()
    plt.rcParams.update(_STYLE)
    options |= {"figsize": (width_in, height_in), "layout": "constrained"}
    return plt.subplots(rows, columns, **options)


def legend_above(ax: Axes) -> None:
    """Put the legend of axes above their right edge."""
    columns = len(ax.get_legend_handles_labels()[1])
    ax.legend(loc="lower right", bbox_to_anchor=(1.0, 1.0), borderaxespad=0.1, ncols=columns,
              handlelength=1.4, columnspacing=1.0)  # fmt: skip


def share_legend(fig: Figure, ax: Axes, columns: int = 2) -> None:
    """Put the legend of one axes above the figure, for all axes."""
    fig.legend(*ax.get_legend_handles_labels(), loc="outside upper center", ncols=columns,
               handlelength=1.4, columnspacing=1.2)  # fmt: skip


#: Text under a figure, by the source of its data.
_ORIGINS = SOURCES | {"sim": "simulated rig, seed {seed}"}
#: What a file does not say of itself: when and by what it was made.
_LEFT_OUT = {".pdf": {"CreationDate": None}, ".png": {"Software": None}}


def save(fig: Figure, data: Mapping[str, Any], *files: str, table: DataFrame | None = None) -> None:
    """Write a figure to PDF and PNG files, marked with the source of its data.

    The same figure gives the same bytes. ``data`` has the ``source`` of a log, and its ``seed``
    where it is simulated, or ``seeds`` of several simulated rigs. A file that ends in .csv gets
    ``table``, the statistics that the figure shows.
    """
    origin = "simulated rigs" if "seeds" in data else _ORIGINS[data["source"]].format_map(data)
    fig.supxlabel(origin, x=0.99, ha="right", fontsize=MARK_PT, color="0.45")
    with warnings.catch_warnings():
        # names from files may have characters that the font lacks; each is drawn as a box
        warnings.filterwarnings("ignore", message="Glyph .* missing from font")
        fig.draw_without_rendering()
        fig.set_layout_engine("none")
        for ax in fig.axes:  # the last digits differ by process, and would change a pixel
            ax.set_position(np.round(ax.get_position(original=True).bounds, 6).tolist())
        for path in map(Path, files):
            if table is not None and path.suffix == ".csv":
                write_csv(path, table)
                continue
            with replacing(path) as temporary:
                fig.savefig(temporary, metadata=_LEFT_OUT[path.suffix])
    plt.close(fig)
