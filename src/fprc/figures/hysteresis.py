"""Figures 4 and 5: hysteresis loops of actuator and reservoir."""

from collections.abc import Sequence

import numpy as np
from matplotlib import colormaps
from matplotlib.axes import Axes
from matplotlib.cm import ScalarMappable
from matplotlib.colors import BoundaryNorm
from pandas import DataFrame


def plot_loops(loops: DataFrame, ax: Axes, x: str, y: str, band_hz: float) -> ScalarMappable:
    """Draw ``y`` over ``x``, one loop per band of frequency; return their colours.

    Parameters
    ----------
    loops : DataFrame
        From ``mean_loops``.
    """
    edges = np.arange(loops["f_hz"].min(), loops["f_hz"].max() + 1.5 * band_hz, band_hz)
    bands = len(edges) - 1
    colours = ScalarMappable(BoundaryNorm(edges, bands), colormaps["viridis"].resampled(bands))
    for f_hz, loop in loops.groupby("f_hz"):
        colour = colours.to_rgba(f_hz + band_hz / 2)
        ax.plot(loop[x], loop[y], color=colour, linewidth=0.7)
    return colours


def add_frequency_bar(colours: ScalarMappable, axes: Sequence[Axes], panel: str) -> None:
    """Put a bar for the colour of frequency below the axes; only ``panel`` has this colour."""
    bar = axes[0].figure.colorbar(colours, ax=axes, location="bottom", aspect=40, pad=0.02)
    bar.set_label(f"Frequency of the command in {panel} [Hz]")
    bar.outline.set_visible(False)
