"""Draw the figures of hysteresis and models from result files."""

from collections.abc import Mapping, Sequence
from typing import Any

import pandas as pd
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection

from fprc import escape
from fprc.artifacts import read_json, write_csv
from fprc.figures import style
from fprc.figures.grids import (
    explain_frames,
    plot_grid,
    plot_over,
)
from fprc.figures.hysteresis import add_frequency_bar, plot_loop
from fprc.figures.tracking import plot_fit
from fprc.figures.weights import plot_shares
from fprc.logs import Columns, read_columns
from fprc.signals import swing_frequency, turning_points
from fprc.tables.figure_data import (
    fit_errors,
    grid_errors,
    times_over_n_c,
    weight_shares,
)
from fprc.yaml_file import read_yaml

_TITLES_OF_SETTINGS = {
    "a": "Errors of FPRC", "b": "Errors", "c": "Execution times, batch"
}  # fmt: skip
_TITLES_OF_FITS = {"train": "(a) Training: first and last tenth", "test": "(b) Test"}
_DATA = ("time_s", "p_target_kpa", "theta_deg")
#: Symbol and unit of a channel.
_SYMBOLS = {
    "theta_deg": (r"$\theta$", "deg"),
    "p_target_kpa": (r"$P_\mathrm{exp}$", "kPa"),
    "p_o_kpa": ("$P_o$", "kPa"),
}


def _label(channel: str, log: Columns) -> str:
    """Return symbol and unit of a log's theta, p_target or p_o."""
    symbol, unit = _SYMBOLS[channel]
    quantity = channel.rpartition("_")[0]
    return f"{symbol} [{escape.figure(log.attributes.get(f'{quantity}_unit', unit))}]"


def _plot_loops(logs: Sequence[Columns], axes: Sequence[Axes], x: str, y: str) -> LineCollection:
    """Draw the loops of the sweep, coloured by frequency, and in grey those of the complex log.

    The complex command adds up five sines, so that it has no frequency at a time.
    """
    lines: list[LineCollection] = []
    for log, ax in zip(logs, axes, strict=True):
        channels, command = log.channels, log.channels["p_target_kpa"]
        f_hz = None if lines else swing_frequency(channels["time_s"], command)
        labels = _label(x, log), _label(y, log)
        lines.append(plot_loop(channels[x], channels[y], ax, labels, f_hz))
        # begins at rest and is not repeated
        start = slice(next(iter(turning_points(command)), 0))
        ax.plot(channels[x][start], channels[y][start], color="black", linewidth=0.7,
                label="start", rasterized=True)  # fmt: skip
    axes[1].legend(loc="upper left", handlelength=1.6)
    return lines[0]


def draw_actuator_hysteresis(sweep: str, complex: str, pdf: str, png: str) -> None:
    """Figure 4: pressure commands and the actuator's hysteresis loops."""
    logs = [read_columns(path, _DATA) for path in (sweep, complex)]
    fig, axes = style.figure(2, 2, style.COLUMN_IN, 3.7, sharey="col")
    axes[1, 1].sharex(axes[0, 1])
    titles = (("(a) Sweep", "(b) Loops of (a)"), ("(c) Complex", "(d) Loops of (c)"))
    for log, row, title in zip(logs, axes, titles, strict=True):
        time_s, command, _ = log.channels.values()
        row[0].plot(time_s, command, color=style.SIGNALS["p_exp"], linewidth=0.5)
        row[0].set(xlabel="Time [s]", ylabel=_label("p_target_kpa", log))
        row[0].set_xlim(time_s[0], time_s[-1])
        for ax, text in zip(row, title, strict=True):
            style.letter(ax, text)
    lines = _plot_loops(logs, axes[:, 1], "p_target_kpa", "theta_deg")
    add_frequency_bar(lines, axes.ravel(), "(b)")
    style.save(fig, logs[0].attributes, pdf, png)


def draw_reservoir_hysteresis(sweep: str, complex: str, pdf: str, png: str) -> None:
    """Figure 5: hysteresis between theta and the reservoir's P_o."""
    logs = [read_columns(path, (*_DATA, "p_o_kpa")) for path in (sweep, complex)]
    fig, axes = style.figure(1, 2, style.COLUMN_IN, 2.4, sharex=True, sharey=True)
    lines = _plot_loops(logs, axes, "theta_deg", "p_o_kpa")
    for ax, title in zip(axes, ("(a) Sweep", "(b) Complex"), strict=True):
        ax.label_outer()
        style.letter(ax, title)
    add_frequency_bar(lines, axes, "(a)")
    style.save(fig, logs[0].attributes, pdf, png)


def draw_training(fits: str, predictions: str, csv: str, pdf: str, png: str) -> None:
    """Figure 8: the model on its training and on its test data."""
    names = ("time_s", "p_target_kpa", "p_ff_kpa")
    logs = {"train": read_columns(fits, names), "test": read_columns(predictions, names)}
    table = fit_errors(logs)
    write_csv(csv, table)
    fig, axes = style.figure(2, 2, style.COLUMN_IN, 3.2, sharey="row")
    whole = fig.add_subplot(axes[1, 0].get_gridspec()[1, :])
    for ax in axes[1]:
        ax.remove()
    begin, end = axes[0]
    parts = {"train": (begin, end), "test": (whole,)}
    for row in table.itertuples():
        time_s, p_exp, p_ff = logs[row.phase].channels.values()
        for ax in parts[row.phase]:
            plot_fit(time_s, p_exp, p_ff, ax, row.unit)
        style.letter(parts[row.phase][0], _TITLES_OF_FITS[row.phase])
        rmse = f"RMSE {row.rmse:.1f} {escape.figure(row.unit)}"
        parts[row.phase][-1].set_title(rmse, loc="right")
    # the whole of a sweep would be a smear: at its end a cycle is as wide as a line
    first, last = begin.get_xlim()
    tenth = 0.1 * (last - first)
    begin.set_xlim(first, first + tenth)
    end.set_xlim(last - tenth, last)
    end.set_ylabel("")
    style.share_legend(fig, whole)
    style.save(fig, logs["train"].attributes, pdf, png)


def draw_weights(weights: str, published: str, csv: str, pdf: str, png: str) -> None:
    """Figure 9: proportional contribution of the normalised weights."""
    report = read_json(weights)
    table = weight_shares(report, read_yaml(published))
    write_csv(csv, table)
    fig, ax = style.figure(1, 1, style.COLUMN_IN, 2.5)
    plot_shares(table, ax)
    style.save(fig, report, pdf, png)


def _seeds_of(reports: Sequence[Mapping[str, Any]]) -> Mapping[str, Any]:
    """Return what marks a figure of grids: the seeds of several rigs, or the one report."""
    seeds = [report["seed"] for report in reports]
    return {"seeds": seeds} if len(seeds) > 1 else reports[0]


def draw_settings(grids: Sequence[str], times: str, csv: str, pdf: str, png: str) -> None:
    """Figure 10: errors over epsilon and n_c, execution times over n_c.

    The errors are over further seeds, or over the folds of one report. Without errors over
    epsilon, when there is no FPRC, only (b) and (c) are drawn.
    """
    reports = [read_json(path) for path in grids]
    panels = {
        "a": grid_errors(reports, "epsilon"),
        "b": grid_errors(reports, "n_c"),
        "c": times_over_n_c(read_json(times)),
    }
    if panels["a"].empty:
        del panels["a"]
    write_csv(csv, pd.concat(panels, names=["panel"]).reset_index("panel"))
    fig, axes = style.figure(len(panels), 1, style.COLUMN_IN, 5.0 if "a" in panels else 3.6)
    for (panel, table), ax in zip(panels.items(), axes, strict=True):
        plot_over(table, ax, times=panel == "c")
        style.letter(ax, f"({panel}) {_TITLES_OF_SETTINGS[panel]}")
        if panel == "a":
            ax.set_xscale("log")
            ax.set_xlabel(r"$\epsilon$")
            ax.legend(loc="center left", bbox_to_anchor=(1.0, 0.5), handlelength=1.4)
        else:
            ax.set_xscale("log", base=2)
            ax.set_xlabel("$n_c$")
            ax.set_xticks(sorted(table["value"].unique()))
            ax.xaxis.set_major_formatter("{x:g}")
    if "a" not in panels:
        style.share_legend(fig, axes[0])
    style.save(fig, _seeds_of(reports), pdf, png)


def draw_taps(grids: Sequence[str], published: str, csv: str, pdf: str, png: str) -> None:
    """Figure 11: errors over the tap sizes; as wide as a page."""
    reports = [read_json(path) for path in grids]
    printed = read_yaml(published)["table_1_configuration"]
    table = grid_errors(reports, "taps")
    write_csv(csv, table)
    fig, axes = style.figure(1, 3, style.PAGE_IN, 2.7, sharey=True)
    papers = printed["fprc"]["n_u"], printed["shared"]["n_y"]
    for ax, letter, phase in zip(axes, "abc", style.PHASES, strict=True):
        plot_grid(table, phase, ax, papers)
        ax.label_outer()
        style.letter(ax, f"({letter})")
    explain_frames(fig)
    style.save(fig, _seeds_of(reports), pdf, png)
