"""The paper's tables: result files in, tidy frames and pages out."""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import pandas as pd

#: Printed name of each model, in the paper's order.
MODEL_NAMES = {"esn": "ESN", "fprc": "FPRC", "fuzzy_linear": "Fuzzy-linear"}

#: What a log's ``source`` means to a reader.
SOURCES = {
    "sim": "simulated rig, not hardware",
    "rig": "recorded on the rig",
    "import": "imported recordings",
}

_ERRORS = {"train_rmse": "Training RMSE", "validation_rmse": "Validation RMSE",
           "test_rmse": "Test RMSE"}  # fmt: skip

CONTROLLER_NAMES = {"fprc": "FPRC", "fprc_pd": "FPRC+PD", "pd": "PD"}

REFERENCE_NAMES = {
    "sine_0p2": "Sine 0.2 Hz",
    "sine_0p5": "Sine 0.5 Hz",
    "sweep": "Sweep",
    "complex": "Complex",
    "disturbance": "Sine 0.3 Hz, disturbed",
}

#: Where ``config/published.yaml`` has the errors, by the log that trained.
PRINTED = {"sweep": "table_2_models", "complex": "table_3_reversed"}

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
    """Table I: the settings that the paper prints, ours beside them."""
    printed = published["table_1_configuration"]
    rows = []
    for (model, key), label in _SYMBOLS.items():
        ours = models[key] if model == "shared" else models[model][key]
        shown = MODEL_NAMES.get(model, "All models")
        rows.append((shown, label, ours, printed[model][key]))
    return pd.DataFrame(rows, columns=["model", "parameter", "value", "published"], dtype=object)


def comparison(reports: Sequence[Mapping[str, Any]], published: Mapping[str, Any]) -> pd.DataFrame:
    """Tables II and III without times: mean and spread over the folds, tidy.

    ``std`` is the sample standard deviation over folds; a test error is one
    number and has none.
    """
    rows = []
    for report in reports:
        printed = published[PRINTED[report["trained_on"]]][report["model"]]
        for metric in _ERRORS:
            ours = np.atleast_1d(report[f"{metric}_kpa"])
            theirs = np.atleast_1d(printed[f"{metric}_kpa"])
            rows.append(
                {
                    "model": report["model"],
                    "metric": metric,
                    "unit": "kPa",
                    "mean": ours.mean(),
                    "std": ours.std(ddof=1) if ours.size > 1 else None,
                    "published_mean": float(theirs[0]),
                    "published_std": float(theirs[1]) if theirs.size > 1 else None,
                    "source": report["source"],
                }
            )
    return pd.DataFrame(rows)


def over_seeds(
    replicates: Sequence[Mapping[str, Any]], published: Mapping[str, Any], trained_on: str
) -> pd.DataFrame:
    """Tables II and III over further seeds: mean, standard deviation, range, tidy."""
    samples = pd.DataFrame(
        {
            "model": report["model"],
            "metric": metric,
            "value": np.mean(report[f"{metric}_kpa"]),
            "source": replicate["source"],
        }
        for replicate in replicates
        for report in replicate["models"]
        if report["trained_on"] == trained_on
        for metric in _ERRORS
    )
    groups = samples.groupby(["model", "metric"], sort=False)
    table = groups["value"].agg(["mean", "std", "min", "max", "count"]).reset_index()
    table = table.rename(columns={"count": "seeds"})
    table.insert(2, "unit", "kPa")
    printed = published[PRINTED[trained_on]]
    table["published_mean"] = [
        float(np.atleast_1d(printed[row.model][f"{row.metric}_kpa"])[0])
        for row in table.itertuples()
    ]
    table["source"] = groups["source"].first().to_numpy()
    return table


def orders(replicates: Sequence[Mapping[str, Any]]) -> pd.DataFrame:
    """Whether the orders of Tables II and III hold, seed by seed."""
    rows = []
    for replicate in replicates:
        error = {
            (report["trained_on"], report["model"], metric): float(np.mean(report[f"{metric}_kpa"]))
            for report in replicate["models"]
            for metric in _ERRORS
        }
        ratio = error["sweep", "esn", "train_rmse"] / error["sweep", "fprc", "train_rmse"]
        tests = {key[:2]: value for key, value in error.items() if key[2] == "test_rmse"}
        rows.append(
            {
                "seed": replicate["seed"],
                "fprc_lowest_test": _lowest(tests, "sweep") == "fprc",
                "fprc_below_fuzzy_linear": all(
                    error["sweep", "fprc", metric] < error["sweep", "fuzzy_linear", metric]
                    for metric in _ERRORS
                ),
                "esn_over_fprc_training": ratio,
                "training_within_30_percent": max(ratio, 1.0 / ratio) <= 1.3,
                "fprc_lowest_reversed_test": _lowest(tests, "complex") == "fprc",
                "reversed_tests_worse": all(
                    tests["complex", model] > tests["sweep", model] for model in MODEL_NAMES
                ),
                "source": replicate["source"],
            }
        )
    return pd.DataFrame(rows)


def _lowest(tests: Mapping[tuple[str, str], float], trained_on: str) -> str:
    return min(MODEL_NAMES, key=lambda model: tests[trained_on, model])


def tracking(
    runs: Sequence[Mapping[str, Any]], gains: Mapping[str, Any], published: Mapping[str, Any]
) -> pd.DataFrame:
    """Table IV: errors of every controller on every reference, tidy.

    Parameters
    ----------
    runs : sequence of mapping
        ``controller``, ``gain`` (none, printed, identified), ``reference``,
        ``error_deg`` (theta_d - theta of the judged samples) and ``source``.
    gains : mapping
        Gains of the PD controller by their name.
    """
    printed = published["table_4_tracking_rmse_deg"]
    rows = []
    for run in runs:
        error = np.asarray(run["error_deg"])
        rows.append(
            {
                "controller": run["controller"],
                "gain": run["gain"],
                "reference": run["reference"],
                "rmse_deg": np.sqrt(np.mean(error**2)),
                "max_abs_error_deg": np.abs(error).max(),
                "published_rmse_deg": printed.get(run["controller"], {}).get(run["reference"]),
                "kp_kpa_per_deg": gains.get(run["gain"], {}).get("kp_kpa_per_deg"),
                "source": run["source"],
            }
        )
    return pd.DataFrame(rows)


def tracking_over_seeds(
    replicates: Sequence[Mapping[str, Any]], published: Mapping[str, Any]
) -> pd.DataFrame:
    """Table IV over further seeds: mean, standard deviation, range, tidy.

    The gain is identified anew on each seed; its mean is given.
    """
    printed = published["table_4_tracking_rmse_deg"]
    samples = pd.DataFrame(
        {
            **dict(zip(("reference", "controller", "gain"), run.split("/"), strict=True)),
            "rmse_deg": error,
            "kp_kpa_per_deg": report["gains"].get(run.split("/")[2], {}).get("kp_kpa_per_deg"),
            "source": report["source"],
        }
        for report in replicates
        for run, error in report["rmse_deg"].items()
    )
    groups = samples.groupby(["controller", "gain", "reference"], sort=False)
    table = groups["rmse_deg"].agg(["mean", "std", "min", "max", "count"]).reset_index()
    table = table.rename(columns={"mean": "rmse_deg", "count": "seeds"})
    table["published_rmse_deg"] = [
        printed.get(row.controller, {}).get(row.reference) for row in table.itertuples()
    ]
    table["kp_kpa_per_deg"] = groups["kp_kpa_per_deg"].mean().to_numpy()
    table["source"] = groups["source"].first().to_numpy()
    return table


def tracking_page(table: pd.DataFrame) -> pd.DataFrame:
    """Return Table IV as the paper prints it, ours beside the published numbers."""
    page = []
    for (controller, gain), rows in table.groupby(["controller", "gain"], sort=False):
        kp = rows["kp_kpa_per_deg"].iloc[0]
        label = CONTROLLER_NAMES[controller]
        line = {
            "RMSE [deg]": label if pd.isna(kp) else f"{label}, {gain} gain ({kp:g} kPa/deg)",
            "Whose": "ours",
        }
        theirs = {"RMSE [deg]": label, "Whose": "paper"}
        for row in rows.itertuples():
            line[REFERENCE_NAMES[row.reference]] = spread(row.rmse_deg, getattr(row, "std", None))
            theirs[REFERENCE_NAMES[row.reference]] = spread(row.published_rmse_deg, None)
        page.append(line)
        if rows["published_rmse_deg"].notna().any() and gain != "printed":
            page.append(theirs)
    return pd.DataFrame(page)


def timing(report: Mapping[str, Any], published: Mapping[str, Any]) -> pd.DataFrame:
    """Table II, its times: seconds and us per sample, both modes, tidy."""
    rows = []
    for entry in report["times"]:
        seconds = np.array(entry["seconds"])
        printed = published["table_2_models"][entry["model"]]
        theirs = (
            printed["train_time_s"]
            if entry["phase"] == "train"
            else [value / 1000.0 for value in printed["test_time_ms"]]
        )
        rows.append(
            {
                "model": entry["model"],
                "metric": f"{entry['phase']}_time",
                "mode": entry["mode"],
                "unit": "s",
                "mean": seconds.mean(),
                "std": seconds.std(ddof=1) if seconds.size > 1 else None,
                "us_per_sample": 1e6 * seconds.mean() / entry["samples"],
                "samples": entry["samples"],
                "repeats": seconds.size,
                "published_mean": theirs[0],
                "published_std": theirs[1],
                "threads": report["threads"],
                "cpu": report["cpu"],
                "source": report["source"],
            }
        )
    return pd.DataFrame(rows)


def steps(report: Mapping[str, Any]) -> pd.DataFrame:
    """Cost of one control step of each model against the sampling period, tidy."""
    table = pd.DataFrame(report["steps"])
    table["share_of_budget"] = table["p99_9_us"] / table["budget_us"]
    return table.assign(threads=report["threads"], cpu=report["cpu"], source=report["source"])


def steps_page(table: pd.DataFrame) -> pd.DataFrame:
    """Return the cost of a control step as a person reads it."""
    rows = [
        (
            MODEL_NAMES[row.model],
            _three_digits(row.median_us),
            _three_digits(row.p99_9_us),
            f"{100 * row.share_of_budget:.2g} %",
        )
        for row in table.itertuples()
    ]
    columns = ["Model", "Median [us]", "99.9 % of steps below [us]", "Share of the period"]
    return pd.DataFrame(rows, columns=columns)


def comparison_page(table: pd.DataFrame) -> pd.DataFrame:
    """Table II as the paper prints it, ours beside the published numbers."""
    page = {"Performance [kPa]": list(_ERRORS.values())}
    for model, name in MODEL_NAMES.items():
        ours = table[table["model"] == model].set_index("metric")
        page[f"{name}, ours"] = [
            spread(ours.loc[metric, "mean"], ours.loc[metric, "std"]) for metric in _ERRORS
        ]
        page[f"{name}, paper"] = [
            spread(ours.loc[metric, "published_mean"], ours.loc[metric].get("published_std"))
            for metric in _ERRORS
        ]
    return pd.DataFrame(page)


def timing_page(table: pd.DataFrame) -> pd.DataFrame:
    """Return the times as a person reads them."""
    phases = {"train_time": "Training", "test_time": "Test"}
    rows = [
        (
            MODEL_NAMES[row.model],
            phases[row.metric],
            row.mode,
            spread(row.mean, row.std),
            _three_digits(row.us_per_sample),
            spread(row.published_mean, row.published_std),
        )
        for row in table.itertuples()
    ]
    columns = ["Model", "Phase", "Mode", "Ours [s]", "Ours [us per sample]", "Paper [s]"]
    return pd.DataFrame(rows, columns=columns)


def spread(mean: float, std: float | None) -> str:
    """Format a number to three significant digits, with its spread if any."""
    text = _three_digits(mean)
    return text if pd.isna(std) else f"{text} ± {_three_digits(std)}"


def markdown(page: pd.DataFrame, note: str) -> str:
    """Render a page as a Markdown table under a note."""
    return f"{note}\n\n{page.to_markdown(index=False, disable_numparse=True)}\n"


def read_markdown(text: str) -> tuple[str, pd.DataFrame]:
    """Return note and page of what ``markdown`` rendered; every cell is text."""
    note, _, grid = text.partition("\n\n")
    columns, _, *rows = [
        [cell.strip() for cell in line.strip().removeprefix("|").removesuffix("|").split("|")]
        for line in grid.strip().splitlines()
    ]
    return " ".join(note.split()), pd.DataFrame(rows, columns=columns)


def latex(page: pd.DataFrame, note: str) -> str:
    """Render a page as a LaTeX table (booktabs), the note as its caption."""
    body = page.map(_escaped)
    body.columns = [_escaped(name) for name in page.columns]
    caption = _escaped(" ".join(note.split()))
    return body.to_latex(index=False, escape=False, caption=caption)


def _escaped(text: object) -> str:
    escaped = str(text)
    for bare in "_%&":
        escaped = escaped.replace(bare, f"\\{bare}")
    return escaped.replace("±", "$\\pm$")


def _three_digits(value: float) -> str:
    if isinstance(value, str) or pd.isna(value):
        return ""
    exponent = int(f"{value:.2e}".split("e")[1])  # of the rounded number: 9.999 is 10.0
    decimals = max(2 - exponent, 0) if value else 0
    return f"{value:.{decimals}f}"
