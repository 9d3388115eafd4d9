"""Write the paper's tables as CSV and Markdown: ``files`` are named csv and md."""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from fprc.artifacts import read_json
from fprc.errors import LogError
from fprc.logs import read_run
from fprc.logs.columns import read_each
from fprc.logs.quality import warnings, warnings_of_run
from fprc.paper import SOURCES
from fprc.registry import title_of
from fprc.tables import timing, tracking
from fprc.tables.models import comparison, comparison_page, configuration, over_seeds
from fprc.tables.text import write_table
from fprc.yaml_file import read_yaml


def tabulate_configuration(published: str, *, models: Mapping[str, Any], **files: str) -> None:
    """Table I: the settings of the models."""
    table = configuration(models, read_yaml(published))
    note = "Table I. Configuration of the models: ours and as published."
    write_table(table, table.astype(str), note, **files)


_COMPARISONS = {
    "sweep": "Table II. RMSE of the models, trained on the sweep, tested on the complex log",
    "complex": "Table III. RMSE with the logs reversed: trained on the complex log, "
    "tested on the sweep",
}


def tabulate_comparison(
    published: str,
    errors: Sequence[str],
    quality: Sequence[str],
    *,
    left_out: Mapping[str, str],
    **files: str,
) -> None:
    """Tables II and III: errors of the models, one seed, spread over folds.

    ``quality`` are the quality records of the logs; failed checks stand below the table.
    ``left_out`` has the models that are not in the table, with reasons.
    """
    reports = [read_json(path) for path in errors]
    table = comparison(reports, read_yaml(published))
    first = reports[0]
    note = (
        f"{_COMPARISONS[first['trained_on']]}: mean ± standard deviation over "
        f"{len(first['train_rmse_kpa'])} {first['split']} folds, seed {first['seed']}.\n"
        f"Data: {SOURCES[first['source']]}. Target: {first['target']} pressure."
        f"{_without(left_out)}{_failed(failed_checks(quality))}"
    )
    write_table(table, comparison_page(table), note, **files)


def failed_checks(quality: Sequence[str]) -> list[str]:
    """Return a line on each log with failed checks, from files of quality records."""
    checked = [read_json(path) for path in quality]
    records = [record for content in checked for record in content.get("recordings", [content])]
    return sum(map(warnings, records), [])


def _failed(lines: Sequence[str]) -> str:
    """Return the lines of a note with the failed quality checks of the logs."""
    return "".join(f"\nFailed check: {line}." for line in lines)


def _without(left_out: Mapping[str, str]) -> str:
    """Return the lines of a note that name the models a table lacks, with reasons."""
    return "".join(f"\nNo {title_of(model)}: {why}." for model, why in left_out.items())


def tabulate_seeds(
    published: str, replicates: Sequence[str], *, trained_on: str, **files: str
) -> None:
    """Tables II and III over further seeds."""
    reports = [read_json(path) for path in replicates]
    table = over_seeds(reports, read_yaml(published), trained_on)
    note = (
        f"{_COMPARISONS[trained_on]}: mean and its 95 % interval over {len(reports)} "
        f"further seeds.\nData: {SOURCES[reports[0]['source']]}; each seed is another "
        f"draw of sensors, noise and models. {_over_starts(reports, trained_on)}"
    )
    write_table(table, comparison_page(table), note, **files)


def _over_starts(reports: Sequence[Mapping[str, Any]], trained_on: str) -> str:
    """Return a sentence on how much FPRC's errors depend on where its clustering begins."""
    train, test = (
        np.array([report["fprc_rmse_over_starts"][trained_on][phase] for report in reports])
        for phase in ("train", "test")
    )
    spread = [errors.std(axis=1, ddof=1).mean() for errors in (train, test)]
    return (
        f"Where FPRC's clustering begins, among {test.shape[1]} starts on the same rows, changes "
        f"its training RMSE by {spread[0]:.2g} and its test RMSE by {spread[1]:.2g} kPa (standard "
        "deviation within a seed); on one seed the best and the worst start are "
        f"{np.ptp(test, axis=1).max():.2g} kPa apart in the test."
    )


def tabulate_tracking(
    published: str,
    runs: Sequence[str],
    *,
    left_out: Sequence[str],
    limits: Mapping[str, Any],
    feedback: str,
    **files: str,
) -> None:
    """Table IV: errors of the closed-loop runs; failed checks of their logs stand below it.

    ``limits`` are plausible ranges, see ``fprc.logs.assess``; ``left_out`` are the runs of a
    complete Table IV that have no log; ``feedback`` describes the PD controller.

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
    table = tracking.tracking(logs, read_yaml(published))
    title = "Table IV. RMSE of tracking"
    if source == "sim":
        title += ", with the same noise and drift for all controllers"
    note = f"{title}.\nData: {SOURCES[source]}. {feedback}"
    if left_out:
        note += f"\nNo log of {len(left_out)} of its runs: {', '.join(left_out)}."
    note += _failed([line for run in logs for line in warnings_of_run(run, limits)])
    write_table(table, tracking.tracking_page(table), note, **files)


def tabulate_tracking_seeds(
    published: str, replicates: Sequence[str], *, feedback: str, **files: str
) -> None:
    """Table IV over further seeds; ``feedback`` describes the PD controller."""
    reports = [read_json(path) for path in replicates]
    table = tracking.tracking_over_seeds(reports, read_yaml(published))
    note = (
        f"Table IV, over seeds: mean RMSE and its 95 % interval over {len(reports)} further "
        f"seeds.\nData: {SOURCES[reports[0]['source']]}. {feedback} "
        f"{_tracking_over_starts(reports)}"
    )
    write_table(table, tracking.tracking_page(table), note, **files)


def _tracking_over_starts(reports: Sequence[Mapping[str, Any]]) -> str:
    """Return a sentence on how much Table IV depends on where FPRC's clustering begins."""
    shares: dict[str, list[float]] = {"fprc": [], "fprc_pd": []}
    ratios = []
    for report in reports:
        for run, errors in report["fprc_rmse_over_starts"].items():
            shares[run.partition("/")[2]].append(np.std(errors, ddof=1) / np.mean(errors))
            ratios.append(max(errors) / min(errors))
    opened, closed = (100.0 * np.mean(of_controller) for of_controller in shares.values())
    return (
        f"Where FPRC's clustering begins, among {len(errors)} starts on the same rows, changes the "
        f"RMSE of FPRC by {opened:.1f} % and that of FPRC+PD by {closed:.1f} % (standard deviation "
        f"within a seed, mean over the references that the paper prints); at most, the worst "
        f"start's is {max(ratios):.2f} times the best one's."
    )


def tabulate_times(
    published: str, times: str, *, left_out: Mapping[str, str], **files: str
) -> None:
    """Table II, execution times."""
    report = read_json(times)
    table = timing.timing(report, read_yaml(published))
    note = (
        f"Table II, execution times: mean ± standard deviation of {table['repeats'].iloc[0]} "
        f"alternating repeats on {report['cpu']}, {report['threads']} thread.\n"
        "Sequential is sample by sample, as in a controller: the fit of the whole log, and steps, "
        "of which some thousand are timed, in proportion to its samples. Batch is a whole log at "
        "once. The paper does not say which mode it timed, nor on which machine."
        f"{_without(left_out)}"
    )
    write_table(table, timing.timing_page(table), note, **files)
