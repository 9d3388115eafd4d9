"""Draw the figures from result files."""

from typing import Any

from fprc.figures import style
from fprc.figures.hysteresis import plot_command, plot_loop
from fprc.figures.training import plot_error, plot_fit
from fprc.logs import Columns, read_columns

_DATA = ("time_s", "p_exp_kpa", "theta_deg", "p_o_kpa")
_THETA = r"$\theta$ [deg]"
_P_EXP = r"$P_\mathrm{exp}$ [kPa]"
_P_O = r"$P_o$ [kPa]"


def draw_actuator_hysteresis(sweep: str, complex: str, pdf: str, png: str) -> None:
    """Figure 4: pressure commands and the actuator's hysteresis loops."""
    logs = []
    fig, axes = style.figure(2, 2, style.PAGE_IN, 4.2)
    titles = (("(a) Sweep", "(b) Loops of the sweep"), ("(c) Complex", "(d) Loops of (c)"))
    for path, row, title in zip((sweep, complex), axes, titles, strict=True):
        log = read_columns(path, _DATA)
        logs.append(log)
        time_s, p_exp, theta = (log.channels[name] for name in _DATA[:3])
        plot_command(time_s, p_exp, row[0], style.COLOURS["p_exp"])
        plot_loop(p_exp, theta, time_s, row[1], (_P_EXP, _THETA))
        for ax, text in zip(row, title, strict=True):
            style.letter(ax, text)
    style.save(fig, _marked(logs), pdf, png)


def draw_reservoir_hysteresis(sweep: str, complex: str, pdf: str, png: str) -> None:
    """Figure 5: hysteresis between theta and the reservoir's P_o."""
    logs = []
    fig, axes = style.figure(1, 2, style.PAGE_IN, 2.3)
    for path, ax, title in zip((sweep, complex), axes, ("(a) Sweep", "(b) Complex"), strict=True):
        log = read_columns(path, _DATA)
        logs.append(log)
        channels = log.channels
        plot_loop(channels["theta_deg"], channels["p_o_kpa"], channels["time_s"], ax,
                  (_THETA, _P_O))  # fmt: skip
        style.letter(ax, title)
    style.save(fig, _marked(logs), pdf, png)


def draw_training(fit: str, prediction: str, pdf: str, png: str) -> None:
    """Figure 8: the model on its training and on its test data."""
    logs = []
    fig, axes = style.figure(2, 2, style.PAGE_IN, 3.4, sharex="col", height_ratios=(2, 1))
    for path, column, title in zip(
        (fit, prediction), axes.T, ("(a) Training", "(b) Test"), strict=True
    ):
        log = read_columns(path, ("time_s", "p_exp_kpa", "p_ff_kpa"))
        logs.append(log)
        series = tuple(log.channels.values())
        colour = style.COLOURS[log.attributes["model"]]
        plot_fit(*series, column[0], colour=colour)
        plot_error(*series, column[1], colour=colour)
        style.letter(column[0], title)
    axes[0, 0].legend(loc="lower right", bbox_to_anchor=(1.0, 1.0), borderaxespad=0.2, ncols=2)
    style.save(fig, _marked(logs), pdf, png)


def _marked(logs: list[Columns]) -> dict[str, Any]:
    """Return the attributes of the first simulated log, or else of the first."""
    return min(logs, key=lambda log: log.attributes["source"] != "sim").attributes
