"""One picture of an imported recording, with the faults that were found in it."""

from collections.abc import Mapping
from textwrap import shorten
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from fprc import escape
from fprc.figures import style
from fprc.recordings.diagnosis import MARKS
from fprc.recordings.gather import Recording

#: Colours of gaps, and of the stretches of a channel.
_GAP = "0.75"
_SHADES = {"frozen": "#fff3b0", "clipped": "#fbd0dd"}
#: Limit on points that are drawn; more could not be seen.
_POINTS = 20000


def draw_diagnosis(
    recording: Recording,
    diagnosis: Mapping[str, Any],
    *,
    titles: Mapping[str, str],
    units: Mapping[str, str],
) -> Figure:
    """Draw every channel over time with marks, and theta over P_exp.

    Parameters
    ----------
    diagnosis : Mapping
        Result of ``fprc.recordings.diagnosis.diagnose``.
    titles, units : Mapping
        Title and unit of each channel; the unit is empty for another quantity.
    """
    time_s, channels = recording.time_s, recording.channels
    rows = max(len(channels), 3)
    fig, axes = style.figure(
        rows, 2, 2 * style.COLUMN_IN, 0.3 + 0.85 * rows, width_ratios=(2.0, 1.0), squeeze=False
    )
    grid = axes[0, 0].get_gridspec()
    for ax in [*axes[:, 1], *axes[len(channels) :, 0]]:
        ax.remove()
    left = axes[: len(channels), 0]
    for ax, (name, values) in zip(left, channels.items(), strict=True):
        plot_channel(time_s, values, name, diagnosis, ax)
        ax.set_ylabel(units[name])
        style.letter(ax, escape.figure(shorten(titles[name], 52, placeholder=" ...")))
        ax.sharex(left[0])
        ax.label_outer()
    left[0].set_xlim(time_s[0], time_s[-1])
    left[-1].set_xlabel("Time [s]")
    target = "p_exp_kpa" if "p_exp_kpa" in channels else "p_exp_command_kpa"
    every = -(-len(time_s) // _POINTS)
    loop = fig.add_subplot(grid[:, 1])
    p_exp, theta = channels[target][::every], channels["theta_deg"][::every]
    loop.scatter(p_exp, theta, c=time_s[::every], s=0.5, linewidths=0, rasterized=True)
    loop.set(xlabel=_axis(target, units), ylabel=_axis("theta_deg", units))
    style.letter(loop, "Loops, from dark to bright")
    marks = [ax.get_legend_handles_labels() for ax in left]
    by_label = {label: mark for pair in marks for mark, label in zip(*pair, strict=True)}
    if by_label:
        fig.legend(by_label.values(), by_label, loc="outside upper left", ncols=4)
    return fig


def plot_channel(
    time_s: np.ndarray, values: np.ndarray, name: str, diagnosis: Mapping[str, Any], ax: Axes
) -> None:
    """Draw one channel: gaps grey, its stretches in their shades."""
    quantity = name.rpartition("_")[0].removesuffix("_command")
    colour = style.SIGNALS.get(quantity, style.SIGNALS["valve"])  # grey: it has none of its own
    ax.plot(time_s, values, color=colour, linewidth=0.6)
    for gap in diagnosis["clock"]["gaps"]:
        ax.axvspan(gap["from_s"], gap["to_s"], color=_GAP, linewidth=0.5, zorder=0,
                   label="gap")  # fmt: skip
    for kind, shade in _SHADES.items():
        for stretch in diagnosis["channels"][name][kind]:
            ax.axvspan(stretch["from_s"], stretch["to_s"], color=shade, linewidth=0,
                       zorder=0, label=MARKS[kind])  # fmt: skip


def _axis(name: str, units: Mapping[str, str]) -> str:
    return f"{name} [{units[name]}]" if units[name] else f"{name}, not in its unit"
