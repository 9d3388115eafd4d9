"""Figures 12 to 17: the controllers' tracking of their references."""

from collections.abc import Mapping, Sequence

import numpy as np
from matplotlib.axes import Axes

from fprc.figures.style import COLOURS

Run = Mapping[str, np.ndarray]


def plot_following(run: Run, ax: Axes) -> Axes:
    """Draw reference and actual angle over time."""
    time_s = run["time_s"]
    ax.plot(time_s, run["theta_d_deg"], color=COLOURS["theta_d"], label=r"$\theta_d$",
            linewidth=1.0, linestyle=(0, (4, 1.5)))  # fmt: skip
    ax.plot(time_s, run["theta_deg"], color=COLOURS["theta"], label=r"$\theta$", linewidth=0.7)
    ax.set_ylabel("Angle [deg]")
    return ax


def plot_errors(
    runs: Sequence[tuple[str, str, Run]], ax: Axes, *, judged_from_s: float = 0.0
) -> Axes:
    """Draw theta_d - theta of several runs, given as (label, colour, run).

    The axis fits the errors after ``judged_from_s``; the larger ones during the
    step from rest would flatten them.
    """
    largest = 0.0
    for label, colour, run in runs:
        error = run["theta_d_deg"] - run["theta_deg"]
        ax.plot(run["time_s"], error, color=COLOURS[colour], label=label, linewidth=0.6)
        largest = max(largest, np.abs(error[run["time_s"] >= judged_from_s]).max())
    ax.set_ylim(-1.1 * largest, 1.1 * largest)
    ax.axhline(0.0, color="0.4", linewidth=0.4)
    ax.set_ylabel("Error [deg]")
    return ax


def plot_efforts(run: Run, ax: Axes) -> Axes:
    """Draw P_ff and P_fb over time."""
    for name, label in (("p_ff", r"$P_\mathrm{ff}$"), ("p_fb", r"$P_\mathrm{fb}$")):
        ax.plot(run["time_s"], run[f"{name}_kpa"], color=COLOURS[name], label=label, linewidth=0.7)
    ax.set_ylabel("Pressure [kPa]")
    return ax


def plot_reference_loops(runs: Sequence[tuple[str, str, Run]], ax: Axes) -> Axes:
    """Draw the actual angle over the reference, given as (label, colour, run)."""
    for label, colour, run in runs:
        ax.plot(run["theta_d_deg"], run["theta_deg"], color=COLOURS[colour], label=label,
                linewidth=0.4)  # fmt: skip
    ax.axline((0, 0), slope=1, color="0.4", linewidth=0.4, linestyle=":")
    ax.set(xlabel=r"$\theta_d$ [deg]", ylabel=r"$\theta$ [deg]", xlim=(0, 65), ylim=(-3, 65))
    return ax


def plot_reservoir(run: Run, ax: Axes) -> tuple[Axes, Axes]:
    """Draw P_i and P_o, and on a second axis the reservoir's bending."""
    for name, label in (("p_i", r"$P_i$"), ("p_o", r"$P_o$")):
        ax.plot(run["time_s"], run[f"{name}_kpa"], color=COLOURS[name], label=label, linewidth=0.7)
    ax.set_ylabel("Pressure [kPa]")
    angle = ax.twinx()
    angle.spines.right.set_visible(True)
    angle.plot(run["time_s"], run["phi_deg"], color=COLOURS["phi"], linewidth=0.7,
               label="Bending")  # fmt: skip
    angle.set_ylabel("Bending of the reservoir [deg]", color=COLOURS["phi"])
    return ax, angle


def shade_settling(ax: Axes, until_s: float) -> None:
    """Shade the settling time grey; errors in it are not judged."""
    ax.axvspan(0.0, until_s, color="0.92", linewidth=0, zorder=0)


def shade_disturbance(ax: Axes, quiet_until_s: float, end_s: float) -> None:
    """Shade the quiet time yellow and the disturbed time grey."""
    ax.axvspan(0.0, quiet_until_s, color="#fff3b0", linewidth=0, zorder=0)
    ax.axvspan(quiet_until_s, end_s, color="0.88", linewidth=0, zorder=0)
