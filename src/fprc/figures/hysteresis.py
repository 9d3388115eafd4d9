"""Figures 4, 5 and 8: hysteresis loops of actuator and reservoir, and a model's output."""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import pandas as pd
from matplotlib import colormaps
from matplotlib.axes import Axes
from matplotlib.cm import ScalarMappable
from matplotlib.colors import BoundaryNorm
from matplotlib.figure import Figure

from fprc import escape
from fprc.figures import style
from fprc.logs import read_columns
from fprc.signals import rms, turning_points

#: Width of a band of frequency, Hz, and phases of a cycle, of mean loops.
_BAND_HZ, _PHASES_OF_CYCLE = 0.1, 100
#: Length of the mean that takes the noise from a path, s: a tenth of the shortest period.
_SMOOTHED_S = 0.1
#: Symbol and unit of a channel.
_SYMBOLS = {
    "theta_deg": (r"$\theta$", "deg"),
    "p_target_kpa": (r"$P_\mathrm{exp}$", "kPa"),
    "p_o_kpa": ("$P_o$", "kPa"),
}


def draw_actuator(logs: Sequence[Any]) -> Figure:
    """Figure 4: pressure commands, each as wide as the column, and the actuator's loops."""
    fig, axes = style.figure(
        3, 2, style.COLUMN_IN, 4.6, height_ratios=(1, 1, 2), sharex="row", sharey="row"
    )
    commands = _widened(fig, axes, 0, 1)
    for log, ax, title in zip(logs, commands, ("(a) Sweep", "(c) Complex"), strict=True):
        time_s, command = (log.channels[name] for name in ("time_s", "p_target_kpa"))
        ax.plot(time_s, command, color=style.SIGNALS["p_exp"], linewidth=0.5)
        ax.set(title=title, xlabel="Time [s]", ylabel=label("p_target_kpa", log.attributes))
        ax.set_xlim(time_s[0], time_s[-1])
    titles = "(b) Loops of (a)", "(d) Loops of (c)"
    _draw_loops(logs, axes[2], "p_target_kpa", "theta_deg", titles)
    return fig


def _widened(fig: Figure, axes: Any, *rows: int) -> list[Axes]:
    """Replace the axes of some rows by one axes each, which is as wide as they are."""
    grid = axes[0, 0].get_gridspec()
    for ax in axes[[*rows]].ravel():
        ax.remove()
    return [fig.add_subplot(grid[row, :]) for row in rows]


def draw_reservoir(logs: Sequence[Any]) -> Figure:
    """Figure 5: hysteresis between theta and the reservoir's P_o."""
    fig, axes = style.figure(1, 2, style.COLUMN_IN, 2.4, sharex=True, sharey=True)
    _draw_loops(logs, axes, "theta_deg", "p_o_kpa", ("(a) Sweep", "(b) Complex"))
    return fig


def _draw_loops(
    logs: Sequence[Any], axes: Sequence[Axes], x: str, y: str, titles: Sequence[str]
) -> None:
    """Draw the mean loops of the sweep, coloured by frequency, and the path of the complex log.

    The complex command adds up five sines, so that it has no frequency at a time.
    """
    loops = mean_loops(logs[0].channels)
    edges = np.arange(loops["f_hz"].min(), loops["f_hz"].max() + 1.5 * _BAND_HZ, _BAND_HZ)
    bands = len(edges) - 1
    colours = ScalarMappable(BoundaryNorm(edges, bands), colormaps["viridis"].resampled(bands))
    for f_hz, loop in loops.groupby("f_hz"):
        colour = colours.to_rgba(f_hz + _BAND_HZ / 2)
        axes[0].plot(loop[x], loop[y], color=colour, linewidth=0.7)
    for log, ax, title in zip(logs, axes, titles, strict=True):
        samples = max(round(_SMOOTHED_S / np.diff(log.channels["time_s"][:2]).item()), 1)
        smoothed = pd.DataFrame(log.channels).rolling(samples, center=True, min_periods=1).mean()
        if ax is axes[1]:
            ax.plot(smoothed[x], smoothed[y], color="0.5", linewidth=0.4)
        # begins at rest and is not repeated
        start = smoothed[: next(iter(turning_points(log.channels["p_target_kpa"])), 0)]
        ax.plot(start[x], start[y], color="black", linewidth=0.9, label="start")
        ax.set(title=title, xlabel=label(x, log.attributes), ylabel=label(y, log.attributes))
        ax.legend(loc="upper left", handlelength=1.2, borderaxespad=0.0)
        ax.label_outer()
    bar = axes[0].figure.colorbar(colours, ax=axes, location="bottom", aspect=40, pad=0.02)
    bar.set_label("Frequency of the command in (a) [Hz]")
    bar.outline.set_visible(False)


def label(channel: str, attributes: Mapping[str, Any]) -> str:
    """Return symbol and unit of a log's theta, p_target or p_o."""
    symbol, unit = _SYMBOLS[channel]
    quantity = channel.rpartition("_")[0]
    return f"{symbol} [{escape.figure(attributes.get(f'{quantity}_unit', unit))}]"


def mean_loops(channels: Mapping[str, np.ndarray]) -> pd.DataFrame:
    """Mean of each channel over the cycles of a band of frequency, by ``f_hz`` and phase.

    A cycle goes from one upper turn of ``p_target_kpa`` to the next; without one, the whole counts.
    The band is named by its lower edge.
    """
    turns = turning_points(channels["p_target_kpa"])[::2]
    if len(turns) < 2:
        turns = np.array([0, len(channels["time_s"]) - 1])
    lengths = np.diff(turns)
    table = pd.DataFrame(channels)[turns[0] : turns[-1]]
    f_hz = 1.0 / np.diff(channels["time_s"][turns])
    table["f_hz"] = np.repeat(_BAND_HZ * np.floor(f_hz / _BAND_HZ + 1e-6), lengths)
    samples = np.arange(len(table)) - np.repeat(turns[:-1] - turns[0], lengths)
    table["phase"] = samples * _PHASES_OF_CYCLE // np.repeat(lengths, lengths)
    loops = table.groupby(["f_hz", "phase"]).mean().reset_index()
    # the first point again, which closes each loop
    return pd.concat([loops, loops.groupby("f_hz", as_index=False).first()])


def draw_training(fits: str, predictions: str, fig8: Sequence[str]) -> None:
    """Figure 8: the model on its training and on its test data, their difference, and its RMSE."""
    names = ("time_s", "p_target_kpa", "p_ff_kpa")
    logs = {"train": read_columns(fits, names), "test": read_columns(predictions, names)}
    fig, axes = style.figure(4, 2, style.COLUMN_IN, 4.4, sharey="row", height_ratios=(3, 2, 3, 2))
    test, below = _widened(fig, axes, 2, 3)
    below.sharey(axes[1, 0])
    parts = [*axes[:2].T], [(test, below)]
    titles = "(a) Training: first and last tenth", "(b) Test"
    rows = []
    for (phase, log), panels, title in zip(logs.items(), parts, titles, strict=True):
        unit = log.attributes.get("p_target_unit", "kPa")
        time_s, truth, model = (log.channels[name] for name in names)
        rmse = rms(model - truth)
        for above, below in panels:
            for values, name, width in ((truth, "p_exp", 1.8), (model, "p_ff", 0.6)):
                above.plot(time_s, values, color=style.SIGNALS[name], linewidth=width,
                           label=rf"$P_\mathrm{{{name[2:]}}}$")  # fmt: skip
            command = label("p_target_kpa", log.attributes)
            above.set_ylabel("Pressure [kPa]" if unit == "kPa" else command)
            above.tick_params(labelbottom=False)
            below.axhline(0.0, color="0.6", linewidth=0.4)
            below.plot(time_s, model - truth, color="black", linewidth=0.5)
            below.set(xlabel="Time [s]", ylabel=r"$P_\mathrm{ff} - P_\mathrm{exp}$")
            for ax in (above, below):
                ax.set_xlim(time_s[0], time_s[-1])
        panels[0][0].set_title(title)
        panels[-1][0].set_title(f"RMSE {rmse:.1f} {escape.figure(unit)}", loc="right")
        of_log = {"model": log.attributes["model"], "rmse": rmse, "unit": unit}
        rows.append({"phase": phase, **of_log, "source": log.attributes["source"]})
    # the whole of a sweep would be a smear: at its end a cycle is as wide as a line
    first, last = axes[0, 0].get_xlim()
    tenth = 0.1 * (last - first)
    for begin, end in axes[:2]:
        begin.set_xlim(first, first + tenth)
        end.set_xlim(last - tenth, last)
        end.set_ylabel("")
    fig.align_ylabels()
    style.share_legend(fig, test)
    style.save(fig, logs["train"].attributes, *fig8, table=pd.DataFrame(rows))
