"""Figures 4 and 5: commands and hysteresis loops of actuator and reservoir."""

from collections.abc import Sequence

import numpy as np
from matplotlib import colormaps
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection


def plot_command(
    time_s: np.ndarray, p_exp_kpa: np.ndarray, ax: Axes, colour: str, label: str
) -> Axes:
    """Draw a pressure command over time."""
    ax.plot(time_s, p_exp_kpa, color=colour, linewidth=0.5)
    ax.set(xlabel="Time [s]", ylabel=label, xlim=(time_s[0], time_s[-1]))
    return ax


def plot_loop(
    x: np.ndarray,
    y: np.ndarray,
    colour_by: np.ndarray,
    ax: Axes,
    labels: tuple[str, str],
    limits: tuple[float, float] | None = None,
) -> LineCollection:
    """Draw a loop of ``y`` over ``x``, coloured by a quantity of each sample.

    Its pieces are drawn in random order, so that no part of the recording hides another.

    Parameters
    ----------
    limits : (float, float), optional
        Values at the ends of the colours; those of the data if left out.
    """
    points = np.column_stack([x, y])
    order = np.random.default_rng(0).permutation(len(points) - 1)
    segments = np.stack([points[:-1], points[1:]], axis=1)[order]
    lines = LineCollection(list(segments), cmap="viridis", array=colour_by[:-1][order],
                           linewidth=0.4, capstyle="round")  # fmt: skip
    lines.set_clim(*limits or (colour_by.min(), colour_by.max()))
    lines.set_rasterized(True)
    ax.add_collection(lines)
    ax.autoscale_view()
    ax.set(xlabel=labels[0], ylabel=labels[1])
    return lines


def plot_quarters(
    time_s: np.ndarray, x: np.ndarray, y: np.ndarray, ax: Axes, labels: tuple[str, str]
) -> Axes:
    """Draw the loops of ``y`` over ``x`` in the first and in the last quarter of a sweep."""
    end = time_s[-1]
    for part, shade, name in (
        (time_s > 0.75 * end, 0.875, "last quarter"),
        (time_s < 0.25 * end, 0.125, "first quarter"),
    ):
        ax.plot(x[part], y[part], color=colormaps["viridis"](shade), linewidth=0.5, label=name,
                rasterized=True)  # fmt: skip
    ax.set(xlabel=labels[0], ylabel=labels[1])
    return ax


def add_frequency_bar(lines: LineCollection, axes: Sequence[Axes]) -> None:
    """Put one bar for the colour of frequency below the axes."""
    bar = axes[0].figure.colorbar(lines, ax=axes, location="bottom", aspect=40, pad=0.02)
    bar.set_label("Frequency [Hz]")
    bar.outline.set_visible(False)
