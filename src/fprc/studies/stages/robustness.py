"""Write the tables of what the results depend on: rigs, parameters, the models' target.

``files`` are named csv, md and tex.
"""

from collections.abc import Sequence
from pathlib import Path

import pandas as pd

from fprc.artifacts import read_json
from fprc.paper import SOURCES
from fprc.studies.families import robustness
from fprc.tables.text import write_table
from fprc.yaml_file import read_yaml


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
