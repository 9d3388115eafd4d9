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
    """Draw P_ff - P_exp over time, with its RMSE in the corner."""
    error = model_kpa - truth_kpa
    ax.plot(time_s, error, color=colour, linewidth=0.4)
    ax.axhline(0.0, color="0.4", linewidth=0.4)
    unit = escape.figure(unit)
    ax.text(
        0.99, 0.96, f"RMSE {rmse:.1f} {unit}", transform=ax.transAxes, ha="right", va="top",
        fontsize=6, bbox={"facecolor": "white", "edgecolor": "none", "alpha": 0.8, "pad": 1},
    )  # fmt: skip
    ax.set(xlabel="Time [s]", ylabel=f"Error [{unit}]")
    ax.set_xlim(time_s[0], time_s[-1])
    return ax
