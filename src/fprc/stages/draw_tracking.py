"""Draw the closed-loop figures from raw logs."""

from collections.abc import Sequence

from fprc.artifacts import write_csv
from fprc.figures import style
from fprc.figures.tracking import plot_error, plot_following, plot_reference_loops
from fprc.logs import read_run
from fprc.logs.columns import read_each
from fprc.paper import LOOPS, REFERENCE_NAMES
from fprc.signals import settled
from fprc.tables.figure_data import error_summary

#: Behind the time of settling or of pushes.
_GREY = "0.92"
#: Panels of the reservoir in Fig. 17.
_RESERVOIR = {
    "p_i_kpa": "(b) Input $P_i$", "phi_deg": r"Bending $\phi$", "p_o_kpa": "Output $P_o$"
}  # fmt: skip


def draw_following(
    open_loop: str, closed_loop: str, runs: Sequence[str], csv: str, pdf: str, png: str
) -> None:
    """Figures 12 to 15: open loop, closed loop, their errors, P_ff and P_fb.

    The axes of the errors span those of all ``runs``, so that the four figures can be compared.
    """
    # once, because each file has its error
    paths = list(dict.fromkeys([open_loop, closed_loop, *runs]))
    logs = dict(zip(paths, read_each(read_run, paths), strict=True))
    opened, closed = logs[open_loop], logs[closed_loop]
    table = error_summary([opened, closed])
    write_csv(csv, table)
    every = error_summary([logs[run] for run in runs])
    limit = 1.05 * every["max_abs_error_deg"].max()
    heights = (4, 4, 3, 3, 3, 2)
    fig, axes = style.figure(6, 1, style.COLUMN_IN, 6.2, sharex=True, height_ratios=heights)
    for k, (run, rmse) in enumerate(zip((opened, closed), table["rmse_deg"], strict=True)):
        plot_following(run.channels, axes[k])
        plot_error(run.channels, axes[k + 2], limit=limit, rmse=rmse)
    for ax, name in zip(axes[4:], ("p_ff", "p_fb"), strict=True):
        effort = closed.channels[f"{name}_kpa"]
        ax.plot(closed.channels["time_s"], effort, color=style.SIGNALS[name], linewidth=0.7)
        ax.set_ylabel(rf"$P_\mathrm{{{name[2:]}}}$ [kPa]")
    titles = (
        "(a) FPRC, open loop", "(b) FPRC+PD, closed loop", "(c) Error in (a)", "Error in (b)",
        "(d) Outputs in (b)", "",
    )  # fmt: skip
    for ax, title in zip(axes, titles, strict=True):
        style.letter(ax, title)
        ax.axvspan(0.0, closed.attributes["settle_s"], color=_GREY, linewidth=0, zorder=0)
        ax.margins(x=0)
    style.legend_above(axes[0])
    fig.align_ylabels(axes)
    axes[-1].set_xlabel("Time [s]; grey: settling, not judged")
    style.save(fig, closed.attributes, pdf, png)


def draw_loops(runs: Sequence[str], pdf: str, png: str) -> None:
    """Figure 16: actual angle over reference, PD against FPRC+PD.

    ``runs`` are the logs of PD and of FPRC+PD for each of ``LOOPS``, in this order.
    """
    logs = read_each(read_run, runs)
    fig, axes = style.figure(1, 2, style.COLUMN_IN, 2.1, sharex=True, sharey=True)
    pairs = zip(axes, "ab", LOOPS, logs[::2], logs[1::2], strict=True)
    for ax, letter, reference, *pair in pairs:
        alone, both = (settled(log.channels, log.attributes["settle_s"]) for log in pair)
        plot_reference_loops([("PD alone", "pd", alone), ("FPRC+PD", "fprc_pd", both)], ax)
        ax.label_outer()
        style.letter(ax, f"({letter}) {REFERENCE_NAMES[reference]}")
    axes[0].legend(loc="lower right", handlelength=1.4, labelspacing=0.2, borderaxespad=0.1)
    style.save(fig, logs[0].attributes, pdf, png)


def draw_disturbance(run: str, csv: str, pdf: str, png: str, *, quiet_s: float) -> None:
    """Figure 17: tracking and reservoir while random forces push the reservoir."""
    (log,) = read_each(read_run, [run])
    channels, time_s = log.channels, log.channels["time_s"]
    table = error_summary([log])
    write_csv(csv, table)
    (errors,) = table.itertuples()
    fig, axes = style.figure(5, 1, style.COLUMN_IN, 5.8, sharex=True, height_ratios=(4, 3, 3, 4, 4))
    plot_following(channels, axes[0])
    limit = 1.05 * errors.max_abs_error_deg
    plot_error(channels, axes[1], limit=limit, rmse=errors.rmse_deg)
    for ax, (name, title) in zip(axes[2:], _RESERVOIR.items(), strict=True):
        signal, unit = name.rsplit("_", 1)
        style.letter(ax, title)
        ax.plot(time_s, channels[name], color=style.SIGNALS[signal], linewidth=0.7)
        ax.set_ylabel("Angle [deg]" if unit == "deg" else "Pressure [kPa]")
    for ax in axes:
        ax.axvspan(quiet_s, time_s[-1], color=_GREY, linewidth=0, zorder=0)
        ax.margins(x=0)
    style.letter(axes[0], "(a) FPRC+PD")
    style.legend_above(axes[0])
    fig.align_ylabels(axes)
    axes[-1].set_xlabel("Time [s]; grey: pushed")
    style.save(fig, log.attributes, pdf, png)
