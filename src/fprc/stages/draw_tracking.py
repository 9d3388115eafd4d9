"""Draw the closed-loop figures from raw logs."""

from collections.abc import Mapping, Sequence
from itertools import product
from typing import Any

from fprc.figures import style
from fprc.figures.tracking import (
    plot_efforts,
    plot_errors,
    plot_following,
    plot_reference_loops,
    plot_reservoir,
    shade_disturbance,
    shade_settling,
)
from fprc.logs import Columns, read_run
from fprc.logs.isolated import isolated_each

_CHANNELS = ("time_s", "theta_d_deg", "theta_deg", "p_ff_kpa", "p_fb_kpa")
_RESERVOIR = ("p_i_kpa", "p_o_kpa", "phi_deg")


def draw_following(open_loop: str, closed_loop: str, pdf: str, png: str) -> Mapping[str, Any]:
    """Figures 12 to 15: open loop, closed loop, errors, P_ff and P_fb."""
    opened, closed = isolated_each(read_run, [open_loop, closed_loop], names=_CHANNELS)
    fig, axes = style.figure(4, 1, style.COLUMN_IN, 5.2, sharex=True)
    plot_following(opened.channels, axes[0])
    plot_following(closed.channels, axes[1])
    runs = [("FPRC", "fprc", opened.channels), ("FPRC+PD", "fprc_pd", closed.channels)]
    settle_s = closed.attributes["settle_s"]
    plot_errors(runs, axes[2], judged_from_s=settle_s)
    plot_efforts(closed.channels, axes[3])
    titles = ("(a) Open loop: FPRC", f"(b) Closed loop: FPRC+PD, {closed.attributes['gain']} gain",
              "(c) Errors", "(d) Feedforward and feedback of (b)")  # fmt: skip
    for ax, title in zip(axes, titles, strict=True):
        style.letter(ax, title)
        style.legend_above(ax)
        shade_settling(ax, settle_s)
        ax.margins(x=0)
    axes[-1].set_xlabel("Time [s]; grey: settling, not judged")
    return style.save(fig, closed.attributes, pdf, png)


def draw_loops(runs: Sequence[str], pdf: str, png: str) -> Mapping[str, Any]:
    """Figure 16: actual angle over reference, PD against FPRC+PD, at both gains."""
    logs = isolated_each(read_run, runs, names=_CHANNELS)
    fig, axes = style.figure(2, 2, style.COLUMN_IN, 3.6, sharex=True, sharey=True)
    names = {"sine_0p5": "Sine 0.5 Hz", "sweep": "Sweep"}
    panels = zip(axes.flat, "abcd", product(names, ("printed", "identified")), strict=True)
    for ax, letter, (reference, gain) in panels:
        pair = [
            (label, controller, _judged(_find(logs, reference, controller, gain)))
            for controller, label in (("pd", "PD"), ("fprc_pd", "FPRC+PD"))
        ]
        plot_reference_loops(pair, ax)
        ax.label_outer()
        style.letter(ax, f"({letter}) {names[reference]}, {gain} gain")
    axes[0, 0].legend(loc="upper left")
    return style.save(fig, logs[0].attributes, pdf, png)


def draw_disturbance(run: str, pdf: str, png: str, *, quiet_s: float) -> Mapping[str, Any]:
    """Figure 17: tracking and reservoir while random forces push the reservoir."""
    (log,) = isolated_each(read_run, [run], names=(*_CHANNELS, *_RESERVOIR))
    channels = log.channels
    end_s = channels["time_s"][-1]
    fig, axes = style.figure(3, 1, style.COLUMN_IN, 4.6, sharex=True, height_ratios=(2, 1, 2))
    plot_following(channels, axes[0])
    settle_s = log.attributes["settle_s"]
    plot_errors([("Error", "fprc_pd", channels)], axes[1], judged_from_s=settle_s)
    pressures, angle = plot_reservoir(channels, axes[2])
    for ax in axes:
        shade_disturbance(ax, quiet_s, end_s)
        ax.margins(x=0)
    style.letter(axes[0], f"(a) Tracking: FPRC+PD, {log.attributes['gain']} gain")
    style.legend_above(axes[0])
    style.letter(axes[2], "(b) Reservoir")
    style.legend_above(pressures, angle)
    axes[-1].set_xlabel("Time [s]; yellow: undisturbed, grey: pushed")
    return style.save(fig, log.attributes, pdf, png)


def _judged(log: Columns) -> dict[str, Any]:
    judged = log.channels["time_s"] >= log.attributes["settle_s"]
    return {name: values[judged] for name, values in log.channels.items()}


def _find(logs: Sequence[Columns], reference: str, controller: str, gain: str) -> Columns:
    wanted = {"reference": reference, "controller": controller, "gain": gain}
    return next(log for log in logs if wanted.items() <= log.attributes.items())
