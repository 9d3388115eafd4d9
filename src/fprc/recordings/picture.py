"""One picture of a recording: every channel over time, and the loops of theta over P_exp."""

from textwrap import shorten

import numpy as np

from fprc import escape
from fprc.channels import unit_of
from fprc.figures import style
from fprc.recordings.gather import Recording
from fprc.recordings.importing import ImportMap

#: Limit on points that are drawn; more could not be seen.
_POINTS = 20000


def draw_recording(recording: Recording, mapping: ImportMap, png: str) -> None:
    """Draw every channel over time, as it was recorded, and theta over P_exp."""
    channels, columns = recording.channels, mapping.columns
    every = -(-len(recording.time_s) // _POINTS)
    rows = max(len(channels), 3)
    fig, axes = style.figure(
        rows, 2, 2 * style.COLUMN_IN, 0.3 + 0.85 * rows, width_ratios=(2.0, 1.0), squeeze=False
    )
    grid = axes[0, 0].get_gridspec()
    for ax in [*axes[:, 1], *axes[len(channels) :, 0]]:
        ax.remove()
    left = axes[: len(channels), 0]
    for ax, (name, values) in zip(left, channels.items(), strict=True):
        quantity = name.rpartition("_")[0].removesuffix("_command")
        colour = style.SIGNALS.get(quantity, style.SIGNALS["valve"])  # grey: none of its own
        ax.plot(recording.time_s, values, color=colour, linewidth=0.6)
        title = f"{name} from {columns[name]['column']}"
        note = columns[name]["note"]
        title = shorten(f"{title}: {note}" if note else title, 52, placeholder=" ...")
        style.letter(ax, escape.figure(title))
        ax.set_ylabel("" if columns[name]["unit"] == "1" else unit_of(name))
        ax.sharex(left[0])
        ax.label_outer()
    left[0].set_xlim(*recording.time_s[[0, -1]])
    left[-1].set_xlabel("Time [s]")
    target = "p_exp_kpa" if "p_exp_kpa" in channels else "p_exp_command_kpa"
    loop = fig.add_subplot(grid[:, 1])
    p_exp, theta, times = (
        np.asarray(values)[::every]
        for values in (channels[target], channels["theta_deg"], recording.time_s)
    )
    loop.scatter(p_exp, theta, c=times, s=0.5, linewidths=0, rasterized=True)
    x, y = (
        name if columns[name]["unit"] == "1" else f"{name} [{unit_of(name)}]"
        for name in (target, "theta_deg")
    )
    loop.set(xlabel=x, ylabel=y)
    style.letter(loop, "Loops, from dark to bright")
    style.save(fig, {"source": "import"}, png)
