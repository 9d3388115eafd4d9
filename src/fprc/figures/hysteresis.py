"""Figures 4 and 5: commands and hysteresis loops of actuator and reservoir."""

from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection


def plot_command(
    time_s: np.ndarray, p_exp_kpa: np.ndarray, ax: Axes, colour: str, label: str
) -> Axes:
    """Draw a pressure command over time."""
    ax.plot(time_s, p_exp_kpa, color=colour, linewidth=0.5)
    ax.set(xlabel="Time [s]", ylabel=label)
    ax.set_xlim(time_s[0], time_s[-1])
    return ax


def plot_loop(
    x: np.ndarray, y: np.ndarray, time_s: np.ndarray, ax: Axes, labels: tuple[str, str]
) -> LineCollection:
    """Draw a loop of ``y`` over ``x``, coloured from its start to its end.

    Loops that do not depend on frequency coincide.
    """
    points = np.column_stack([x, y])
    segments = np.stack([points[:-1], points[1:]], axis=1)
    elapsed = (time_s[:-1] - time_s[0]) / (time_s[-1] - time_s[0])
    lines = LineCollection(list(segments), cmap="viridis", array=elapsed, linewidth=0.3)
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
    for part, colour, name in (
        (time_s > 0.75 * end, "#d55e00", "last quarter"),
        (time_s < 0.25 * end, "#222222", "first quarter"),
    ):
        ax.plot(x[part], y[part], color=colour, linewidth=0.5, label=name, rasterized=True)
    ax.set(xlabel=labels[0], ylabel=labels[1])
    return ax


def add_time_bar(lines: LineCollection, axes: Sequence[Axes]) -> None:
    """Put one bar for the colour of time below the axes."""
    bar = axes[0].figure.colorbar(lines, ax=axes, location="bottom", aspect=50, pad=0.02)
    bar.set_ticks([0.0, 1.0], labels=["start", "end"])
    bar.ax.tick_params(length=0)
    bar.outline.set_visible(False)
