"""Figures 8 and 12 to 17: a model's output, and the controllers' tracking, over time."""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator
from pandas import DataFrame

from fprc import escape
from fprc.figures import style
from fprc.logs import read_columns
from fprc.paper import LOOPS, REFERENCE_NAMES
from fprc.signals import rms, settled

Run = Mapping[str, np.ndarray]
#: Width of the narrow panels beside those of Figs. 12 to 15, s: the end of the run.
_END_S = 5.0
#: Panels of Fig. 17 (b), below those of (a).
_RESERVOIR = {"p_i_kpa": "$P_i$ [kPa]", "phi_deg": r"$\phi$ [deg]", "p_o_kpa": "$P_o$ [kPa]"}


def draw_training(fits: str, predictions: str, fig8: Sequence[str]) -> None:
    """Figure 8: the model on its training and on its test data, with its RMSE."""
    names = ("time_s", "p_target_kpa", "p_ff_kpa")
    logs = {"train": read_columns(fits, names), "test": read_columns(predictions, names)}
    table = DataFrame(
        {
            "phase": phase,
            "model": log.attributes["model"],
            "rmse": rms(log.channels["p_ff_kpa"] - log.channels["p_target_kpa"]),
            "unit": log.attributes.get("p_target_unit", "kPa"),
            "source": log.attributes["source"],
        }
        for phase, log in logs.items()
    )
    style.save(_draw_fits(logs, table), logs["train"].attributes, *fig8, table=table)


def _draw_fits(logs: Mapping[str, Any], table: DataFrame) -> Figure:
    fig, axes = style.figure(4, 2, style.COLUMN_IN, 4.4, sharey="row", height_ratios=(3, 2, 3, 2))
    whole = [fig.add_subplot(axes[0, 0].get_gridspec()[row, :]) for row in (2, 3)]
    for ax in axes[2:].ravel():
        ax.remove()
    whole[1].sharey(axes[1, 0])
    parts = axes[:2].T, [whole]
    titles = "(a) Training: first and last tenth", "(b) Test"
    for row, panels, title in zip(table.itertuples(), parts, titles, strict=True):
        for above, below in panels:
            _plot_fit(logs[row.phase].channels, above, below, row.unit)
        style.letter(panels[0][0], title)
        panels[-1][0].set_title(f"RMSE {row.rmse:.1f} {escape.figure(row.unit)}", loc="right")
    # the whole of a sweep would be a smear: at its end a cycle is as wide as a line
    first, last = axes[0, 0].get_xlim()
    tenth = 0.1 * (last - first)
    for begin, end in axes[:2]:
        begin.set_xlim(first, first + tenth)
        end.set_xlim(last - tenth, last)
        end.set_ylabel("")
    fig.align_ylabels()
    style.share_legend(fig, whole[0])
    return fig


def _plot_fit(run: Run, above: Axes, below: Axes, unit: str) -> None:
    """Draw P_exp, in kPa or another unit, and P_ff over time, and their difference below."""
    time_s, truth, model = (run[name] for name in ("time_s", "p_target_kpa", "p_ff_kpa"))
    exp, ff = r"$P_\mathrm{exp}$", r"$P_\mathrm{ff}$"
    above.plot(time_s, truth, color=style.SIGNALS["p_exp"], linewidth=1.8, label=exp)
    above.plot(time_s, model, color=style.SIGNALS["p_ff"], linewidth=0.6, label=ff)
    above.set_ylabel("Pressure [kPa]" if unit == "kPa" else f"{exp} [{escape.figure(unit)}]")
    above.tick_params(labelbottom=False)
    below.axhline(0.0, color="0.6", linewidth=0.4)
    below.plot(time_s, model - truth, color="black", linewidth=0.5)
    below.set(xlabel="Time [s]", ylabel=r"$P_\mathrm{ff} - P_\mathrm{exp}$")
    for ax in (above, below):
        ax.set_xlim(time_s[0], time_s[-1])


def draw_following(
    pair: Sequence[Any], shown: Sequence[Any], rmse_deg: Sequence[float], limit: float
) -> Figure:
    """Figures 12 to 15: open loop, closed loop, their errors, P_ff and P_fb.

    Narrow panels on the right show the end of the run, where lines that seem one are apart. The
    axes of errors, from -limit to limit, and of P_fb span those of all runs ``shown``, so that the
    figures can be compared.
    """
    fig, axes = style.figure(
        5, 2, style.COLUMN_IN, 5.8, sharex="col", sharey="row", width_ratios=(3, 1),
        height_ratios=(4, 4, 4, 3, 3),
    )  # fmt: skip
    opened, closed = (log.channels for log in pair)
    time_s, settle_s = closed["time_s"], pair[1].attributes["settle_s"]
    for column in axes.T:
        _plot_following(opened, column[0])
        _plot_following(closed, column[1])
        _plot_errors({"in (a)": opened, "in (b)": closed}, column[2], limit)
        for ax, name in zip(column[3:], ("p_ff", "p_fb"), strict=True):
            ax.plot(time_s, closed[f"{name}_kpa"], color=style.SIGNALS[name], linewidth=0.7)
            ax.set_ylabel(rf"$P_\mathrm{{{name[2:]}}}$ [kPa]")
    efforts = np.concatenate([settled(run.channels, settle_s)["p_fb_kpa"] for run in shown])
    axes[4, 0].set_ylim(1.05 * efforts.min(), 1.05 * efforts.max())
    style.legend_above(axes[2, 0])
    titles = "(a) FPRC", "(b) FPRC+PD", "(c) Errors", "(d) Outputs in (b)", ""
    for (ax, end), title in zip(axes, titles, strict=True):
        style.letter(ax, title)
        style.shade(ax, "settling", time_s[0], settle_s)
        ax.set_xlim(time_s[0], time_s[-1])
        end.set_xlim(time_s[-1] - _END_S, time_s[-1])
        end.set_ylabel("")
    for ax, rmse in zip(axes[:, 0], rmse_deg, strict=False):
        ax.set_title(f"RMSE {rmse:.2f} deg", loc="right")
    style.share_legend(fig, axes[0, 0], 3)
    fig.align_ylabels(axes[:, 0])
    axes[-1, 0].set_xlabel("Time [s]")
    axes[-1, 1].set_xlabel(f"Last {_END_S:g} s")
    axes[-1, 1].xaxis.set_major_locator(MaxNLocator(2, integer=True))
    return fig


def _plot_following(run: Run, ax: Axes) -> None:
    """Draw reference and actual angle over time."""
    for name, label, width in (("theta_d", r"$\theta_d$", 1.3), ("theta", r"$\theta$", 0.5)):
        colour = style.SIGNALS[name]
        ax.plot(run["time_s"], run[f"{name}_deg"], color=colour, label=label, linewidth=width)
    ax.set_ylabel("Angle [deg]")


def _plot_errors(runs: Mapping[str, Run], ax: Axes, limit: float) -> None:
    """Draw theta_d - theta of runs, given by label, from -limit to limit, deg; the last in black.

    Larger errors, while the actuator rises from rest, are cut off: they would flatten the others.
    """
    ax.axhline(0.0, color="0.6", linewidth=0.4)
    for (label, run), colour in zip(runs.items(), ("0.65", "black")[-len(runs) :], strict=True):
        error = run["theta_d_deg"] - run["theta_deg"]
        ax.plot(run["time_s"], error, linewidth=0.5, color=colour, label=label)
    ax.set(ylabel="Error [deg]", ylim=(-limit, limit))


def draw_reference_loops(pairs: Mapping[str, Sequence[Any]]) -> Figure:
    """Figure 16: actual angle over reference, PD against FPRC+PD, given by reference."""
    fig, axes = style.figure(1, 2, style.COLUMN_IN, 2.2, sharex=True, sharey=True)
    for ax, letter, reference in zip(axes, "ab", LOOPS, strict=True):
        labels = {"PD alone": "pd", "FPRC+PD": "fprc_pd"}
        for log, (label, controller) in zip(pairs[reference], labels.items(), strict=True):
            run = settled(log.channels, log.attributes["settle_s"])
            ax.plot(run["theta_d_deg"], run["theta_deg"], **style.line_of(controller), label=label,
                    linewidth=0.4)  # fmt: skip
        ax.axline((0, 0), slope=1, color=style.SIGNALS["theta_d"], linewidth=0.8, linestyle="--",
                  zorder=3, label=r"$\theta = \theta_d$")  # fmt: skip
        ax.set(xlabel=r"$\theta_d$ [deg]", ylabel=r"$\theta$ [deg]", xlim=(0, 65), ylim=(-3, 65))
        ax.label_outer()
        style.letter(ax, f"({letter}) {REFERENCE_NAMES[reference]}")
    style.share_legend(fig, axes[0], 3)
    return fig


def draw_disturbance(log: Any, quiet_s: float, errors: Any) -> Figure:
    """Figure 17: tracking and reservoir while random forces push the reservoir from ``quiet_s`` on.

    ``errors`` has ``rmse_deg`` and ``max_abs_error_deg`` of the run.
    """
    channels, time_s = log.channels, log.channels["time_s"]
    fig, axes = style.figure(5, 1, style.COLUMN_IN, 5.4, sharex=True, height_ratios=(4, 3, 3, 3, 3))
    _plot_following(channels, axes[0])
    _plot_errors({"": channels}, axes[1], 1.05 * errors.max_abs_error_deg)
    axes[1].set_title(f"RMSE {errors.rmse_deg:.2f} deg", loc="right")
    for ax, (name, label) in zip(axes[2:], _RESERVOIR.items(), strict=True):
        colour = style.SIGNALS[name.rpartition("_")[0]]
        ax.plot(time_s, channels[name], color=colour, linewidth=0.7)
        ax.set_ylabel(label)
    edges = time_s[0], log.attributes["settle_s"], quiet_s, time_s[-1]
    for ax in axes:
        for name, first, last in zip(style.TIMES, edges, edges[1:], strict=False):
            style.shade(ax, name, first, last)
        ax.margins(x=0)
    style.letter(axes[0], "(a) Actuator, FPRC+PD")
    style.letter(axes[2], "(b) Reservoir")
    style.share_legend(fig, axes[0], 5)
    fig.align_ylabels(axes)
    axes[-1].set_xlabel("Time [s]")
    return fig
