"""Figures 8 and 12 to 17: a model's output, and the controllers' tracking, over time."""

from collections.abc import Mapping, Sequence

import numpy as np
from matplotlib.axes import Axes

from fprc import escape
from fprc.figures.style import SIGNALS, line_of

Run = Mapping[str, np.ndarray]


def plot_fit(
    time_s: np.ndarray,
    truth_kpa: np.ndarray,
    model_kpa: np.ndarray,
    above: Axes,
    below: Axes,
    unit: str,
) -> None:
    """Draw P_exp, in kPa or another unit, and P_ff over time, and their difference below."""
    above.plot(time_s, truth_kpa, color=SIGNALS["p_exp"], linewidth=1.8, label=r"$P_\mathrm{exp}$")
    above.plot(time_s, model_kpa, color=SIGNALS["p_ff"], linewidth=0.6, label=r"$P_\mathrm{ff}$")
    other = rf"$P_\mathrm{{exp}}$ [{escape.figure(unit)}]"
    above.set(ylabel="Pressure [kPa]" if unit == "kPa" else other)
    below.axhline(0.0, color="0.6", linewidth=0.4)
    below.plot(time_s, model_kpa - truth_kpa, color="black", linewidth=0.5)
    below.set(xlabel="Time [s]", ylabel=r"$P_\mathrm{ff} - P_\mathrm{exp}$")
    for ax in (above, below):
        ax.set_xlim(time_s[0], time_s[-1])


def plot_following(run: Run, ax: Axes) -> None:
    """Draw reference and actual angle over time."""
    time_s = run["time_s"]
    ax.plot(time_s, run["theta_d_deg"], color=SIGNALS["theta_d"], label=r"$\theta_d$",
            linewidth=1.3)  # fmt: skip
    ax.plot(time_s, run["theta_deg"], color=SIGNALS["theta"], label=r"$\theta$", linewidth=0.5)
    ax.set_ylabel("Angle [deg]")


def plot_errors(runs: Mapping[str, Run], ax: Axes, limit: float) -> None:
    """Draw theta_d - theta of runs, given by label, from -limit to limit, deg; the last in black.

    Larger errors, while the actuator rises from rest, are cut off: they would flatten the others.
    """
    ax.axhline(0.0, color="0.6", linewidth=0.4)
    for (label, run), colour in zip(runs.items(), ("0.65", "black")[-len(runs) :], strict=True):
        error = run["theta_d_deg"] - run["theta_deg"]
        ax.plot(run["time_s"], error, linewidth=0.5, color=colour, label=label)
    ax.set(ylabel="Error [deg]", ylim=(-limit, limit))


def plot_reference_loops(runs: Sequence[tuple[str, str, Run]], ax: Axes) -> None:
    """Draw the actual angle over the reference, given as (label, controller, run)."""
    for label, controller, run in runs:
        ax.plot(run["theta_d_deg"], run["theta_deg"], **line_of(controller), label=label,
                linewidth=0.4)  # fmt: skip
    ax.axline((0, 0), slope=1, color=SIGNALS["theta_d"], linewidth=0.8, linestyle="--", zorder=3,
              label=r"$\theta = \theta_d$")  # fmt: skip
    ax.set(xlabel=r"$\theta_d$ [deg]", ylabel=r"$\theta$ [deg]", xlim=(0, 65), ylim=(-3, 65))
