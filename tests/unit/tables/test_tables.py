import json
import re
import statistics
from pathlib import Path

import h5py
import numpy as np
import pandas as pd
import pytest
import yaml

from fprc import config
from fprc.artifacts import write_json
from fprc.claims.ledger import Results
from fprc.errors import LogError
from fprc.given import read_json
from fprc.stages import tabulate
from fprc.stages.draw import draw_loops
from fprc.tables.text import spread, write_table

PUBLISHED = yaml.safe_load(config.PUBLISHED.read_text(encoding="utf-8"))
#: The first rows of Table II as the paper prints them.
PRINTED = {
    "ESN": ["11.5 ± 0.0143", "11.5 ± 0.0479", "16.5"],
    "FPRC": ["11.6 ± 0.188", "11.7 ± 0.154", "11.0"],
    "Fuzzy-linear": ["14.9 ± 0.0167", "14.9 ± 0.0587", "16.7"],
}


def report(model, test, trained_on="sweep"):
    return {
        "model": model, "trained_on": trained_on, "source": "sim", "seed": 1, "target": "command",
        "unit": "kPa", "split": "shuffled", "train_rmse_kpa": [10.0, 12.0],
        "validation_rmse_kpa": [11.0, 14.0], "test_rmse_kpa": test,
    }  # fmt: skip


REPORTS = [report("esn", 16.0), report("fprc", 12.0), report("fuzzy_linear", 18.0)]


def replicate(seed, **test):
    """Replicate whose reversed test errors are twice the forward ones."""
    models = [
        report(model, factor * error, trained_on=trained_on)
        for trained_on, factor in (("sweep", 1.0), ("complex", 2.0))
        for model, error in test.items()
    ]
    return {"seed": seed, "source": "sim", "models": models}


REPLICATES = [
    replicate(101, esn=16.0, fprc=12.0, fuzzy_linear=18.0),
    replicate(102, esn=14.0, fprc=15.0, fuzzy_linear=19.0),
]


class Tables:
    """Writes reports, and reads the tables that a stage makes of them."""

    def __init__(self, folder):
        self.folder, self.count = folder, 0

    def files(self, *kinds):
        self.count += 1
        return [str(self.folder / f"{self.count}.{kind}") for kind in kinds or ("json",)]

    def stored(self, *contents):
        paths = [self.files()[0] for _ in contents]
        for path, content in zip(paths, contents, strict=True):
            write_json(path, content)
        return paths

    def made(self, stage, *arguments, tables=1, **more):
        """Return numbers and page of each table, and the text of its notes."""
        files = [self.files("csv", "md", "tex", "json") for _ in range(tables)]
        stage(*arguments, *([sum(files, [])] if "seeds" in stage.__name__ else files), **more)
        pages = [read_json(kept) for *_, kept in files]
        return [
            (pd.read_csv(csv), pd.DataFrame(page["data"], columns=page["columns"]), page["note"])
            for (csv, *_), page in zip(files, pages, strict=True)
        ]

    def of_models(self, *reports, quality=()):
        forward, backward = self.stored(*reports), self.stored(report("esn", 16.0, "complex"))
        checked = self.stored(*quality)
        made = tabulate.tabulate_models, forward, backward, checked
        return self.made(*made, tables=2, left_out={})

    def over_seeds(self, replicates, controls):
        results = Results(replicates, [], controls, {}, {})
        return self.made(tabulate.tabulate_seeds, results, tables=3, feedback="So.")


@pytest.fixture
def tables(tmp_path):
    return Tables(tmp_path)


def by_metric(table, model):
    return table[table["model"] == model].set_index("metric")


def test_table_2_spread_is_over_the_folds_and_stands_beside_print(tables):
    (table, page, _), _ = tables.of_models(*REPORTS)
    row = by_metric(table, "fprc")
    assert row["mean"].tolist() == [11.0, 12.5, 12.0]
    assert row["std"].tolist() == pytest.approx([2.0**0.5, 4.5**0.5, np.nan], 1e-5, nan_ok=True)
    assert page["FPRC, ours"].tolist() == ["11.0 ± 1.41", "12.5 ± 2.12", "12.0"]
    for name, printed in PRINTED.items():
        assert page[f"{name}, paper"].tolist() == printed
    (_, forces, _), _ = tables.of_models(*(row | {"unit": "N"} for row in REPORTS))
    assert forces.columns[0] == "Performance [N]"
    assert forces["FPRC, paper"].tolist() == ["-"] * 3  # its numbers are in kPa
    (table, imported, _), _ = tables.of_models(*(row | {"source": "import"} for row in REPORTS))
    assert table["published_mean"].isna().all()
    assert not any("paper" in column for column in imported)
    (_, alone, _), _ = tables.of_models(*REPORTS[:1])
    assert alone["FPRC, ours"].tolist() == ["not available"] * 3
    assert "FPRC, paper" not in alone.columns


@pytest.mark.parametrize(
    ("mean", "std", "text"),
    [(11.5, 0.0143, "11.5 ± 0.0143"), (16.0, None, "16.0"), (16.0, np.nan, "16.0"),
     (0.0, 0.0, "0 ± 0"), (8930.0, 1800.0, "8930 ± 1800"), (-2.345, None, "-2.35"),
     (0.000123456, None, "0.000123"), (0.09999, None, "0.100"), (99.96, 0.9996, "100 ± 1.00")],
)  # fmt: skip
def test_spread_has_three_significant_digits(mean, std, text):
    assert spread(mean, std) == text


def test_configuration_has_every_setting_of_table_1_with_the_published_value(tables):
    models = dict(PUBLISHED["table_1_configuration"])
    models["fprc"] = models["fprc"] | {"n_c": 16}
    models |= models.pop("shared")
    ((table, _, _),) = tables.made(tabulate.tabulate_settings, models=models)
    differs = table[table["value"] != table["published"]]
    assert differs.to_numpy().tolist() == [["FPRC", "Fuzzy clusters, n_c", 16, 8]]
    expected = {"r": 800, "f_input": 0.02, "gamma": 0.8, "rho": 0.4, "epsilon": 0.01,
                "n_c": 8, "n_u": 3, "sigma": 2.0, "n_y": 5, "alpha": 0.001}  # fmt: skip
    symbols = [label.rsplit(", ")[-1] for label in table["parameter"]]
    assert dict(zip(symbols, table["published"], strict=True)) == expected


#: Errors of each run over three seeds, deg.
ERRORS_DEG = {
    "sweep/fprc": [3.0, 4.0, 5.0],
    "sweep/fprc_pd": [1.5, 1.25, 1.75],
    "sweep/pd": [33.0, 32.0, 31.0],
    "disturbance/fprc_pd": [1.0, 1.0, 1.0],
}


CONTROLS = [
    {
        "seed": 101 + k,
        "source": "sim",
        "rmse_deg": {run: errors[k] for run, errors in ERRORS_DEG.items()},
    }
    for k in range(3)
]


def test_tables_over_seeds_have_mean_deviation_range_interval_and_their_own_print(tables):
    (two, _, _), (three, _, _), (four, page, _) = tables.over_seeds(REPLICATES, CONTROLS)
    row = by_metric(two, "fprc").loc["test_rmse"]
    assert row[["mean", "min", "max", "seeds"]].tolist() == [13.5, 12.0, 15.0, 2]
    assert row["std"] == pytest.approx(np.std([12.0, 15.0], ddof=1), 1e-5)
    assert row[["unit", "published_mean", "source"]].tolist() == ["kPa", 11.0, "sim"]
    reversed_ = by_metric(three, "esn")
    assert reversed_["published_mean"].tolist() == [10.2, 10.2, 60.32]
    assert reversed_.loc["test_rmse", "mean"] == 30.0
    assert len(four) == len(ERRORS_DEG)
    for row in four.to_dict("records"):
        errors = ERRORS_DEG[f"{row['reference']}/{row['controller']}"]
        assert row["rmse_deg"] == pytest.approx(sum(errors) / 3)
        assert row["std"] == pytest.approx(statistics.stdev(errors))
        assert (row["min"], row["max"], row["seeds"]) == (min(errors), max(errors), 3)
    # of three: 4.3027 / sqrt(3) deviations to each side
    assert page.iloc[:2, [0, 1, 2]].to_numpy().tolist() == [
        ["FPRC", "ours", "4.00 (1.52 to 6.48)"],
        ["FPRC", "paper", "2.67"],
    ]
    assert page.iloc[:, 3].tolist()[1:3] == ["", "1.00 (1.00 to 1.00)"]


def test_times_are_seconds_and_microseconds_per_sample_beside_the_published_ones(tables):
    entries = [
        {"model": "esn", "phase": phase, "mode": "batch", "samples": 1000, "seconds": [1.0, 3.0]}
        for phase in ("train", "test")
    ]
    times = {"source": "sim", "cpu": "A & B_1 100 %", "threads": 1, "times": entries}
    of_rig, of_import = tables.stored(times, times | {"source": "import"})
    ((table, page, _),) = tables.made(tabulate.tabulate_times, of_rig, left_out={})
    numbers = table[["mean", "std", "us_per_sample", "repeats"]].to_numpy().tolist()
    assert numbers == [pytest.approx([2.0, 2.0**0.5, 2000.0, 2], 1e-5)] * 2
    assert page.to_numpy().tolist() == [
        ["ESN", "Training", "batch", "2.00 ± 1.41", "2000", "16.6 ± 3.28"],
        ["ESN", "Test", "batch", "2.00 ± 1.41", "2000", "8.93 ± 1.80"],
    ]
    ((_, page, _),) = tables.made(tabulate.tabulate_times, of_import, left_out={})
    assert not page.columns.str.contains("Paper").any()


def test_tables_name_their_data_and_failed_checks(tables):
    cut = {"passed": False, "finding": "the computer went off"}
    whole = {"log": "monday.h5", "checks": {"complete": cut | {"passed": True}}}
    half = {"log": "tuesday.h5", "checks": {"complete": cut}}
    checked = [{"recordings": [whole]}, {"recordings": [whole, half]}]
    of_models = tables.of_models(*REPORTS, quality=checked)
    # one seed has neither deviation nor interval
    of_seeds = tables.over_seeds(REPLICATES[:1], CONTROLS[:1])
    for _, page, note in (*of_models, *of_seeds):
        assert "simulated rig, not hardware" in note
        assert "monday.h5" not in note
        shown = re.findall(r"\w+", f"{page.to_csv()} {note}".lower())
        assert not {"nan", "none"} & set(shown)
        assert "( to )" not in page.to_csv()
    for _, _, note in of_models:
        assert "tuesday.h5: complete: the computer went off" in note


@pytest.fixture
def table_of(tmp_path):
    """Make Table IV of closed-loop logs; return its numbers, its page and its note."""

    def make(*runs):
        files = [str(tmp_path / f"table4.{kind}") for kind in ("csv", "md", "tex", "json")]
        limits = config.Settings().quality
        more = {"left_out": [], "limits": limits, "feedback": "As configured.", "quiet_s": 1.0}
        draw_loops(list(map(str, runs)), files, **more)
        page = read_json(files[-1])
        return pd.read_csv(files[0]), page["data"], page["note"]

    return make


def test_table_4_is_judged_after_the_settling_time_beside_the_published_rmse(
    table_of, write_run, channels
):
    runs = []
    for law, reference, errors in (
        ("fprc", "sweep", (3.0, -4.0)), ("fprc_pd", "complex", (1.0,)), ("pd", "sweep", (20.0,)),
    ):  # fmt: skip
        error = np.where(channels["time_s"] < 1.0, 90.0, np.resize(errors, 400))
        theta_d = {"theta_d_deg": channels["theta_deg"] + error}
        runs.append(write_run(f"{law}.h5", theta_d, controller=law, reference=reference))
    table, page, note = table_of(*runs)
    assert table["rmse_deg"].tolist() == pytest.approx([12.5**0.5, 1.0, 20.0], 1e-5)
    assert table["max_abs_error_deg"].tolist() == pytest.approx([4.0, 1.0, 20.0])
    assert page == [
        ["FPRC", "ours", "3.54", ""],
        ["FPRC", "paper", "2.67", ""],
        ["FPRC+PD", "ours", "", "1.00"],
        ["FPRC+PD", "paper", "", "0.608"],
        ["PD", "ours", "20.0", ""],
    ]
    assert "Failed" not in note


def test_failed_checks_of_a_run_stand_below_table_4(table_of, write_run, changed):
    spoiled = changed("p_o_kpa", slice(7, 9), 5000.0) | {"p_fb_kpa": np.full(400, -2e3)}
    cut = {"complete": False, "incomplete_reason": "the computer went off"}
    *_, note = table_of(write_run(changed=spoiled, **cut))
    for failed in ("p_o_kpa: sample 7", "p_fb_kpa: sample 0", "complete: the computer went off"):
        assert failed in note


def test_all_logs_that_are_not_whole_are_named_at_once(table_of, write_run, tmp_path):
    paths = [write_run("a.h5"), write_run("b.h5"), write_run("c.h5")]
    for path in paths[::2]:
        with h5py.File(path, "r+") as file:
            del file["p_ff_kpa"]
    with pytest.raises(LogError) as caught:
        table_of(*paths)
    lines = str(caught.value).splitlines()
    assert [line.partition(":")[0] for line in lines] == [str(path) for path in paths[::2]]
    assert not (tmp_path / "table4.csv").exists()


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
    assert [line for line in tex.splitlines() if line.endswith(r"\\")] == [
        r"Error of $P_o$ [\%] & Ours \\",
        r"FPRC \& more & 1.0 ± 0.1 \\",
        r"$n_c$ & 2 \\",
    ]
    assert r"\caption{5 \% of $\theta_d$}" in tex
    assert r"\label{tab:table}" in tex
    assert [tex.count(rule) for rule in ("toprule", "midrule", "bottomrule")] == [1, 1, 1]
