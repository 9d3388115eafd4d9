"""Figure 9, and Table IV and the figures of closed loops, from logs.

The files of a figure are its PDF and PNG, and the CSV with the statistics that it shows, if any.
"""

from collections.abc import Sequence

from fprc.config.settings import Quality
from fprc.errors import LogError
from fprc.experiments.comparison import CrossValidation, weight_shares
from fprc.experiments.data import read_data
from fprc.figures import loops, style, weights
from fprc.given import read_yaml
from fprc.logs import read_run
from fprc.logs.columns import read_each
from fprc.logs.quality import warnings_of_run
from fprc.paper import DISTURBANCE, LOOPS, PUBLISHED, REFERENCES, SOURCES
from fprc.tables import tracking
from fprc.tables.text import failed, write_table


def draw_weights(train: str, fig9: Sequence[str], *, validation: CrossValidation) -> None:
    """Figure 9: proportional contribution of the normalised weights of the FPRC, rule by rule."""
    data = read_data(train)
    described = {"source": data.attributes["source"], "seed": validation.seed}
    shares = described | weight_shares(data, validation)
    table = weights.weight_shares(shares, read_yaml(PUBLISHED))
    style.save(weights.draw_shares(table), described, *fig9, table=table)


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
    and the runs without a log (``left_out``). From ``quiet_s`` on the reservoir is pushed.

    Raises
    ------
    LogError
        A log cannot be read, or some are simulated and others are not.
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
        note += failed([line for run in logs for line in warnings_of_run(run, limits)])
        table = tracking.tracking(logs, read_yaml(PUBLISHED))
        write_table(table, tracking.tracking_page(table), note, *table4, title=tracking.TITLE)
    by_run = {(run.attributes["reference"], run.attributes["controller"]): run for run in logs}
    pairs = {
        f"fig{number}": [by_run[reference, "fprc"], by_run[reference, "fprc_pd"]]
        for number, reference in enumerate(REFERENCES, start=12)
        if f"fig{number}" in figures
    }
    shown = sum(pairs.values(), [])
    for name, pair in pairs.items():
        table = tracking.error_summary(pair)
        limit = 1.05 * tracking.error_summary(shown)["max_abs_error_deg"].max()
        fig = loops.draw_following(pair, shown, table["rmse_deg"], limit)
        style.save(fig, pair[1].attributes, *figures[name], table=table)
    if "fig16" in figures:
        both = {name: [by_run[name, loop] for loop in ("pd", "fprc_pd")] for name in LOOPS}
        fig = loops.draw_reference_loops(both)
        style.save(fig, both[LOOPS[0]][0].attributes, *figures["fig16"])
    if "fig17" in figures:
        log = by_run[DISTURBANCE, "fprc_pd"]
        table = tracking.error_summary([log])
        fig = loops.draw_disturbance(log, quiet_s, next(table.itertuples()))
        style.save(fig, log.attributes, *figures["fig17"], table=table)
