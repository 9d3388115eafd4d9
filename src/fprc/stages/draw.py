"""Draw the figures of hysteresis and models from result files.

The files of a figure are its PDF and PNG, and the CSV with the statistics that it shows, if any.
"""

from collections.abc import Mapping, Sequence
from typing import Any

import pandas as pd
from matplotlib.axes import Axes
from matplotlib.cm import ScalarMappable

from fprc import escape
from fprc.artifacts import read_json, write_csv
from fprc.figures import style
from fprc.figures.grids import explain_grids, explain_lines, plot_grids, plot_over
from fprc.figures.hysteresis import add_frequency_bar, plot_loops
from fprc.figures.tracking import plot_fit
from fprc.figures.weights import plot_shares
from fprc.logs import Columns, read_columns
from fprc.signals import turning_points
from fprc.tables.figure_data import (
    BAND_HZ,
    fit_errors,
    grid_errors,
    mean_loops,
    smoothed,
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


def _plot_loops(logs: Sequence[Columns], axes: Sequence[Axes], x: str, y: str) -> ScalarMappable:
    """Draw the mean loops of the sweep, coloured by frequency, and the path of the complex log.

    The complex command adds up five sines, so that it has no frequency at a time.
    """
    sweep, other = (log.channels for log in logs)
    colours = plot_loops(mean_loops(sweep), axes[0], x, y, BAND_HZ)
    for log, ax in zip(logs, axes, strict=True):
        path = {name: smoothed(log.channels, name) for name in (x, y)}
        if log.channels is other:
            ax.plot(*path.values(), color="0.5", linewidth=0.4)
        # begins at rest and is not repeated
        start = slice(next(iter(turning_points(log.channels["p_target_kpa"])), 0))
        ax.plot(path[x][start], path[y][start], color="black", linewidth=0.9, label="start")
        ax.set(xlabel=_label(x, log), ylabel=_label(y, log))
        ax.legend(loc="upper left", handlelength=1.2, borderaxespad=0.0)
    return colours


def draw_hysteresis(
    sweep: str, complex: str, fig4: Sequence[str] = (), fig5: Sequence[str] = ()
) -> None:
    """Figures 4 and 5, those that are asked for."""
    if fig4:
        _draw_actuator([read_columns(path, _DATA) for path in (sweep, complex)], fig4)
    if fig5:
        _draw_reservoir(
            [read_columns(path, (*_DATA, "p_o_kpa")) for path in (sweep, complex)], fig5
        )


def _draw_actuator(logs: Sequence[Columns], files: Sequence[str]) -> None:
    """Figure 4: pressure commands, each as wide as the column, and the actuator's loops."""
    fig, axes = style.figure(3, 2, style.COLUMN_IN, 4.6, height_ratios=(1, 1, 2), sharey="row")
    commands = [fig.add_subplot(axes[row, 0].get_gridspec()[row, :]) for row in (0, 1)]
    for ax in axes[:2].ravel():
        ax.remove()
    for log, ax in zip(logs, commands, strict=True):
        time_s, command, _ = log.channels.values()
        ax.plot(time_s, command, color=style.SIGNALS["p_exp"], linewidth=0.5)
        ax.set(xlabel="Time [s]", ylabel=_label("p_target_kpa", log))
        ax.set_xlim(time_s[0], time_s[-1])
    axes[2, 1].sharex(axes[2, 0])
    colours = _plot_loops(logs, axes[2], "p_target_kpa", "theta_deg")
    axes[2, 1].label_outer()
    titles = "(a) Sweep", "(c) Complex", "(b) Loops of (a)", "(d) Loops of (c)"
    for ax, title in zip((*commands, *axes[2]), titles, strict=True):
        style.letter(ax, title)
    add_frequency_bar(colours, axes[2], "(a)")
    style.save(fig, logs[0].attributes, *files)


def _draw_reservoir(logs: Sequence[Columns], files: Sequence[str]) -> None:
    """Figure 5: hysteresis between theta and the reservoir's P_o."""
    fig, axes = style.figure(1, 2, style.COLUMN_IN, 2.4, sharex=True, sharey=True)
    colours = _plot_loops(logs, axes, "theta_deg", "p_o_kpa")
    for ax, title in zip(axes, ("(a) Sweep", "(b) Complex"), strict=True):
        ax.label_outer()
        style.letter(ax, title)
    add_frequency_bar(colours, axes, "(a)")
    style.save(fig, logs[0].attributes, *files)


def draw_training(fits: str, predictions: str, fig8: Sequence[str]) -> None:
    """Figure 8: the model on its training and on its test data."""
    names = ("time_s", "p_target_kpa", "p_ff_kpa")
    logs = {"train": read_columns(fits, names), "test": read_columns(predictions, names)}
    table = fit_errors(logs)
    *pictures, csv = fig8
    write_csv(csv, table)
    fig, axes = style.figure(4, 2, style.COLUMN_IN, 4.4, sharey="row", height_ratios=(3, 2, 3, 2))
    grid = axes[0, 0].get_gridspec()
    for ax in axes[2:].ravel():
        ax.remove()
    whole = [fig.add_subplot(grid[row, :]) for row in (2, 3)]
    whole[1].sharey(axes[1, 0])
    parts = {"train": axes[:2].T, "test": (whole,)}
    for row in table.itertuples():
        time_s, p_exp, p_ff = logs[row.phase].channels.values()
        for above, below in parts[row.phase]:
            plot_fit(time_s, p_exp, p_ff, above, below, row.unit)
            above.tick_params(labelbottom=False)
        style.letter(parts[row.phase][0][0], _TITLES_OF_FITS[row.phase])
        rmse = f"RMSE {row.rmse:.1f} {escape.figure(row.unit)}"
        parts[row.phase][-1][0].set_title(rmse, loc="right")
    # the whole of a sweep would be a smear: at its end a cycle is as wide as a line
    first, last = axes[0, 0].get_xlim()
    tenth = 0.1 * (last - first)
    for begin, end in axes[:2]:
        begin.set_xlim(first, first + tenth)
        end.set_xlim(last - tenth, last)
        end.set_ylabel("")
    fig.align_ylabels()
    style.share_legend(fig, whole[0])
    style.save(fig, logs["train"].attributes, *pictures)


def draw_weights(weights: str, published: str, fig9: Sequence[str]) -> None:
    """Figure 9: proportional contribution of the normalised weights."""
    report = read_json(weights)
    table = weight_shares(report, read_yaml(published))
    *pictures, csv = fig9
    write_csv(csv, table)
    fig, ax = style.figure(1, 1, style.COLUMN_IN, 2.8)
    plot_shares(table, ax)
    style.save(fig, report, *pictures)


def _seeds_of(reports: Sequence[Mapping[str, Any]]) -> Mapping[str, Any]:
    """Return what marks a figure of grids: the seeds of several rigs, or the one report."""
    seeds = [report["seed"] for report in reports]
    return {"seeds": seeds} if len(seeds) > 1 else reports[0]


def draw_settings(grids: Sequence[str], times: str, fig10: Sequence[str]) -> None:
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
    *pictures, csv = fig10
    write_csv(csv, pd.concat(panels, names=["panel"]).reset_index("panel"))
    fig, axes = style.figure(len(panels), 1, style.COLUMN_IN, 4.6 if "a" in panels else 3.4)
    for (panel, table), ax in zip(panels.items(), axes, strict=True):
        plot_over(table, ax, times=panel == "c")
        style.letter(ax, f"({panel}) {_TITLES_OF_SETTINGS[panel]}")
        if panel == "a":
            ax.set_xscale("log")
            ax.set_xlabel(r"$\epsilon$")
        else:
            ax.set_xscale("log", base=2)
            ax.set_xlabel("$n_c$")
            ax.set_xticks(sorted(table["value"].unique()))
            ax.xaxis.set_major_formatter("{x:g}")
    spread = f"± std over {'seeds' if len(reports) > 1 else 'folds'}"
    explain_lines(fig, list(panels["b"]["model"].unique()), spread)
    style.save(fig, _seeds_of(reports), *pictures)


def draw_taps(grids: Sequence[str], published: str, fig11: Sequence[str]) -> None:
    """Figure 11: errors over the tap sizes."""
    reports = [read_json(path) for path in grids]
    printed = read_yaml(published)["table_1_configuration"]
    table = grid_errors(reports, "taps")
    *pictures, csv = fig11
    write_csv(csv, table)
    fig, axes = style.figure(1, 3, style.COLUMN_IN, 2.5, sharey=True)
    colours = plot_grids(table, axes, (printed["fprc"]["n_u"], printed["shared"]["n_y"]))
    for ax, letter in zip(axes, "abc", strict=True):
        ax.label_outer()
        style.letter(ax, f"({letter}) {ax.get_title('left')}")
    explain_grids(fig, axes, colours, table["unit"].iloc[0])
    style.save(fig, _seeds_of(reports), *pictures)
