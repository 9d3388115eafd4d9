"""Figures 4 and 5; 9, the weights of FPRC; the closed loops, Table IV and Figs. 12 to 17."""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.legend_handler import HandlerTuple
from matplotlib.lines import Line2D
from matplotlib.patches import Patch
from matplotlib.ticker import MaxNLocator

from fprc.config.settings import Quality
from fprc.errors import LogError
from fprc.experiments.comparison import CrossValidation, weight_shares
from fprc.experiments.data import read_data
from fprc.figures import style
from fprc.figures.hysteresis import draw_actuator, draw_reservoir
from fprc.given import read_yaml
from fprc.logs import assess, read_columns, read_run
from fprc.logs.columns import read_each
from fprc.paper import DISTURBANCE, LOOPS, PUBLISHED, REFERENCE_NAMES, REFERENCES, SOURCES
from fprc.signals import settled
from fprc.tables import tracking
from fprc.tables.text import failed, write_table

Run = Mapping[str, np.ndarray]
_LABELS = {"bias": "Bias", "p_o": r"$\tilde{P}_o$", "theta_d": r"$\theta_d$"}
_COLOURS = style.SIGNALS | {"bias": "#cccccc"}
#: Lines between the features of Fig. 9, from the top, by their names.
_LIMITS: dict[str, dict[str, Any]] = {
    r"$\theta_d$ above, $\tilde{P}_o$ below": {"linewidth": 1.3},
    r"$\tilde{P}_o$ above, bias below": {"linewidth": 1.3, "linestyle": (0, (1.5, 1))},
}
#: Columns of the averages, each drawn as one bar, and the bars' names.
_AVERAGES = {"mean_of_feature": "mean", "published_mean_of_feature": "paper"}
#: Width of the narrow panels beside those of Figs. 12 to 15, s: the end of the run.
_END_S = 5.0
#: Panels of Fig. 17 (b), below those of (a).
_RESERVOIR = {"p_i_kpa": "$P_i$ [kPa]", "phi_deg": r"$\phi$ [deg]", "p_o_kpa": "$P_o$ [kPa]"}


def draw_experiments(
    sweep: str = "",
    complex: str = "",
    fig4: Sequence[str] = (),
    fig5: Sequence[str] = (),
    fig9: Sequence[str] = (),
    *,
    validation: CrossValidation,
) -> None:
    """Figures 4, 5 and 9, those that are asked for; Fig. 9 needs no log ``complex``."""
    of_loops = ("time_s", "p_target_kpa", "theta_deg")
    for files, more, draw in ((fig4, (), draw_actuator), (fig5, ("p_o_kpa",), draw_reservoir)):
        if files:
            logs = [read_columns(path, (*of_loops, *more)) for path in (sweep, complex)]
            style.save(draw(logs), logs[0].attributes, *files)
    if fig9:
        data = read_data(sweep)
        described = {"source": data.attributes["source"], "seed": validation.seed}
        table = _shares(weight_shares(data, validation), described["source"])
        style.save(_draw_shares(table), described, *fig9, table=table)


def _shares(found: Mapping[str, Any], source: str) -> pd.DataFrame:
    """Share of each weight in its rule, and each feature's mean over rules, ours and the paper's.

    The paper prints no mean for the bias; it is 1 minus the two printed means.
    """
    percent = read_yaml(PUBLISHED)["fig_portion_mean_weight_share_percent"]
    printed = {name: share / 100 for name, share in percent.items()}
    printed["bias"] = 1.0 - sum(printed.values())
    return pd.DataFrame(
        {
            "rule": rule,
            "feature": feature,
            "lag": lag,
            "share": share,
            "mean_of_feature": found["mean_share"].get(feature),
            "published_mean_of_feature": printed[feature],
            "source": source,
        }
        for feature, rules in found["shares"].items()
        for rule, lags in enumerate(rules, start=1)
        for lag, share in enumerate(lags)
    )


def _draw_shares(table: pd.DataFrame) -> Figure:
    """Draw stacked bars of the rules, and beside them of the means, ours and the paper's."""
    fig, ax = style.figure(1, 1, style.COLUMN_IN, 2.8)
    shares = table.pivot(index="rule", columns=["feature", "lag"], values="share")[list(_LABELS)]
    rules, edges = list(shares.index), shares.cumsum(axis=1)
    opacity = [max(1.0 - 0.15 * lag, 0.1) for lag in range(table["lag"].max() + 1)]
    for (feature, lag), share in shares.items():
        ax.bar(rules, share, bottom=edges[feature, lag] - share, width=0.8,
               color=_COLOURS[feature], alpha=opacity[lag], linewidth=0)  # fmt: skip
    for feature, look in zip(("p_o", "bias"), _LIMITS.values(), strict=True):
        edge = edges[feature].iloc[:, -1]
        ax.hlines(edge, edge.index - 0.4, edge.index + 0.4, color=style.MARK, **look)
    places = [rules[-1] + 1.6 * number for number, _ in enumerate(_AVERAGES, start=1)]
    for place, column in zip(places, _AVERAGES, strict=True):
        means = table.groupby("feature")[column].first().reindex(list(_LABELS)).dropna()
        for feature, top in means.cumsum().items():
            share = means[feature]
            ax.bar(place, share, bottom=top - share, width=1.4, color=_COLOURS[feature],
                   linewidth=0)  # fmt: skip
            if feature != "bias":
                ax.text(place, top - share / 2, f"{100 * share:.0f} %", ha="center", va="center",
                        color="white" if feature == "p_o" else "black")  # fmt: skip
    ax.set(xlabel="Fuzzy rule", ylabel="Share of the weights", ylim=(0, 1))
    ax.set_xticks([*rules, *places], [*map(str, rules), *_AVERAGES.values()])
    ax.set_xlim(rules[0] - 0.5, places[-1] + 0.8)
    ax.tick_params(axis="x", length=0)
    # a key of the features' colours and of the shades of their taps
    taps = table.groupby("feature")["lag"].max()
    marks: list[Any] = [
        tuple(Patch(color=_COLOURS[name], alpha=shade, linewidth=0)
              for shade in opacity[: taps[name] + 1])
        for name in _LABELS
    ]  # fmt: skip
    marks += [Line2D([], [], color=style.MARK, **look) for look in _LIMITS.values()]
    steps = {name: f", $k$ to $k-{last}$" if last else "" for name, last in taps.items()}
    steps["bias"] = f", up to {100 * shares['bias'].to_numpy().max():.1f} %"
    names = [*(label + steps[name] for name, label in _LABELS.items()), *_LIMITS]
    fig.legend(
        marks, names, loc="outside upper center", ncols=2, columnspacing=1.2,
        handler_map={tuple: HandlerTuple(None, pad=0.0)},
    )  # fmt: skip
    return fig


def draw_loops(
    runs: Sequence[str],
    table4: Sequence[str] = (),
    *,
    left_out: Sequence[str],
    limits: Quality,
    feedback: str,
    quiet_s: float,
    **figures: Sequence[str],
) -> None:
    """Table IV and Figs. 12 to 17, those that are asked for.

    Below the table stand the checks that failed (``limits`` as ``fprc.logs.assess`` takes them),
    and the runs without a log (``left_out``). From ``quiet_s`` on the reservoir is pushed. LogError
    names logs that cannot be read, or two of different sources.
    """
    logs = read_each(read_run, runs)
    kinds = {run.attributes["source"]: str(run.path) for run in logs}
    if len(kinds) > 1:
        named = ", ".join(f"{source} ({path})" for source, path in kinds.items())
        raise LogError(f"closed-loop logs of different sources: {named}; use logs of one kind")
    (source,) = kinds
    if table4:
        same = ", with the same noise and drift for all controllers" if source == "sim" else ""
        note = f"one run each{same}.\nData: {SOURCES[source]}. {feedback}"
        if left_out:
            note += f"\nNo log of {len(left_out)} of its runs: {', '.join(left_out)}."
        note += failed([assess(run, limits, run.attributes["sample_rate_hz"]) for run in logs])
        columns = ["controller", "reference", "rmse_deg", "max_abs_error_deg", "source"]
        table = tracking.beside_print(tracking.errors(logs)[columns])
        write_table(table, tracking.page(table), note, *table4, title=tracking.TITLE)
    by_run = {(run.attributes["reference"], run.attributes["controller"]): run for run in logs}
    pairs = {
        f"fig{number}": [by_run[reference, loop] for loop in ("fprc", "fprc_pd")]
        for number, reference in enumerate(REFERENCES, start=12)
        if f"fig{number}" in figures
    }
    shown = [run for pair in pairs.values() for run in pair]
    for name, pair in pairs.items():
        _draw_following(pair, shown, figures[name])
    if "fig16" in figures:
        _draw_against_reference(by_run, figures["fig16"])
    if "fig17" in figures:
        _draw_disturbance(by_run[DISTURBANCE, "fprc_pd"], quiet_s, figures["fig17"])


def _draw_following(pair: Sequence[Any], shown: Sequence[Any], files: Sequence[str]) -> None:
    """Draw Figs. 12 to 15: open loop, closed loop, their errors, P_ff and P_fb.

    Narrow panels on the right show the end of the run, where lines that seem one are apart. The
    axes of errors and of P_fb span those of all runs ``shown``: the figures can be compared.
    """
    fig, axes = style.figure(
        5, 2, style.COLUMN_IN, 5.8, sharex="col", sharey="row", width_ratios=(3, 1),
        height_ratios=(4, 4, 4, 3, 3),
    )  # fmt: skip
    opened, closed = (log.channels for log in pair)
    time_s, settle_s = closed["time_s"], pair[1].attributes["settle_s"]
    table = tracking.errors(pair)
    limit = 1.05 * tracking.errors(shown)["max_abs_error_deg"].max()
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
        ax.set_title(title)
        ax.axvspan(time_s[0], settle_s, label="settling", linewidth=0, zorder=0,
                   **style.TIMES["settling"])  # fmt: skip
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
    style.save(fig, pair[1].attributes, *files, table=table)


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


def _draw_against_reference(by_run: Mapping[tuple[str, str], Any], files: Sequence[str]) -> None:
    """Draw Fig. 16: actual angle over reference, PD against FPRC+PD."""
    fig, axes = style.figure(1, 2, style.COLUMN_IN, 2.2, sharex=True, sharey=True)
    for ax, letter, reference in zip(axes, "ab", LOOPS, strict=True):
        for controller, label in (("pd", "PD alone"), ("fprc_pd", "FPRC+PD")):
            log = by_run[reference, controller]
            run = settled(log.channels, log.attributes["settle_s"])
            ax.plot(run["theta_d_deg"], run["theta_deg"], **style.line_of(controller), label=label,
                    linewidth=0.4)  # fmt: skip
        ax.axline((0, 0), slope=1, color=style.SIGNALS["theta_d"], linewidth=0.8, linestyle="--",
                  zorder=3, label=r"$\theta = \theta_d$")  # fmt: skip
        ax.set(xlabel=r"$\theta_d$ [deg]", ylabel=r"$\theta$ [deg]", xlim=(0, 65), ylim=(-3, 65))
        ax.label_outer()
        ax.set_title(f"({letter}) {REFERENCE_NAMES[reference]}")
    style.share_legend(fig, axes[0], 3)
    style.save(fig, log.attributes, *files)


def _draw_disturbance(log: Any, quiet_s: float, files: Sequence[str]) -> None:
    """Draw Fig. 17: tracking and reservoir while random forces push the reservoir."""
    channels, time_s, table = log.channels, log.channels["time_s"], tracking.errors([log])
    fig, axes = style.figure(5, 1, style.COLUMN_IN, 5.4, sharex=True, height_ratios=(4, 3, 3, 3, 3))
    _plot_following(channels, axes[0])
    _plot_errors({"": channels}, axes[1], 1.05 * table["max_abs_error_deg"][0])
    axes[1].set_title(f"RMSE {table['rmse_deg'][0]:.2f} deg", loc="right")
    for ax, (name, label) in zip(axes[2:], _RESERVOIR.items(), strict=True):
        colour = style.SIGNALS[name.rpartition("_")[0]]
        ax.plot(time_s, channels[name], color=colour, linewidth=0.7)
        ax.set_ylabel(label)
    edges = time_s[0], log.attributes["settle_s"], quiet_s, time_s[-1]
    for ax in axes:
        for name, first, last in zip(style.TIMES, edges, edges[1:], strict=False):
            ax.axvspan(first, last, label=name, linewidth=0, zorder=0, **style.TIMES[name])
        ax.margins(x=0)
    axes[0].set_title("(a) Actuator, FPRC+PD")
    axes[2].set_title("(b) Reservoir")
    style.share_legend(fig, axes[0], 5)
    fig.align_ylabels(axes)
    axes[-1].set_xlabel("Time [s]")
    style.save(fig, log.attributes, *files, table=table)
