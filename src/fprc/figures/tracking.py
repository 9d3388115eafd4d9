"""Figures 12 to 17: the controllers' tracking of their references."""

from collections.abc import Mapping, Sequence

import numpy as np
from matplotlib.axes import Axes

from fprc.figures.style import SIGNALS, line_of

Run = Mapping[str, np.ndarray]


def plot_following(run: Run, ax: Axes) -> Axes:
    """Draw reference and actual angle over time."""
    time_s = run["time_s"]
    ax.plot(time_s, run["theta_d_deg"], color=SIGNALS["theta_d"], label=r"$\theta_d$",
            linewidth=1.3)  # fmt: skip
    ax.plot(time_s, run["theta_deg"], color=SIGNALS["theta"], label=r"$\theta$", linewidth=0.5)
    ax.set_ylabel("Angle [deg]")
    return ax


def plot_errors(runs: Sequence[tuple[str, Run]], ax: Axes, *, limit: float) -> Axes:
    """Draw theta_d - theta of runs, given as (label, run), from -limit to limit, deg.

    The last run is dark, those before it are pale. Larger errors, while the actuator rises from
    rest, are cut off: they would flatten the others.
    """
    ax.axhline(0.0, color="0.6", linewidth=0.4)
    shades = ["#9a9a9a"] * (len(runs) - 1) + ["#000000"]
    for (label, run), shade in zip(runs, shades, strict=True):
        error = run["theta_d_deg"] - run["theta_deg"]
        ax.plot(run["time_s"], error, linewidth=0.6, color=shade, label=label)
    ax.set(ylabel="Error [deg]", ylim=(-limit, limit))
    return ax


def plot_effort(run: Run, ax: Axes, name: str) -> Axes:
    """Draw P_ff or P_fb over time; ``name`` is ``p_ff`` or ``p_fb``."""
    ax.plot(run["time_s"], run[f"{name}_kpa"], color=SIGNALS[name], linewidth=0.7)
    ax.set_ylabel(rf"$P_\mathrm{{{name[2:]}}}$ [kPa]")
    return ax


def plot_reference_loops(runs: Sequence[tuple[str, str, Run]], ax: Axes) -> Axes:
    """Draw the actual angle over the reference, given as (label, controller, run)."""
    for label, controller, run in runs:
        ax.plot(run["theta_d_deg"], run["theta_deg"], **line_of(controller), label=label,
                linewidth=0.4)  # fmt: skip
    ax.axline((0, 0), slope=1, color=SIGNALS["theta_d"], linewidth=0.6, linestyle="--", zorder=3,
              label=r"$\theta = \theta_d$")  # fmt: skip
    ax.set(xlabel=r"$\theta_d$ [deg]", ylabel=r"$\theta$ [deg]", xlim=(0, 65), ylim=(-3, 65))
    return ax


def plot_over_cycle(
    time_s: np.ndarray, values: np.ndarray, cycle: np.ndarray | None, ax: Axes, name: str
) -> Axes:
    """Draw a channel, and its repeated undisturbed cycle as a pale line if there is one."""
    signal, unit = name.rsplit("_", 1)
    if cycle is not None:
        ax.plot(time_s, cycle, color=SIGNALS[signal], alpha=0.3, linewidth=2.5)
    ax.plot(time_s, values, color=SIGNALS[signal], linewidth=0.7)
    ax.set_ylabel("Angle [deg]" if unit == "deg" else "Pressure [kPa]")
    return ax


def shade_settling(ax: Axes, until_s: float) -> None:
    """Shade the settling time grey; errors in it are not judged."""
    ax.axvspan(0.0, until_s, color="0.92", linewidth=0, zorder=0)


def shade_disturbance(ax: Axes, quiet_until_s: float, end_s: float) -> None:
    """Shade the quiet time yellow and the disturbed time grey."""
    ax.axvspan(0.0, quiet_until_s, color="#fff8d6", linewidth=0, zorder=0)
    ax.axvspan(quiet_until_s, end_s, color="0.92", linewidth=0, zorder=0)
