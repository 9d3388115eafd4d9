import copy
import json
import re
import statistics
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
import yaml

from fprc import config
from fprc.artifacts import write_json
from fprc.logs import Columns
from fprc.registry import MODELS
from fprc.stages import tabulate
from fprc.tables import timing
from fprc.tables.models import comparison, comparison_page, configuration, over_seeds
from fprc.tables.text import spread, write_table
from fprc.tables.tracking import tracking, tracking_over_seeds, tracking_page

PUBLISHED = yaml.safe_load(config.PUBLISHED.read_text(encoding="utf-8"))


#: The first rows of Table II as the paper prints them.
PRINTED = {
    "ESN": ["11.5 ± 0.0143", "11.5 ± 0.0479", "16.5"],
    "FPRC": ["11.6 ± 0.188", "11.7 ± 0.154", "11.0"],
    "Fuzzy-linear": ["14.9 ± 0.0167", "14.9 ± 0.0587", "16.7"],
}


def report(model, test, train=(10.0, 12.0), validation=(11.0, 14.0), trained_on="sweep"):
    return {
        "model": model, "trained_on": trained_on, "source": "sim", "seed": 1, "target": "command",
        "unit": "kPa", "split": "shuffled", "best_fold": 0, "train_rmse_kpa": list(train),
        "validation_rmse_kpa": list(validation), "test_rmse_kpa": test,
    }  # fmt: skip


REPORTS = [report("esn", 16.0), report("fprc", 12.0), report("fuzzy_linear", 18.0)]


def replicate(seed, **test):
    """Replicate whose reversed test errors are twice the forward ones."""
    models = [
        report(model, factor * error, trained_on=trained_on)
        for trained_on, factor in (("sweep", 1.0), ("complex", 2.0))
        for model, error in test.items()
    ]
    starts = dict.fromkeys(("sweep", "complex"), {"train": [2.0, 2.5], "test": [1.0, 3.0]})
    return {"seed": seed, "source": "sim", "models": models, "fprc_rmse_over_starts": starts}


REPLICATES = [
    replicate(101, esn=16.0, fprc=12.0, fuzzy_linear=18.0),
    replicate(102, esn=14.0, fprc=15.0, fuzzy_linear=19.0),
]


def test_table_2_spread_is_over_the_folds_and_a_test_error_has_none():
    table = comparison(REPORTS, PUBLISHED)
    assert list(table.columns) == [
        "model", "metric", "unit", "mean", "std", "published_mean", "published_std", "source"
    ]  # fmt: skip
    row = by_metric(table, "fprc")
    assert row["mean"].tolist() == [11.0, 12.5, 12.0]
    assert row["std"].tolist()[:2] == pytest.approx([2.0**0.5, 4.5**0.5])
    assert pd.isna(row["std"].iloc[2])


def test_page_of_table_2_shows_ours_beside_the_paper():
    page = comparison_page(comparison(REPORTS, PUBLISHED))
    assert page["FPRC, ours"].tolist() == ["11.0 ± 1.41", "12.5 ± 2.12", "12.0"]
    for name, printed in PRINTED.items():
        assert page[f"{name}, paper"].tolist() == printed
    forces = comparison([content | {"unit": "N"} for content in REPORTS], PUBLISHED)
    page = comparison_page(forces)
    assert page.columns[0] == "Performance [N]"
    assert page["FPRC, paper"].tolist() == ["-"] * 3  # its numbers are in kPa
    imported = comparison([content | {"source": "import"} for content in REPORTS], PUBLISHED)
    assert imported["published_mean"].isna().all()
    assert not any("paper" in column for column in comparison_page(imported))


def test_model_that_is_not_there_has_a_column_that_says_so():
    page = comparison_page(comparison(REPORTS[:1], PUBLISHED))
    assert page["FPRC, ours"].tolist() == ["not available"] * 3
    assert "FPRC, paper" not in page.columns
    assert page["ESN, ours"].str.contains("±").tolist() == [True, True, False]


@pytest.mark.parametrize(
    ("mean", "std", "text"),
    [(11.5, 0.0143, "11.5 ± 0.0143"), (16.0, None, "16.0"), (16.0, np.nan, "16.0"),
     (0.0, 0.0, "0 ± 0"), (8930.0, 1800.0, "8930 ± 1800"), (-2.345, None, "-2.35"),
     (0.000123456, None, "0.000123"), (0.09999, None, "0.100"), (99.96, 0.9996, "100 ± 1.00")],
)  # fmt: skip
def test_spread_has_three_significant_digits(mean, std, text):
    assert spread(mean, std) == text


def test_configuration_has_every_setting_of_table_1_with_the_published_value():
    models = copy.deepcopy(PUBLISHED["table_1_configuration"])
    models["fprc"]["n_c"] = 16
    models |= models.pop("shared")
    table = configuration(models, PUBLISHED)
    assert list(table.columns) == ["model", "parameter", "value", "published"]
    assert len(table) == 10
    differs = table[table["value"] != table["published"]]
    assert differs.to_numpy().tolist() == [["FPRC", "Fuzzy clusters, n_c", 16, 8]]
    expected = {"r": 800, "f_input": 0.02, "gamma": 0.8, "rho": 0.4, "epsilon": 0.01,
                "n_c": 8, "n_u": 3, "sigma": 2.0, "n_y": 5, "alpha": 0.001}  # fmt: skip
    symbols = [label.rsplit(", ")[-1] for label in table["parameter"]]
    assert dict(zip(symbols, table["published"], strict=True)) == expected


def test_table_over_seeds_has_mean_deviation_and_range():
    row = by_metric(over_seeds(REPLICATES, PUBLISHED, "sweep"), "fprc").loc["test_rmse"]
    assert row[["mean", "min", "max", "seeds"]].tolist() == [13.5, 12.0, 15.0, 2]
    assert row["std"] == pytest.approx(np.std([12.0, 15.0], ddof=1))
    assert row[["unit", "published_mean", "source"]].tolist() == ["kPa", 11.0, "sim"]


def test_table_3_carries_its_own_published_numbers():
    reports = [report(model, 30.0, trained_on="complex") for model in MODELS]
    row = by_metric(comparison(reports, PUBLISHED), "esn")
    assert row["published_mean"].tolist() == [10.2, 10.2, 60.32]
    seeds = by_metric(over_seeds(REPLICATES, PUBLISHED, "complex"), "esn")
    assert seeds.loc["test_rmse", ["mean", "published_mean"]].tolist() == [30.0, 60.32]


def tracked(controller, reference, error):
    named = {"controller": controller, "reference": reference}
    attributes = {**named, "source": "sim", "settle_s": 1.0, "rig": {}}
    theta_deg = np.array([30.0, *np.subtract(5.0, error)])  # the first sample is settling
    channels = {"time_s": np.arange(3.0), "theta_d_deg": np.full(3, 5.0), "theta_deg": theta_deg}
    return Columns(Path("run.h5"), channels, attributes)


def test_table_4_has_rms_and_largest_error_beside_the_published_rmse():
    runs = [
        tracked("fprc", "sweep", [3.0, -4.0]),
        tracked("fprc_pd", "complex", [1.0, 1.0]),
        tracked("pd", "sweep", [20.0, 20.0]),
    ]
    table = tracking(runs, PUBLISHED)
    assert table["rmse_deg"].tolist() == pytest.approx([12.5**0.5, 1.0, 20.0])
    assert table["max_abs_error_deg"].tolist() == [4.0, 1.0, 20.0]
    assert table["published_rmse_deg"].tolist()[:2] == [2.67, 0.608]
    assert pd.isna(table["published_rmse_deg"].iloc[2])
    assert tracking_page(table).to_numpy().tolist() == [
        ["FPRC", "ours", "3.54", ""],
        ["FPRC", "paper", "2.67", ""],
        ["FPRC+PD", "ours", "", "1.00"],
        ["FPRC+PD", "paper", "", "0.608"],
        ["PD", "ours", "20.0", ""],
    ]


#: Errors of each run over three seeds, deg.
ERRORS_DEG = {
    "sweep/fprc": [3.0, 4.0, 5.0],
    "sweep/fprc_pd": [1.5, 1.25, 1.75],
    "sweep/pd": [33.0, 32.0, 31.0],
    "disturbance/fprc_pd": [1.0, 1.0, 1.0],
}


def controls(seeds=3):
    return [
        {
            "seed": 101 + k,
            "source": "sim",
            "rmse_deg": {run: errors[k] for run, errors in ERRORS_DEG.items()},
            "fprc_rmse_over_starts": {"sweep/fprc": [1.0, 3.0], "sweep/fprc_pd": [2.0, 2.0]},
        }
        for k in range(seeds)
    ]


def test_table_4_over_seeds_has_mean_deviation_and_range_of_every_run():
    table = tracking_over_seeds(controls(), PUBLISHED)
    assert len(table) == len(ERRORS_DEG)
    for row in table.to_dict("records"):
        errors = ERRORS_DEG[f"{row['reference']}/{row['controller']}"]
        assert row["rmse_deg"] == pytest.approx(sum(errors) / 3)
        assert row["std"] == pytest.approx(statistics.stdev(errors))
        assert (row["min"], row["max"], row["seeds"]) == (min(errors), max(errors), 3)
        assert row["source"] == "sim"


def test_page_of_table_4_over_seeds_shows_intervals():
    """Means of three: the interval is 4.3027 / sqrt(3) deviations to each side."""
    page = tracking_page(tracking_over_seeds(controls(), PUBLISHED))
    assert page.iloc[:, [0, 1, 2]].to_numpy().tolist()[:2] == [
        ["FPRC", "ours", "4.00 (1.52 to 6.48)"],
        ["FPRC", "paper", "2.67"],
    ]
    assert page.iloc[:, 3].tolist()[1:3] == ["", "1.00 (1.00 to 1.00)"]


def times():
    entries = [
        {"model": model, "phase": phase, "mode": mode, "samples": 1000, "seconds": [1.0, 3.0]}
        for model in ("esn", "fprc", "fuzzy_linear")
        for phase in ("train", "test")
        for mode in ("sequential", "batch")
    ]
    return {"source": "sim", "cpu": "A & B_1 100 %", "threads": 1, "times": entries}


def test_times_are_seconds_and_microseconds_per_sample_beside_the_published_ones():
    table = timing.timing(times(), PUBLISHED)
    assert len(table) == 12
    row = table[(table["model"] == "esn") & (table["metric"] == "test_time")].iloc[0]
    expected = pytest.approx([2.0, 2.0**0.5, 2000.0, 2])
    assert row[["mean", "std", "us_per_sample", "repeats"]].tolist() == expected
    assert row[["published_mean", "published_std"]].tolist() == [8.93, 1.8]
    row = table[(table["model"] == "esn") & (table["metric"] == "train_time")].iloc[0]
    assert row[["published_mean", "published_std"]].tolist() == [16.6, 3.28]
    assert set(table["source"]) == {"sim"}
    assert set(table["threads"]) == {1}
    assert timing.timing_page(table).iloc[0].tolist() == [
        "ESN", "Training", "sequential", "2.00 ± 1.41", "2000", "16.6 ± 3.28"
    ]  # fmt: skip


@pytest.fixture
def tabulated(tmp_path):
    """Return what makes the tables of reports, and gives their texts in Markdown."""

    def make(stage, count, *results, **settings):
        paths = [[str(tmp_path / f"{k}{n}.json") for n, _ in enumerate(result)]
                 for k, result in enumerate(results)]  # fmt: skip
        for path, result in zip(sum(paths, []), sum(map(list, results), []), strict=True):
            write_json(path, result)
        files = [str(tmp_path / f"{k}.{kind}") for k in range(count) for kind in ("csv", "md")]
        tables = [files] if stage is tabulate.tabulate_seeds else [files[:2], files[2:]]
        stage(str(config.PUBLISHED), *paths, *tables, **settings)
        for file in files:
            text = Path(file).read_text(encoding="utf-8")
            assert not {"nan", "none"} & set(re.findall(r"\w+", text.lower())), file
        return [Path(file).read_text(encoding="utf-8") for file in files[1::2]]

    return make


def test_tables_name_their_data_and_say_neither_nan_nor_none(tabulated):
    reversed_logs = [report("esn", 16.0, trained_on="complex")]
    pages = tabulated(tabulate.tabulate_models, 2, REPORTS, reversed_logs, [], left_out={})
    # one seed has no deviation
    pages += tabulated(tabulate.tabulate_seeds, 3, REPLICATES[:1], controls(1), feedback="So.")
    assert ["simulated rig, not hardware" in page for page in pages] == [True] * 5


def test_failed_checks_of_the_logs_stand_below_the_table(tabulated):
    cut = {"passed": False, "finding": "the computer went off"}
    whole = {"log": "monday.h5", "checks": {"complete": cut | {"passed": True}}}
    half = {"log": "tuesday.h5", "checks": {"complete": cut}}
    joined = {"recordings": [whole, half]}
    text, _ = tabulated(
        tabulate.tabulate_models, 2, REPORTS[:1], REPORTS[:1], [whole, joined], left_out={}
    )
    assert "tuesday.h5: complete: the computer went off" in text
    assert "monday.h5" not in text


def test_table_4_has_the_spread_over_starts_of_the_clustering(tabulated):
    *_, text = tabulated(tabulate.tabulate_seeds, 3, REPLICATES[:1], controls(1), feedback="")
    # standard deviation and mean of 1 and 3 deg, and of 2 and 2 deg
    assert re.findall(r"among (\d+) starts.* by ([\d.]+) %.* by ([\d.]+) %.* is ([\d.]+) times",
                      text) == [("2", "70.7", "0.0", "3.00")]  # fmt: skip


def test_page_has_title_and_note_in_every_form(tmp_path):
    page = pd.DataFrame({"Error of P_o [%]": ["FPRC & more", "n_c"], "Ours": ["1.0 ± 0.1", "2"]})
    files = [str(tmp_path / f"table.{kind}") for kind in ("csv", "md", "tex", "json")]
    write_table(page, page, "so.\nData: none.", *files, title="Table II. 5 % of theta_d")
    _, md, tex, kept = (Path(file).read_text(encoding="utf-8") for file in files)
    assert md.startswith("Table II. 5 % of theta_d: so.\nData: none.\n\n| Error of P_o [%]")
    assert json.loads(kept) == {
        "title": "Table II. 5 % of theta_d", "note": "so.\nData: none.",
        "columns": list(page.columns), "data": page.to_numpy().tolist(),
    }  # fmt: skip
    rows = [line for line in tex.splitlines() if line.endswith(r"\\")]
    assert rows == [
        r"Error of $P_\mathrm{o}$ [\%] & Ours \\",
        r"FPRC \& more & 1.0 ± 0.1 \\",
        r"$n_\mathrm{c}$ & 2 \\",
    ]
    assert r"\caption{5 \% of $\theta_\mathrm{d}$}" in tex
    assert r"\label{tab:table}" in tex
    assert [tex.count(rule) for rule in ("toprule", "midrule", "bottomrule")] == [1, 1, 1]


def by_metric(table, model):
    return table[table["model"] == model].set_index("metric")
