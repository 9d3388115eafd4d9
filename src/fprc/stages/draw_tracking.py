"""Draw the closed-loop figures from raw logs."""

from collections.abc import Mapping, Sequence

import numpy as np
from matplotlib.ticker import MaxNLocator

from fprc.artifacts import write_csv
from fprc.figures import style
from fprc.figures.tracking import (
    plot_errors,
    plot_following,
    plot_reference_loops,
)
from fprc.logs import Columns, read_run
from fprc.logs.columns import read_each
from fprc.paper import DISTURBANCE, LOOPS, REFERENCE_NAMES, REFERENCES
from fprc.signals import settled
from fprc.tables.figure_data import error_summary

#: Width of the narrow panels beside those of Figs. 12 to 15, s: the end of the run.
_END_S = 5.0


def draw_tracking(runs: Sequence[str], *, quiet_s: float, **figures: Sequence[str]) -> None:
    """Figures 12 to 17, those that are asked for.

    Parameters
    ----------
    runs : sequence of str
        Raw logs of the runs that they show.
    quiet_s : float
        Time before the reservoir is pushed.
    **figures : sequence of str
        Files by figure: PDF and PNG, of all but Fig. 16 also CSV.
    """
    logs = {
        (run.attributes["reference"], run.attributes["controller"]): run
        for run in read_each(read_run, runs)
    }
    pairs = {
        f"fig{number}": [logs[reference, "fprc"], logs[reference, "fprc_pd"]]
        for number, reference in enumerate(REFERENCES, start=12)
        if f"fig{number}" in figures
    }
    shown = [run for pair in pairs.values() for run in pair]
    for name, pair in pairs.items():
        _draw_following(pair, shown, figures[name])
    if "fig16" in figures:
        _draw_loops(logs, figures["fig16"])
    if "fig17" in figures:
        _draw_disturbance(logs[DISTURBANCE, "fprc_pd"], quiet_s, figures["fig17"])


def _draw_following(
    pair: Sequence[Columns], shown: Sequence[Columns], files: Sequence[str]
) -> None:
    """Figures 12 to 15: open loop, closed loop, their errors, P_ff and P_fb.

    Narrow panels on the right show the end of the run, where lines that seem one are apart. The
    axes of errors and P_fb span those of all runs ``shown``, so that the figures can be compared.
    """
    *pictures, csv = files
    table = error_summary(pair)
    write_csv(csv, table)
    limit = 1.05 * error_summary(shown)["max_abs_error_deg"].max()
    fig, axes = style.figure(
        5, 2, style.COLUMN_IN, 5.8, sharex="col", sharey="row", width_ratios=(3, 1),
        height_ratios=(4, 4, 4, 3, 3),
    )  # fmt: skip
    opened, closed = (log.channels for log in pair)
    time_s, settle_s = closed["time_s"], pair[1].attributes["settle_s"]
    for column in axes.T:
        for ax, run in zip(column, (opened, closed), strict=False):
            plot_following(run, ax)
        plot_errors({"in (a)": opened, "in (b)": closed}, column[2], limit)
        for ax, name in zip(column[3:], ("p_ff", "p_fb"), strict=True):
            ax.plot(time_s, closed[f"{name}_kpa"], color=style.SIGNALS[name], linewidth=0.7)
            ax.set_ylabel(rf"$P_\mathrm{{{name[2:]}}}$ [kPa]")
    efforts = [settled(run.channels, settle_s)["p_fb_kpa"] for run in shown]
    axes[4, 0].set_ylim(1.05 * min(map(np.min, efforts)), 1.05 * max(map(np.max, efforts)))
    style.legend_above(axes[2, 0])
    titles = "(a) FPRC", "(b) FPRC+PD", "(c) Errors", "(d) Outputs in (b)", ""
    for (ax, end), title in zip(axes, titles, strict=True):
        style.letter(ax, title)
        style.shade(ax, "settling", time_s[0], settle_s)
        ax.set_xlim(time_s[0], time_s[-1])
        end.set_xlim(time_s[-1] - _END_S, time_s[-1])
        end.set_ylabel("")
    for ax, rmse in zip(axes[:, 0], table["rmse_deg"], strict=False):
        ax.set_title(f"RMSE {rmse:.2f} deg", loc="right")
    style.share_legend(fig, axes[0, 0], 3)
    fig.align_ylabels(axes[:, 0])
    axes[-1, 0].set_xlabel("Time [s]")
    axes[-1, 1].set_xlabel(f"Last {_END_S:g} s")
    axes[-1, 1].xaxis.set_major_locator(MaxNLocator(2, integer=True))
    style.save(fig, pair[1].attributes, *pictures)


def _draw_loops(logs: Mapping[tuple[str, str], Columns], files: Sequence[str]) -> None:
    """Figure 16: actual angle over reference, PD against FPRC+PD."""
    fig, axes = style.figure(1, 2, style.COLUMN_IN, 2.2, sharex=True, sharey=True)
    for ax, letter, reference in zip(axes, "ab", LOOPS, strict=True):
        pair = (logs[reference, controller] for controller in ("pd", "fprc_pd"))
        alone, both = (settled(log.channels, log.attributes["settle_s"]) for log in pair)
        plot_reference_loops([("PD alone", "pd", alone), ("FPRC+PD", "fprc_pd", both)], ax)
        ax.label_outer()
        style.letter(ax, f"({letter}) {REFERENCE_NAMES[reference]}")
    style.share_legend(fig, axes[0], 3)
    style.save(fig, logs[LOOPS[0], "pd"].attributes, *files)


#: Panels of Fig. 17 (b), below those of (a).
_RESERVOIR = {"p_i_kpa": "$P_i$", "phi_deg": r"$\phi$", "p_o_kpa": "$P_o$"}


def _draw_disturbance(log: Columns, quiet_s: float, files: Sequence[str]) -> None:
    """Figure 17: tracking and reservoir while random forces push the reservoir."""
    *pictures, csv = files
    channels, time_s = log.channels, log.channels["time_s"]
    table = error_summary([log])
    write_csv(csv, table)
    (errors,) = table.itertuples()
    fig, axes = style.figure(5, 1, style.COLUMN_IN, 5.4, sharex=True, height_ratios=(4, 3, 3, 3, 3))
    plot_following(channels, axes[0])
    plot_errors({"": channels}, axes[1], 1.05 * errors.max_abs_error_deg)
    axes[1].set_title(f"RMSE {errors.rmse_deg:.2f} deg", loc="right")
    for ax, (name, symbol) in zip(axes[2:], _RESERVOIR.items(), strict=True):
        signal, unit = name.rsplit("_", 1)
        ax.plot(time_s, channels[name], color=style.SIGNALS[signal], linewidth=0.7)
        ax.set_ylabel(f"{symbol} [{'deg' if unit == 'deg' else 'kPa'}]")
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
    style.save(fig, log.attributes, *pictures)
