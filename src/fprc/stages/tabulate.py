"""Write the paper's tables, each as ``write_table`` does, and the ledger of its claims."""

import logging
import shutil
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import pandas as pd

from fprc.artifacts import replacing, write_csv, write_json
from fprc.claims import MEMBERS, TEXTS
from fprc.claims.claim import Results
from fprc.claims.ledger import fit_in_words, judge_claims
from fprc.figures import DRAWINGS
from fprc.given import read_json, read_yaml
from fprc.logs.quality import warnings
from fprc.paper import PUBLISHED, SOURCES
from fprc.registry import title_of
from fprc.tables import models as tables
from fprc.tables import tracking
from fprc.tables.text import failed, write_table

log = logging.getLogger(__name__)


def tabulate_settings(
    table1: Sequence[str], *, models: Mapping[str, Any], **drawings: Sequence[str]
) -> None:
    """Table I, the settings of the models; and copy the figures that show no data."""
    table = tables.configuration(models, read_yaml(PUBLISHED))
    title, note = "Table I. Configuration of the models", "ours and as published."
    write_table(table, table.astype(str), note, *table1, title=title)
    for file in (file for files in drawings.values() for file in files):
        with replacing(file) as temporary:
            shutil.copyfile(DRAWINGS / Path(file).name, temporary)


def tabulate_models(
    sweep: Sequence[str],
    complex: Sequence[str],
    quality: Sequence[str],
    table2: Sequence[str],
    table3: Sequence[str],
    *,
    left_out: Mapping[str, str],
) -> None:
    """Tables II and III: errors of the models, one seed, spread over folds.

    Below them stand the failed checks of the logs' ``quality`` records, and the models that are
    ``left_out``, with reasons.
    """
    records = [record for path in quality for record in read_json(path)["recordings"]]
    checks = failed([line for record in records for line in warnings(record)])
    for errors, files in ((sweep, table2), (complex, table3)):
        reports = [read_json(path) for path in errors]
        table = tables.comparison(reports, read_yaml(PUBLISHED))
        first = reports[0]
        note = (
            "mean ± standard deviation over "
            f"{len(first['train_rmse_kpa'])} {first['split']} folds, seed {first['seed']}.\n"
            f"Data: {SOURCES[first['source']]}. Target: {first['target']} pressure."
            f"{_without(left_out)}{checks}"
        )
        title = tables.TITLES[first["trained_on"]]
        write_table(table, tables.comparison_page(table), note, *files, title=title)


def _without(left_out: Mapping[str, str]) -> str:
    return "".join(f"\nNo {title_of(model)}: {why}." for model, why in left_out.items())


def tabulate_seeds(
    models: Sequence[str], loops: Sequence[str], seeds: Sequence[str], *, feedback: str
) -> None:
    """Tables II, III and IV over further seeds, from their reports; ``feedback`` in words."""
    printed, each = read_yaml(PUBLISHED), len(seeds) // 3
    reports, tracked = ([read_json(path) for path in paths] for paths in (models, loops))
    about = (
        f"mean and its 95 % interval over {len(reports)} further seeds.\n"
        f"Data: {SOURCES[reports[0]['source']]}"
    )
    for k, (trained_on, title) in enumerate(tables.TITLES.items()):
        table = tables.over_seeds(reports, printed, trained_on)
        note = f"{about}; each seed is another draw of sensors, noise and models."
        files = seeds[k * each :][:each]
        write_table(table, tables.comparison_page(table), note, *files, title=title)
    table = tracking.tracking_over_seeds(tracked, printed)
    note, title = f"{about}. {feedback}", f"{tracking.TITLE}, over seeds"
    write_table(table, tracking.tracking_page(table), note, *seeds[-each:], title=title)


def tabulate_times(times: str, timing: Sequence[str], *, left_out: Mapping[str, str]) -> None:
    """Table II, execution times."""
    report = read_json(times)
    table = tables.timing(report, read_yaml(PUBLISHED))
    note = (
        f"mean ± standard deviation of {table['repeats'].max()} alternating repeats, of whole logs "
        f"{table['repeats'].min()}, on {report['cpu']}, {report['threads']} thread.\n"
        "Sequential is sample by sample, as in a controller: the fit of the whole log, and steps, "
        "of which some thousand are timed, in proportion to its samples. Batch is a whole log at "
        "once. The paper does not say which mode it timed, nor on which machine."
        f"{_without(left_out)}"
    )
    page = tables.timing_page(table)
    write_table(table, page, note, *timing, title="Table II, execution times")


def write_ledger(
    replicates: Sequence[str],
    grids: Sequence[str],
    controls: Sequence[str],
    times: str,
    times_over_n_c: str,
    claims: Sequence[str],
    *,
    fitted: Mapping[str, Any],
) -> None:
    """Write the claims ledger: the paper's numbers, ours, test and verdict, as JSON and as CSV.

    ``fitted`` has the name of the rig, and what ``judge_claims`` asks for.
    """
    of_seeds = ([read_json(path) for path in paths] for paths in (replicates, grids, controls))
    results = Results._make([*of_seeds, read_json(times), read_json(times_over_n_c)])
    ledger = judge_claims(results, read_yaml(PUBLISHED), fitted, members=read_json(MEMBERS))
    origin = (
        f"The rig {fitted['name']} was fitted to {fit_in_words(fitted)}; the other claims were not "
        "part of the fit. A verdict is undecided where the 95 % interval of the mean over noise "
        "seeds of this rig contains a limit. Rigs: on how many rigs that fit Tables II and III too "
        "the claim holds with one seed, and the middle 95 % of their numbers; what holds on all of "
        "them and no fit decides is not informative."
    )
    about = {"source": results.controls[0]["source"], "note": origin}
    untested = read_yaml(TEXTS)["not_tested"]
    write_json(claims[0], about | {"claims": ledger, "not_tested": untested})
    write_csv(claims[1], pd.DataFrame(ledger).drop(columns=["statements", "shown_in"]))
    for row in ledger:
        log.info("%s: %s", row["id"], row["verdict"])
