"""Draw the closed-loop figures from raw logs."""

from collections.abc import Sequence

import numpy as np
from matplotlib.lines import Line2D
from matplotlib.ticker import MaxNLocator

from fprc.artifacts import write_csv
from fprc.figures import style
from fprc.figures.tracking import (
    ERRORS,
    plot_errors,
    plot_following,
    plot_reference_loops,
)
from fprc.logs import read_run
from fprc.logs.columns import read_each
from fprc.paper import LOOPS, REFERENCE_NAMES
from fprc.signals import settled
from fprc.tables.figure_data import error_summary

#: Width of the narrow panels beside those of Figs. 12 to 15, s: the end of the run.
_END_S = 5.0


def draw_following(
    open_loop: str, closed_loop: str, runs: Sequence[str], csv: str, pdf: str, png: str
) -> None:
    """Figures 12 to 15: open loop, closed loop, their errors, P_ff and P_fb.

    Narrow panels on the right show the end of the run, where lines that seem one are apart. The
    axes of errors and P_fb span those of all ``runs``, so that the figures can be compared.
    """
    # once, because each file has its error
    paths = list(dict.fromkeys([open_loop, closed_loop, *runs]))
    logs = dict(zip(paths, read_each(read_run, paths), strict=True))
    pair = [logs[open_loop], logs[closed_loop]]
    table = error_summary(pair)
    write_csv(csv, table)
    every = error_summary([logs[run] for run in runs])
    limit = 1.05 * every["max_abs_error_deg"].max()
    fig, axes = style.figure(
        5, 2, style.COLUMN_IN, 5.8, sharex="col", sharey="row", width_ratios=(3, 1),
        height_ratios=(4, 4, 4, 3, 3),
    )  # fmt: skip
    opened, closed = (log.channels for log in pair)
    time_s, settle_s = closed["time_s"], pair[1].attributes["settle_s"]
    for column in axes.T:
        for ax, run in zip(column, (opened, closed), strict=False):
            plot_following(run, ax)
        plot_errors({"fprc": opened, "fprc_pd": closed}, column[2], limit)
        for ax, name in zip(column[3:], ("p_ff", "p_fb"), strict=True):
            ax.plot(time_s, closed[f"{name}_kpa"], color=style.SIGNALS[name], linewidth=0.7)
            ax.set_ylabel(rf"$P_\mathrm{{{name[2:]}}}$ [kPa]")
    efforts = [settled(logs[run].channels, settle_s)["p_fb_kpa"] for run in runs]
    axes[4, 0].set_ylim(1.05 * min(map(np.min, efforts)), 1.05 * max(map(np.max, efforts)))
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
    lines = [Line2D([], [], color=ERRORS[name]) for name in ERRORS]
    axes[2, 0].legend(lines, ("in (a)", "in (b)"), loc="lower right", bbox_to_anchor=(1.0, 1.0),
                      borderaxespad=0.1, ncols=2, handlelength=1.4)  # fmt: skip
    fig.align_ylabels(axes[:, 0])
    axes[-1, 0].set_xlabel("Time [s]")
    axes[-1, 1].set_xlabel(f"Last {_END_S:g} s")
    axes[-1, 1].xaxis.set_major_locator(MaxNLocator(2, integer=True))
    style.save(fig, pair[1].attributes, pdf, png)


def draw_loops(runs: Sequence[str], pdf: str, png: str) -> None:
    """Figure 16: actual angle over reference, PD against FPRC+PD.

    ``runs`` are the logs of PD and of FPRC+PD for each of ``LOOPS``, in this order.
    """
    logs = read_each(read_run, runs)
    fig, axes = style.figure(1, 2, style.COLUMN_IN, 2.2, sharex=True, sharey=True)
    pairs = zip(axes, "ab", LOOPS, logs[::2], logs[1::2], strict=True)
    for ax, letter, reference, *pair in pairs:
        alone, both = (settled(log.channels, log.attributes["settle_s"]) for log in pair)
        plot_reference_loops([("PD alone", "pd", alone), ("FPRC+PD", "fprc_pd", both)], ax)
        ax.label_outer()
        style.letter(ax, f"({letter}) {REFERENCE_NAMES[reference]}")
    style.share_legend(fig, axes[0], 3)
    style.save(fig, logs[0].attributes, pdf, png)


#: Panels of Fig. 17 (b), below those of (a).
_RESERVOIR = {"p_i_kpa": "$P_i$", "phi_deg": r"$\phi$", "p_o_kpa": "$P_o$"}


def draw_disturbance(run: str, csv: str, pdf: str, png: str, *, quiet_s: float) -> None:
    """Figure 17: tracking and reservoir while random forces push the reservoir."""
    (log,) = read_each(read_run, [run])
    channels, time_s = log.channels, log.channels["time_s"]
    table = error_summary([log])
    write_csv(csv, table)
    (errors,) = table.itertuples()
    fig, axes = style.figure(5, 1, style.COLUMN_IN, 5.4, sharex=True, height_ratios=(4, 3, 3, 3, 3))
    plot_following(channels, axes[0])
    plot_errors({"fprc_pd": channels}, axes[1], 1.05 * errors.max_abs_error_deg)
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
    style.save(fig, log.attributes, pdf, png)
