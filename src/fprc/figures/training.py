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
) -> None:
    """Draw P_exp and P_ff over time."""
    ax.plot(time_s, truth_kpa, color=colours[0], linewidth=1.8, label=r"$P_\mathrm{exp}$")
    ax.plot(time_s, model_kpa, color=colours[1], linewidth=0.6, label=r"$P_\mathrm{ff}$")
    other = rf"$P_\mathrm{{exp}}$ [{escape.figure(unit)}]"
    ax.set(xlabel="Time [s]", ylabel="Pressure [kPa]" if unit == "kPa" else other)
    ax.set_xlim(time_s[0], time_s[-1])


def show_tenths(begin: Axes, end: Axes) -> None:
    """Cut one fit to its first tenth of the time, and the same fit beside it to its last.

    The whole of a sweep would be a smear: at its end a cycle is as wide as a line.
    """
    first, last = begin.get_xlim()
    tenth = 0.1 * (last - first)
    begin.set_xlim(first, first + tenth)
    end.set_xlim(last - tenth, last)
    end.set_ylabel("")
