"""Figures 4 and 5: hysteresis loops of actuator and reservoir."""

from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection


def plot_loop(
    x: np.ndarray,
    y: np.ndarray,
    ax: Axes,
    labels: tuple[str, str],
    colour_by: np.ndarray | None = None,
) -> LineCollection:
    """Draw a loop of ``y`` over ``x``, coloured by a quantity of each sample, or in grey.

    Its pieces are drawn in random order, so that no part of the recording hides another.
    """
    points = np.column_stack([x, y])
    order = np.random.default_rng(0).permutation(len(points) - 1)
    segments = np.stack([points[:-1], points[1:]], axis=1)[order]
    lines = LineCollection(list(segments), linewidth=0.4, capstyle="round")
    if colour_by is None:
        lines.set_color("0.5")
    else:
        lines.set(array=colour_by[:-1][order], cmap="viridis")
        lines.set_clim(colour_by.min(), colour_by.max())
    lines.set_rasterized(True)
    ax.add_collection(lines)
    ax.autoscale_view()
    ax.set(xlabel=labels[0], ylabel=labels[1])
    return lines


def add_frequency_bar(lines: LineCollection, axes: Sequence[Axes], panel: str) -> None:
    """Put a bar for the colour of frequency below the axes; only ``panel`` has this colour."""
    bar = axes[0].figure.colorbar(lines, ax=axes, location="bottom", aspect=40, pad=0.02)
    bar.set_label(f"Frequency of the command in {panel} [Hz]")
    bar.outline.set_visible(False)
