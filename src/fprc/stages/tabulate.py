"""Tables I to III, the execution times, and Tables II to IV over seeds, from result files."""

import shutil
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd

from fprc.artifacts import replacing
from fprc.claims.ledger import Results
from fprc.claims.paper import write_ledger
from fprc.figures import DRAWINGS
from fprc.figures.grids import draw_grids
from fprc.given import read_json, read_yaml
from fprc.paper import ERRORS, MODELS, PRINTED, PUBLISHED, SOURCES
from fprc.registry import title_of
from fprc.tables import tracking
from fprc.tables.text import failed, format_mean, means_of, spread, three_digits, write_table

_PRINT = read_yaml(PUBLISHED)
#: Titles of Tables II and III, by the log that trains.
_TITLES = {
    "sweep": "Table II. RMSE of the models, trained on the sweep, tested on the complex log",
    "complex": "Table III. RMSE with the logs reversed: trained on the complex log, "
    "tested on the sweep",
}
_SETTINGS = {
    ("esn", "r"): "Reservoir size, r",
    ("esn", "f_input"): "Input scaling factor, f_input",
    ("esn", "gamma"): "Leaky rate, gamma",
    ("esn", "rho"): "Spectral radius, rho",
    ("fprc", "epsilon"): "Filter factor, epsilon",
    ("fprc", "n_c"): "Fuzzy clusters, n_c",
    ("fprc", "n_u"): "Reservoir output tap size, n_u",
    ("fprc", "sigma"): "Gaussian membership scaling, sigma",
    ("shared", "n_y"): "Tap size of theta_d, n_y",
    ("shared", "alpha"): "Ridge parameter, alpha",
}
#: Phases of the printed times, with their keys and their unit, s.
_TIMES = {"train": ("Training", "train_time_s", 1.0), "test": ("Test", "test_time_ms", 1e-3)}


def tabulate_settings(
    table1: Sequence[str], *, models: Mapping[str, Any], **drawings: Sequence[str]
) -> None:
    """Table I, the settings of the models; and copy the figures that show no data."""
    rows = [
        {
            "model": title_of(model) if model in MODELS else "All models",
            "parameter": label,
            "value": models[key] if model == "shared" else models[model][key],
            "published": _PRINT["table_1_configuration"][model][key],
        }
        for (model, key), label in _SETTINGS.items()
    ]
    table = pd.DataFrame(rows, dtype=object)
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
    for errors, files in ((sweep, table2), (complex, table3)):
        reports = [read_json(path) for path in errors]
        first = reports[0]
        note = (
            "mean ± standard deviation over "
            f"{len(first['train_rmse_kpa'])} {first['split']} folds, seed {first['seed']}.\n"
            f"Data: {SOURCES[first['source']]}. Target: {first['target']} pressure."
            f"{_without(left_out)}{failed(records)}"
        )
        _write_errors(_comparison(reports), note, files, _TITLES[first["trained_on"]])


def show_seeds(
    grids: Sequence[str],
    times: str,
    times_over_n_c: str,
    models: Sequence[str] = (),
    controls: Sequence[str] = (),
    seeds: Sequence[str] = (),
    fig10: Sequence[str] = (),
    fig11: Sequence[str] = (),
    claims: Sequence[str] = (),
    *,
    feedback: str,
    fitted: Mapping[str, Any],
) -> None:
    """Figs. 10 and 11; of further seeds, which recorded logs have not, tables and the ledger."""
    reports = ([read_json(path) for path in paths] for paths in (models, grids, controls))
    results = Results._make([*reports, read_json(times), read_json(times_over_n_c)])
    draw_grids(results.grids, results.times_over_n_c, fig10, fig11)
    if models:
        tabulate_seeds(results, seeds, feedback)
        write_ledger(results, claims, fitted)


def tabulate_seeds(results: Results, seeds: Sequence[str], feedback: str) -> None:
    """Tables II, III and IV over further seeds; ``feedback`` in words."""
    reports = results.replicates
    two, three, four = np.array_split(seeds, 3)
    over = f"mean and its 95 % interval over {len(reports)} further seeds"
    if len(reports) == 1:
        over = "one further seed"
    about = f"{over}.\nData: {SOURCES[reports[0]['source']]}"
    errors = [entry for report in reports for entry in report["models"]]
    for (trained_on, title), files in zip(_TITLES.items(), (two, three), strict=True):
        table = _comparison([entry for entry in errors if entry["trained_on"] == trained_on])
        last = ["published_mean", "source"]
        table = table.rename(columns={"mean": "value"})
        table = means_of(table, "model", "metric", "unit", *last)
        table = table[[*table.columns.drop(last), *last]]
        note = f"{about}; each seed is another draw of sensors, noise and models."
        _write_errors(table, note, files, title)
    table = tracking.over_seeds(results.controls)
    note, title = f"{about}. {feedback}", f"{tracking.TITLE}, over seeds"
    write_table(table, tracking.page(table), note, *four, title=title)


def _comparison(reports: Sequence[Mapping[str, Any]]) -> pd.DataFrame:
    """Tables II and III, tidy: mean and sample standard deviation over the folds.

    A test error is a single number and has none. The printed numbers are in kPa: beside another
    unit, and beside imported recordings, which are of another rig, there are none.
    """
    rows = []
    for report in reports:
        comparable = report["unit"] == "kPa" and report["source"] != "import"
        models = _PRINT[PRINTED[report["trained_on"]]] if comparable else {}
        for metric in ERRORS:
            mean, std = pd.Series(report[f"{metric}_kpa"]).agg(["mean", "std"])
            printed = np.atleast_1d(models.get(report["model"], {}).get(f"{metric}_kpa", np.nan))
            rows.append(
                {
                    "model": report["model"],
                    "metric": metric,
                    "unit": report["unit"],
                    "mean": mean,
                    "std": std,
                    "published_mean": float(printed[0]),
                    "published_std": float(printed[1]) if printed.size > 1 else None,
                    "source": report["source"],
                }
            )
    return pd.DataFrame(rows)


def _write_errors(table: pd.DataFrame, note: str, files: Iterable[str], title: str) -> None:
    """Write Table II or III as the paper prints it, ours beside the published numbers."""
    page = {f"Performance [{table['unit'].iloc[0]}]": list(ERRORS.values())}
    for model in dict.fromkeys([*MODELS, *table["model"]]):
        name, rows = title_of(model), table[table["model"] == model].to_dict("records")
        ours = [format_mean(row, "mean") for row in rows]
        page[f"{name}, ours"] = ours or ["not available"] * len(ERRORS)
        if rows and rows[0]["source"] != "import":
            page[f"{name}, paper"] = [
                spread(row["published_mean"], row.get("published_std")) or "-" for row in rows
            ]
    write_table(table, pd.DataFrame(page), note, *files, title=title)


def tabulate_times(times: str, timing: Sequence[str], *, left_out: Mapping[str, str]) -> None:
    """Table II, execution times in s and us per sample, both modes."""
    report = read_json(times)
    rows, page = [], []
    for entry in report["times"]:
        mean, std = pd.Series(entry["seconds"]).agg(["mean", "std"])
        phase, key, unit_s = _TIMES[entry["phase"]]
        printed = _PRINT["table_2_models"].get(entry["model"], {}).get(key, (np.nan, np.nan))
        row = {
            "model": entry["model"],
            "metric": f"{entry['phase']}_time",
            "mode": entry["mode"],
            "unit": "s",
            "mean": mean,
            "std": std,
            "us_per_sample": 1e6 * mean / entry["samples"],
            "samples": entry["samples"],
            "repeats": len(entry["seconds"]),
            "published_mean": unit_s * printed[0],
            "published_std": unit_s * printed[1],
            "threads": report["threads"],
            "cpu": report["cpu"],
            "source": report["source"],
        }
        line = {
            "Model": title_of(entry["model"]),
            "Phase": phase,
            "Mode": entry["mode"],
            "Ours [s]": spread(mean, std),
            "Ours [us per sample]": three_digits(row["us_per_sample"]),
        }
        if report["source"] != "import":  # the paper's rig is another
            line["Paper [s]"] = spread(row["published_mean"], row["published_std"]) or "-"
        rows.append(row)
        page.append(line)
    table = pd.DataFrame(rows)
    note = (
        f"mean ± standard deviation of {table['repeats'].max()} alternating repeats, of whole logs "
        f"{table['repeats'].min()}, on {report['cpu']}, {report['threads']} thread.\n"
        "Sequential is sample by sample, as in a controller: the fit of the whole log, and steps, "
        "of which some thousand are timed, in proportion to its samples. Batch is a whole log at "
        "once. The paper does not say which mode it timed, nor on which machine."
        f"{_without(left_out)}"
    )
    title = "Table II, execution times"
    write_table(table, pd.DataFrame(page), note, *timing, title=title)


def _without(left_out: Mapping[str, str]) -> str:
    return "".join(f"\nNo {title_of(model)}: {why}." for model, why in left_out.items())
