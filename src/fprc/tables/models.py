"""Tables I to III: settings, errors and execution times of the models."""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import pandas as pd

from fprc.intervals import half_interval, mean_and_std
from fprc.paper import ERRORS, MODELS, PRINTED
from fprc.registry import title_of
from fprc.tables.text import format_mean, spread, three_digits

#: Titles of Tables II and III, by the log that trains.
TITLES = {
    "sweep": "Table II. RMSE of the models, trained on the sweep, tested on the complex log",
    "complex": "Table III. RMSE with the logs reversed: trained on the complex log, "
    "tested on the sweep",
}
_SYMBOLS = {
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


def configuration(models: Mapping[str, Any], published: Mapping[str, Any]) -> pd.DataFrame:
    """Table I: our settings beside those that the paper prints."""
    printed = published["table_1_configuration"]
    rows = []
    for (model, key), label in _SYMBOLS.items():
        ours = models[key] if model == "shared" else models[model][key]
        shown = title_of(model) if model in MODELS else "All models"
        rows.append((shown, label, ours, printed[model][key]))
    return pd.DataFrame(rows, columns=["model", "parameter", "value", "published"], dtype=object)


def comparison(reports: Sequence[Mapping[str, Any]], published: Mapping[str, Any]) -> pd.DataFrame:
    """Tables II and III without times: mean and spread over the folds, tidy.

    ``std`` is the sample standard deviation over folds; a test error is a single
    number and has none. The printed numbers are in kPa: beside another unit there are none.
    """
    rows = []
    for report in reports:
        comparable = report["unit"] == "kPa" and report["source"] != "import"
        models = published[PRINTED[report["trained_on"]]] if comparable else {}
        for metric in ERRORS:
            mean, std = mean_and_std(report[f"{metric}_kpa"])
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


def over_seeds(
    replicates: Sequence[Mapping[str, Any]], published: Mapping[str, Any], trained_on: str
) -> pd.DataFrame:
    """Tables II and III over further seeds: mean, standard deviation, range, tidy."""
    reports = [report for replicate in replicates for report in replicate["models"]]
    errors = comparison([r for r in reports if r["trained_on"] == trained_on], published)
    last = ["published_mean", "source"]
    table = means_of(errors.rename(columns={"mean": "value"}), "model", "metric", "unit", *last)
    return table[[*table.columns.drop(last), *last]]


def means_of(samples: pd.DataFrame, *keys: str, count: str = "seeds") -> pd.DataFrame:
    """Return the mean of ``value`` for each value of the keys, tidy.

    Columns: the keys, ``mean``, ``std``, ``min``, ``max``, the number of samples by the name
    ``count``, and the mean's 95 % interval by Student's t, ``low`` and ``high``.
    """
    groups = samples.groupby(list(keys), sort=False, dropna=False)["value"]
    table = groups.agg(["mean", "std", "min", "max", "count"]).reset_index()
    half = half_interval(table["std"], table["count"])
    table = table.assign(low=table["mean"] - half, high=table["mean"] + half)
    return table.rename(columns={"count": count})


def comparison_page(table: pd.DataFrame) -> pd.DataFrame:
    """Table II as the paper prints it, ours beside the published numbers.

    Beside imported recordings there are none: they are of another rig.
    """
    page = {f"Performance [{table['unit'].iloc[0]}]": list(ERRORS.values())}
    for model in dict.fromkeys([*MODELS, *table["model"]]):
        name, rows = title_of(model), table[table["model"] == model].to_dict("records")
        ours = [format_mean(row, "mean") for row in rows]
        page[f"{name}, ours"] = ours or ["not available"] * len(ERRORS)
        if rows and not (table["source"] == "import").all():
            page[f"{name}, paper"] = [
                spread(row["published_mean"], row.get("published_std")) or "-" for row in rows
            ]
    return pd.DataFrame(page)


#: Keys of the printed times, by phase, and their unit, s.
_PRINTED_TIMES = {"train": ("train_time_s", 1.0), "test": ("test_time_ms", 1e-3)}


def timing(report: Mapping[str, Any], published: Mapping[str, Any]) -> pd.DataFrame:
    """Table II, execution times in s and us per sample, both modes, tidy."""
    rows = []
    for entry in report["times"]:
        mean, std = mean_and_std(entry["seconds"])
        key, unit_s = _PRINTED_TIMES[entry["phase"]]
        printed = published["table_2_models"].get(entry["model"], {}).get(key, (np.nan, np.nan))
        rows.append(
            {
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
        )
    return pd.DataFrame(rows)


def timing_page(table: pd.DataFrame) -> pd.DataFrame:
    """Return the times as a page; beside imported recordings the paper's say nothing."""
    phases = {"train_time": "Training", "test_time": "Test"}
    page = pd.DataFrame(
        {
            "Model": title_of(row.model),
            "Phase": phases[row.metric],
            "Mode": row.mode,
            "Ours [s]": spread(row.mean, row.std),
            "Ours [us per sample]": three_digits(row.us_per_sample),
            "Paper [s]": spread(row.published_mean, row.published_std) or "-",
        }
        for row in table.itertuples()
    )
    return page.drop(columns="Paper [s]") if (table["source"] == "import").all() else page
