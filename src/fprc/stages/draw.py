"""Draw the figures of hysteresis and models from result files."""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import pandas as pd

from fprc import escape
from fprc.artifacts import read_json, write_csv
from fprc.figures import style
from fprc.figures.grids import plot_errors_over, plot_grid, plot_times_over
from fprc.figures.hysteresis import add_frequency_bar, plot_command, plot_loop, plot_quarters
from fprc.figures.readout import plot_readouts
from fprc.figures.training import plot_error, plot_fit, show_last_tenth
from fprc.figures.weights import plot_shares
from fprc.logs import Columns, read_columns, read_raw
from fprc.signals import loop_growth, swing_frequency, width_at_middle
from fprc.tables.drawn import fit_errors, grid_errors, grid_times, panels, weight_shares
from fprc.tables.readout import held_out
from fprc.tables.readout import readout as readout_errors
from fprc.yaml_file import read_yaml

_DATA = ("time_s", "p_target_kpa", "theta_deg")
#: Symbol and unit of a channel.
_SYMBOLS = {
    "theta": (r"$\theta$", "deg"),
    "p_target": (r"$P_\mathrm{exp}$", "kPa"),
    "p_o": ("$P_o$", "kPa"),
}


def _label(name: str, log: Columns) -> str:
    """Return symbol and unit of a log's theta, p_target or p_o."""
    symbol, unit = _SYMBOLS[name]
    return f"{symbol} [{escape.figure(log.attributes.get(f'{name}_unit', unit))}]"


def _frequencies(logs: Sequence[Columns]) -> tuple[list[np.ndarray], tuple[float, float]]:
    """Return the frequency of each log's command, and the lowest and the highest of all."""
    found = [swing_frequency(log.channels["time_s"], log.channels["p_target_kpa"]) for log in logs]
    return found, (min(map(np.min, found)), max(map(np.max, found)))


def draw_actuator_hysteresis(sweep: str, complex: str, pdf: str, png: str) -> Mapping[str, Any]:
    """Figure 4: pressure commands and the actuator's hysteresis loops."""
    logs = [read_columns(path, _DATA) for path in (sweep, complex)]
    fig, axes = style.figure(2, 2, style.COLUMN_IN, 3.7, sharey="col")
    axes[1, 1].sharex(axes[0, 1])
    titles = (("(a) Sweep", "(b) Loops of (a)"), ("(c) Complex", "(d) Loops of (c)"))
    frequencies, limits = _frequencies(logs)
    for log, f_hz, row, title in zip(logs, frequencies, axes, titles, strict=True):
        time_s, p_exp, theta = log.channels.values()
        labels = _label("p_target", log), _label("theta", log)
        plot_command(time_s, p_exp, row[0], style.SIGNALS["p_exp"], labels[0])
        lines = plot_loop(p_exp, theta, f_hz, row[1], labels, limits)
        for ax, text in zip(row, title, strict=True):
            style.letter(ax, text)
    add_frequency_bar(lines, axes.ravel())
    return style.save(fig, _attributes_for_mark(logs), pdf, png)


def draw_channels(sweep: str, csv: str, pdf: str, png: str) -> Mapping[str, Any]:
    """Draw the actuator's loops over the commanded and over the measured P_exp (C18)."""
    log = read_raw(sweep, experiment="sweep", sample_rate_hz=None, rate_tolerance=0.01)
    time_s, theta = log.channels["time_s"], log.channels["theta_deg"]
    fig, axes = style.figure(1, 2, style.COLUMN_IN, 2.2, sharey=True)
    rows = []
    for ax, name, letter, text in zip(
        axes, ("p_exp_command_kpa", "p_exp_kpa"), "ab", ("commanded", "measured"), strict=True
    ):
        pressure = log.channels[name]
        growth = loop_growth(time_s, theta, pressure)
        width = width_at_middle(theta, pressure)
        rows.append({"pressure": text, "width_kpa": width, "growth": growth})
        labels = rf"$P_\mathrm{{exp}}$ {text} [kPa]", r"$\theta$ [deg]"
        plot_quarters(time_s, pressure, theta, ax, labels)
        style.letter(ax, f"({letter}) {width:.0f} kPa wide, growth {growth:.2f}")
        ax.label_outer()
    axes[0].legend(loc="upper left", handlelength=1.2)
    write_csv(csv, pd.DataFrame(rows).assign(source=log.attributes["source"]))
    return style.save(fig, log.attributes, pdf, png)


def draw_reservoir_hysteresis(sweep: str, complex: str, pdf: str, png: str) -> Mapping[str, Any]:
    """Figure 5: hysteresis between theta and the reservoir's P_o."""
    logs = [read_columns(path, (*_DATA, "p_o_kpa")) for path in (sweep, complex)]
    fig, axes = style.figure(1, 2, style.COLUMN_IN, 2.4, sharex=True, sharey=True)
    frequencies, limits = _frequencies(logs)
    titles = "(a) Sweep", "(b) Complex"
    for log, f_hz, ax, title in zip(logs, frequencies, axes, titles, strict=True):
        theta, p_o = log.channels["theta_deg"], log.channels["p_o_kpa"]
        labels = _label("theta", log), _label("p_o", log)
        lines = plot_loop(theta, p_o, f_hz, ax, labels, limits)
        ax.label_outer()
        style.letter(ax, title)
    add_frequency_bar(lines, axes)
    return style.save(fig, _attributes_for_mark(logs), pdf, png)


def draw_training(fit: str, prediction: str, csv: str, pdf: str, png: str) -> Mapping[str, Any]:
    """Figure 8: the model on its training and on its test data."""
    names = ("time_s", "p_target_kpa", "p_ff_kpa")
    logs = {"train": read_columns(fit, names), "test": read_columns(prediction, names)}
    table = fit_errors(logs)
    write_csv(csv, table)
    fig, axes = style.figure(6, 1, style.COLUMN_IN, 6.4, height_ratios=(3, 3, 2) * 2)
    colours, titles = (style.SIGNALS["p_exp"], style.SIGNALS["p_ff"]), ("(a) Training", "(b) Test")
    drawn = zip(logs.values(), table.itertuples(), axes.reshape(2, 3), titles, strict=True)
    for log, row, (above, zoom, below), title in drawn:
        time_s, p_exp, p_ff = log.channels.values()
        grey = style.line_of(row.model)["color"]
        plot_fit(time_s, p_exp, p_ff, above, colours=colours, unit=row.unit)
        plot_fit(time_s, p_exp, p_ff, zoom, colours=colours, unit=row.unit)
        show_last_tenth(zoom, above, time_s)
        plot_error(time_s, p_exp, p_ff, below, rmse=row.rmse, colour=grey, unit=row.unit)
        style.letter(above, title)
        style.letter(zoom, "The last tenth, framed above")
    style.legend_above(axes[0])
    return style.save(fig, _attributes_for_mark([*logs.values()]), pdf, png)


def _attributes_for_mark(logs: Sequence[Columns]) -> dict[str, Any]:
    """Return the attributes of the first simulated log; if there is none, of the first log."""
    return min(logs, key=lambda log: not log.attributes["source"].endswith("sim")).attributes


def draw_weights(weights: str, published: str, csv: str, pdf: str, png: str) -> Mapping[str, Any]:
    """Figure 9: proportional contribution of the normalised weights."""
    report = read_json(weights)
    table = weight_shares(report, read_yaml(published))
    write_csv(csv, table)
    fig, ax = style.figure(1, 1, style.COLUMN_IN, 2.5)
    plot_shares(table, ax)
    style.legend_above(ax)
    return style.save(fig, report, pdf, png)


def draw_settings(
    n_c: str, times: str, csv: str, pdf: str, png: str, epsilon: str | None = None
) -> Mapping[str, Any]:
    """Figure 10: errors over epsilon and n_c, execution times over n_c.

    Without ``epsilon``, when there is no FPRC, only (b) and (c) are drawn.
    """
    by_n_c, timed = read_json(n_c), read_json(times)
    drawn = {"b": grid_errors(by_n_c, "n_c"), "c": grid_times(timed, "n_c")}
    if epsilon:
        drawn = {"a": grid_errors(read_json(epsilon), "epsilon"), **drawn}
    write_csv(csv, panels(drawn))
    fig, axes = style.figure(len(drawn), 1, style.COLUMN_IN, 5.8 if epsilon else 4.1)
    if epsilon:
        plot_errors_over(drawn["a"], "epsilon", axes[0])
        axes[0].set_xscale("log")
        axes[0].set_xlabel(r"$\epsilon$")
        style.letter(axes[0], "(a) Errors of FPRC")
    errors, seconds = axes[-2:]
    plot_errors_over(drawn["b"], "n_c", errors)
    plot_times_over(drawn["c"], "n_c", seconds)
    for ax in (errors, seconds):
        ax.set_xscale("log", base=2)
        ax.set_xlabel("$n_c$")
        ax.set_xticks(sorted(drawn["b"]["n_c"].unique()))
        ax.xaxis.set_major_formatter("{x:g}")
    style.letter(errors, "(b) Errors")
    style.letter(seconds, "(c) Execution times")
    style.share_legend(fig, errors)
    return style.save(fig, by_n_c, pdf, png)


def draw_taps(taps: str, published: str, csv: str, pdf: str, png: str) -> Mapping[str, Any]:
    """Figure 11: errors over the tap sizes; as wide as a page."""
    report, printed = read_json(taps), read_yaml(published)["table_1_configuration"]
    table = grid_errors(report, "n_u", "n_y")
    write_csv(csv, table)
    fig, axes = style.figure(1, 3, style.PAGE_IN, 2.6, sharey=True)
    papers = printed["fprc"]["n_u"], printed["shared"]["n_y"]
    for ax, letter, phase in zip(axes, "abc", style.PHASES, strict=True):
        plot_grid(table, phase, ax, papers)
        ax.label_outer()
        style.letter(ax, f"({letter})")
    return style.save(fig, report, pdf, png)


def draw_readout(cells: str, pdf: str, png: str) -> Mapping[str, Any]:
    """Draw validation (folds apart in time) and test errors over epsilon and n_u."""
    report = read_json(cells)
    table, own = readout_errors(report), report["own"]
    table = table[table["split"] == held_out(table)]
    over = {
        "epsilon": table[table["n_u"] == own["n_u"]],
        "n_u": table[table["epsilon"] == own["epsilon"]],
    }
    labels = {"epsilon": r"$\epsilon$", "n_u": "$n_u$"}
    fig, axes = style.figure(2, 2, style.COLUMN_IN, 3.8, sharey="row", sharex="col")
    for row, phase in zip(axes, ("validation", "test"), strict=True):
        for ax, setting in zip(row, over, strict=True):
            plot_readouts(over[setting], setting, f"{phase}_rmse", ax)
            if phase == "test":
                ax.set_xlabel(labels[setting])
            ax.label_outer()
            style.letter(ax, f"{phase.capitalize()}, over {labels[setting]}")
    axes[0, 0].set_xscale("log")
    style.share_legend(fig, axes[0, 0])
    return style.save(fig, report, pdf, png)
