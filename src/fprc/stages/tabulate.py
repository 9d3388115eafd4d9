"""Write the paper's tables, each as ``write_table`` does."""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from fprc.artifacts import read_json
from fprc.config.settings import Quality
from fprc.errors import LogError
from fprc.logs import read_run
from fprc.logs.columns import read_each
from fprc.logs.quality import warnings, warnings_of_run
from fprc.paper import SOURCES
from fprc.registry import title_of
from fprc.tables import tracking
from fprc.tables.models import comparison, comparison_page, configuration, over_seeds
from fprc.tables.text import write_table
from fprc.tables.timing import timing as times_of
from fprc.tables.timing import timing_page
from fprc.yaml_file import read_yaml


def tabulate_settings(published: str, table1: Sequence[str], *, models: Mapping[str, Any]) -> None:
    """Table I: the settings of the models."""
    table = configuration(models, read_yaml(published))
    title, note = "Table I. Configuration of the models", "ours and as published."
    write_table(table, table.astype(str), note, *table1, title=title)


_COMPARISONS = {
    "sweep": "Table II. RMSE of the models, trained on the sweep, tested on the complex log",
    "complex": "Table III. RMSE with the logs reversed: trained on the complex log, "
    "tested on the sweep",
}


_TRACKING = "Table IV. RMSE of tracking"


def tabulate_models(
    published: str,
    sweep: Sequence[str],
    complex: Sequence[str],
    quality: Sequence[str],
    table2: Sequence[str],
    table3: Sequence[str],
    *,
    left_out: Mapping[str, str],
) -> None:
    """Tables II and III: errors of the models, one seed, spread over folds.

    Parameters
    ----------
    sweep, complex : sequence of str
        Reports of the models that were trained on this log.
    quality : sequence of str
        Quality records of the logs; failed checks stand below the tables.
    left_out : Mapping
        The models that are not in the tables, with reasons.
    """
    for errors, files in ((sweep, table2), (complex, table3)):
        reports = [read_json(path) for path in errors]
        table = comparison(reports, read_yaml(published))
        first = reports[0]
        note = (
            "mean ± standard deviation over "
            f"{len(first['train_rmse_kpa'])} {first['split']} folds, seed {first['seed']}.\n"
            f"Data: {SOURCES[first['source']]}. Target: {first['target']} pressure."
            f"{_without(left_out)}{_failed(failed_checks(quality))}"
        )
        title = _COMPARISONS[first["trained_on"]]
        write_table(table, comparison_page(table), note, *files, title=title)


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
    published: str,
    models: Sequence[str],
    loops: Sequence[str],
    seeds: Sequence[str],
    *,
    feedback: str,
) -> None:
    """Tables II, III and IV over further seeds.

    Parameters
    ----------
    models, loops : sequence of str
        Reports of the further seeds on the models and on the closed loops.
    seeds : sequence of str
        Files of the three tables.
    feedback : str
        Describes the PD controller.
    """
    printed = read_yaml(published)
    reports = [read_json(path) for path in models]
    each = len(seeds) // 3
    for k, (trained_on, title) in enumerate(_COMPARISONS.items()):
        files = seeds[k * each :][:each]
        table = over_seeds(reports, printed, trained_on)
        note = (
            f"mean and its 95 % interval over {len(reports)} further seeds.\n"
            f"Data: {SOURCES[reports[0]['source']]}; each seed is another draw of "
            f"sensors, noise and models. {_over_starts(reports, trained_on)}"
        )
        write_table(table, comparison_page(table), note, *files, title=title)
    tracked = [read_json(path) for path in loops]
    table = tracking.tracking_over_seeds(tracked, printed)
    note = (
        f"mean and its 95 % interval over {len(tracked)} further seeds.\n"
        f"Data: {SOURCES[tracked[0]['source']]}. {feedback} {_tracking_over_starts(tracked)}"
    )
    page = tracking.tracking_page(table)
    write_table(table, page, note, *seeds[-each:], title=f"{_TRACKING}, over seeds")


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
    table4: Sequence[str],
    *,
    left_out: Sequence[str],
    limits: Mapping[str, Any],
    feedback: str,
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
    same = ", with the same noise and drift for all controllers" if source == "sim" else ""
    note = f"one run each{same}.\nData: {SOURCES[source]}. {feedback}"
    if left_out:
        note += f"\nNo log of {len(left_out)} of its runs: {', '.join(left_out)}."
    note += _failed([line for run in logs for line in warnings_of_run(run, Quality(**limits))])
    page = tracking.tracking_page(table)
    write_table(table, page, note, *table4, title=_TRACKING)


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
    published: str, times: str, timing: Sequence[str], *, left_out: Mapping[str, str]
) -> None:
    """Table II, execution times."""
    report = read_json(times)
    table = times_of(report, read_yaml(published))
    note = (
        f"mean ± standard deviation of {table['repeats'].max()} alternating repeats, of whole logs "
        f"{table['repeats'].min()}, on {report['cpu']}, {report['threads']} thread.\n"
        "Sequential is sample by sample, as in a controller: the fit of the whole log, and steps, "
        "of which some thousand are timed, in proportion to its samples. Batch is a whole log at "
        "once. The paper does not say which mode it timed, nor on which machine."
        f"{_without(left_out)}"
    )
    write_table(table, timing_page(table), note, *timing, title="Table II, execution times")
