"""Write the paper's tables as CSV, Markdown and LaTeX: ``files`` are named csv, md and tex."""

import logging
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import pandas as pd

from fprc.artifacts import read_json, write_csv, write_text
from fprc.errors import LogError
from fprc.logs import read_run
from fprc.logs.isolated import isolated_each
from fprc.logs.quality import implausible
from fprc.paper import SOURCES
from fprc.registry import title_of
from fprc.tables import readout, robustness, timing, tracking
from fprc.tables.models import comparison, comparison_page, configuration, orders, over_seeds
from fprc.tables.text import markdown, write_table
from fprc.yaml_file import read_yaml

log = logging.getLogger(__name__)


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
    published: str, errors: Sequence[str], *, left_out: Mapping[str, str], **files: str
) -> None:
    """Tables II and III: errors of the models, one seed, spread over folds.

    ``left_out`` has the models that are not in the table, with reasons.
    """
    reports = [read_json(path) for path in errors]
    table = comparison(reports, read_yaml(published))
    first = reports[0]
    note = (
        f"{_COMPARISONS[first['trained_on']]}: mean ± standard deviation over "
        f"{len(first['train_rmse_kpa'])} {first['split']} folds, seed {first['seed']}.\n"
        f"Data: {SOURCES[first['source']]}. Target: {first['target']} pressure."
        f"{_without(left_out)}"
    )
    write_table(table, comparison_page(table), note, **files)


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
        "draw of sensors, noise and models."
    )
    write_table(table, comparison_page(table), note, **files)


def tabulate_orders(replicates: Sequence[str], csv: str) -> None:
    """Write, for each further seed, whether the orders of Tables II and III hold."""
    write_csv(csv, orders([read_json(path) for path in replicates]))


def tabulate_tracking(
    published: str,
    runs: Sequence[str],
    *,
    left_out: Sequence[str],
    limits: Mapping[str, Any],
    feedback: str,
    **files: str,
) -> None:
    """Table IV: errors of the closed-loop runs; warns of implausible channels in their logs.

    ``limits`` are plausible ranges, see ``fprc.logs.assess``; ``left_out`` are the runs of a
    complete Table IV that have no log; ``feedback`` describes the PD controller.

    Raises
    ------
    LogError
        A log cannot be read, or some are simulated and others are not.
    """
    logs = isolated_each(read_run, runs)
    kinds = {run.attributes["source"]: str(run.path) for run in logs}
    if len(kinds) > 1:
        each = ", ".join(f"{source} ({path})" for source, path in kinds.items())
        raise LogError(f"closed-loop logs of different sources: {each}; use logs of one kind")
    (source,) = kinds
    for line in sum((implausible(run, limits) for run in logs), []):
        log.warning("warning: %s", line)
    table = tracking.tracking(logs, read_yaml(published))
    title = "Table IV. RMSE of tracking"
    if source == "sim":
        title += ", with the same noise and drift for all controllers"
    note = f"{title}.\nData: {SOURCES[source]}. {feedback}"
    if left_out:
        note += f"\nNo log of {len(left_out)} of its runs: {', '.join(left_out)}."
    write_table(table, tracking.tracking_page(table), note, **files)


def tabulate_tracking_seeds(
    published: str, replicates: Sequence[str], *, feedback: str, **files: str
) -> None:
    """Table IV over further seeds; ``feedback`` describes the PD controller."""
    reports = [read_json(path) for path in replicates]
    table = tracking.tracking_over_seeds(reports, read_yaml(published))
    note = (
        f"Table IV, over seeds: mean RMSE and its 95 % interval over {len(reports)} further "
        f"seeds.\nData: {SOURCES[reports[0]['source']]}. {feedback}"
    )
    write_table(table, tracking.tracking_page(table), note, **files)


_FOLDS = {
    "blocked": "Blocked folds keep neighbours in time out of the validation.",
    "recordings": "Folds of recordings validate on recordings that did not train.",
}


def tabulate_readout(
    cells: str, *, parts: tuple[str, str] = ("the sweep", "the complex log"), **files: str
) -> None:
    """Compare FPRC with P_o, without it, and with substitutes for it.

    ``parts`` are the names of the training log and the test log.
    """
    report = read_json(cells)
    table = readout.readout(report)
    own = report["own"]
    note = (
        "Readout value: FPRC with P_o, without it and with substitutes for it, at epsilon = "
        f"{own['epsilon']:g} and n_u = {own['n_u']}, mean ± standard deviation over folds.\n"
        f"Data: {SOURCES[report['source']]}, seed {report['seed']}; trained on {parts[0]}, "
        f"tested on {parts[1]}. {_FOLDS[readout.held_out(table)]}"
    )
    write_table(table, readout.readout_page(table, own), note, **files)


def tabulate_ensemble(summary: str, **files: str) -> None:
    """Count the rigs of a set on which each claim holds."""
    report = read_json(summary)
    table = robustness.ensemble(report)
    limit = table["least_significant"].iloc[0]
    draws = f", {report['draws']} draws in all" if report["draws"] else ""
    median, low, high = report["worth"]
    note = (
        f"Claims on {report['rigs'] - report['failed']} simulated {report['drawn']}; "
        f"{report['failed']} more could not be judged{draws}. With the full models the errors of "
        f"Tables II and III deviate from print by {100 * report['deviation']:.0f} % (rms of "
        "logarithms). FPRC's test RMSE over that of the same model on low-passed theta_d (B1): "
        f"median {median:.2f}, 95 % of the rigs {low:.2f} to {high:.2f}.\n"
        "The intervals are for the number of rigs; they do not cover the choice of how the rigs "
        "were drawn. A parameter is named if its rank correlation with the claim exceeds "
        f"{limit:.2f}; by chance alone, any parameter would do so in only one of twenty sets of "
        "independent rigs."
    )
    write_table(table, robustness.ensemble_page(table), note, **files)


def tabulate_worth(summary: str, **files: str) -> None:
    """Count the rigs of a set on which P_o is worth more than a low-pass of theta_d."""
    report = read_json(summary)
    table = robustness.worth(report)
    tests = int((table["given"] != "").sum())
    note = (
        f"B1 on {report['rigs'] - report['failed']} simulated {report['drawn']}, and on those of "
        "them on which other claims hold too: how often FPRC has a smaller test RMSE with P_o "
        "than with low-passed theta_d, and the ratio of the two.\n"
        "On more than half: yes or no if the interval of the share excludes one half. p: Fisher's "
        f"exact test, two-sided, against the other rigs; a condition matters if p is below 0.05 "
        f"divided by {tests}, the number of tests. Interval and p take the rigs as independent, "
        "which those of a sampler are not quite, and do not cover how they were drawn."
    )
    write_table(table, robustness.worth_page(table), note, **files)


def tabulate_near_print(summary: str, **files: str) -> None:
    """Count the rigs of a set whose errors are within limits of the printed ones."""
    report = read_json(summary)
    table = robustness.near_print(report)
    note = (
        f"Limits on the deviation from print, on {report['rigs'] - report['failed']} simulated "
        f"{report['drawn']}: how many rigs are within each one, on one recording of each, and how "
        "many of these also have a claim."
    )
    write_table(table, robustness.near_print_page(table), note, **files)


def tabulate_history(members: str, **files: str) -> None:
    """Write how closely the rigs of the posterior match the printed errors, step by step."""
    report = read_json(members)
    table = pd.DataFrame(
        {"accepted": "", **row, "source": report["source"]} for row in report["history"]
    )
    note = (
        f"Posterior: rms deviation of the logarithms of {len(report['errors'])} errors from the "
        "printed ones, over the rigs of each step.\nSimulated, with the surrogate models; "
        "accepted: share of the sampler's proposals since its start."
    )
    page = pd.DataFrame(
        {
            "Step": table["step"],
            "Rigs": table["rigs"],
            "Deviation": [f"{100 * value:.0f} %" for value in table["deviation"]],
            "Accepted": [
                f"{100 * row['accepted']:.0f} %" if "accepted" in row else ""
                for row in report["history"]
            ],
        }
    )
    write_table(table, page, note, **files)


def tabulate_sensitivity(effects: str, **files: str) -> None:
    """Write the sensitivity of each error to each parameter of the rig."""
    report = read_json(effects)
    table = robustness.sensitivity(report)
    impossible = sum(cell["errors"] is None for cell in report["cells"])
    note = (
        "Sensitivity: change of each error while one parameter goes from end to end of its range, "
        f"relative to the fitted rig.\nSimulated, with the surrogate models, mean of "
        f"{len(report['seeds'])} seeds; {impossible} of {len(report['cells'])} rigs are impossible "
        "and left out. The tables do not determine a parameter to which no error is sensitive."
    )
    write_table(table, robustness.sensitivity_page(table), note, **files)


def tabulate_targets(
    published: str,
    replicates: Sequence[str],
    controls: Sequence[str],
    *,
    names: Sequence[str],
    **files: str,
) -> None:
    """Compare commanded and measured pressure as the models' target."""
    of_models, of_control = (
        {
            name: [read_json(path) for path in paths if Path(path).parent.name == name]
            for name in names
        }
        for paths in (replicates, controls)
    )
    table = robustness.targets(of_models, of_control, read_yaml(published))
    note = (
        "Target of the models: commanded against measured pressure, mean and its 95 % interval "
        "over the further seeds.\n"
        f"Data: {SOURCES[table['source'].iloc[0]]}."
    )
    write_table(table, robustness.targets_page(table), note, **files)


def tabulate_times(
    published: str, times: str, *, left_out: Mapping[str, str], **files: str
) -> None:
    """Table II, execution times."""
    report = read_json(times)
    table = timing.timing(report, read_yaml(published))
    note = (
        f"Table II, execution times: mean ± standard deviation of {table['repeats'].iloc[0]} "
        f"alternating repeats on {report['cpu']}, {report['threads']} thread.\n"
        "Sequential is sample by sample, as in a controller; batch is a whole log at once. "
        "The paper does not say which mode it timed, nor on which machine."
        f"{_without(left_out)}"
    )
    write_table(table, timing.timing_page(table), note, **files)


def tabulate_steps(steps: str, *, left_out: Mapping[str, str], **files: str) -> None:
    """Write the cost of one step of the closed loop, compared with the sampling period."""
    report = read_json(steps)
    table = timing.steps(report)
    note = (
        "Cost of a control step: computing time of feedforward, PD and both pressure loops, "
        f"without a rig; {table['samples'].iloc[0]} steps, each timed on {report['cpu']}.\n"
        "The last column is the 99.9th percentile's share of the sampling period, "
        f"{table['budget_us'].iloc[0] / 1000:g} ms.{_without(left_out)}"
    )
    write_table(table, timing.steps_page(table), note, **files)


def tabulate_unavailable(csv: str, md: str, *, reasons: Mapping[str, tuple[str, str]]) -> None:
    """List the results that cannot be made from the data, with reasons; the list may be empty."""
    rows = [(name, *texts) for name, texts in reasons.items()]
    table = pd.DataFrame(rows, columns=["name", "result", "reason"])
    write_csv(csv, table)
    if rows:
        page = table[["result", "reason"]].rename(columns={"result": "Result", "reason": "Why"})
        write_text(md, markdown(page, "Not available for this data."))
    else:
        write_text(md, "Everything is available for this data.\n")
    for _, title, why in rows:
        log.info("not available: %s: %s", title, why)
