"""Figure 8: output of a model on its training and its test data."""

import numpy as np
from matplotlib.axes import Axes

from fprc import escape


def plot_fit(
    time_s: np.ndarray,
    truth_kpa: np.ndarray,
    model_kpa: np.ndarray,
    ax: Axes,
    *,
    colours: tuple[str, str],
    unit: str = "kPa",
) -> Axes:
    """Draw P_exp and P_ff over time."""
    ax.plot(time_s, truth_kpa, color=colours[0], linewidth=1.2, label=r"$P_\mathrm{exp}$")
    ax.plot(time_s, model_kpa, color=colours[1], linewidth=0.4, label=r"$P_\mathrm{ff}$")
    ax.set(
        ylabel="Pressure [kPa]" if unit == "kPa" else rf"$P_\mathrm{{exp}}$ [{escape.figure(unit)}]"
    )
    ax.set_xlim(time_s[0], time_s[-1])
    return ax


def plot_error(
    time_s: np.ndarray,
    truth_kpa: np.ndarray,
    model_kpa: np.ndarray,
    ax: Axes,
    *,
    rmse: float,
    colour: str,
    unit: str = "kPa",
) -> Axes:
    """Draw P_ff - P_exp over time, with its RMSE above."""
    ax.plot(time_s, model_kpa - truth_kpa, color=colour, linewidth=0.4)
    ax.axhline(0.0, color="0.6", linewidth=0.4)
    unit = escape.figure(unit)
    ax.set_title(f"RMSE {rmse:.1f} {unit}", loc="right")
    ax.set(xlabel="Time [s]", ylabel=f"Error [{unit}]", xlim=(time_s[0], time_s[-1]))
    return ax


def show_last_tenth(ax: Axes, whole: Axes, time_s: np.ndarray) -> None:
    """Zoom in on the last tenth of the time, with lines twice as wide; frame it in ``whole``."""
    begin_s, end_s = 0.9 * time_s[-1] + 0.1 * time_s[0], time_s[-1]
    ax.set_xlim(begin_s, end_s)
    for line in ax.lines:
        line.set_linewidth(2.0 * line.get_linewidth())
    whole.axvspan(begin_s, end_s, facecolor="none", edgecolor="black", linewidth=0.7, zorder=3)
