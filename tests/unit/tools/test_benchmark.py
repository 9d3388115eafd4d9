import json
import textwrap
from base64 import urlsafe_b64encode

import numpy as np
import pandas as pd
import pytest
from matplotlib import pyplot as plt

from fprc.benchmark import peers
from fprc.benchmark.comparisons import Comparison, compare
from fprc.evaluation.timing import interleaved
from fprc.figures.benchmark import plot_growth
from fprc.models import FPRC
from fprc.stages.show_benchmark import tabulate_rules
from fprc.tables.benchmark import (
    benchmark,
    benchmark_page,
    bound_note,
    rules_note,
    rules_page,
)


def comparison(ours, theirs, limit=1e-6):
    return Comparison(
        "a sum", "another", 5, lambda: ours, lambda: theirs, lambda a, b: abs(a - b), limit
    )


def measured(*comparisons, real_time=()):
    return {"comparisons": [compare(each, 3) for each in comparisons], "real_time": real_time}


def test_rounds_take_turns():
    order = []
    work = {name: lambda name=name: order.append(name) for name in ("a", "b")}
    seconds = interleaved(work, 3)
    assert order == ["a", "b"] * 3
    assert [len(each) for each in seconds.values()] == [3, 3]


def test_no_ratio_is_given_where_results_differ():
    same, other = benchmark(measured(comparison(1.0, 1.0), comparison(1.0, 1.1))).itertuples()
    assert same.ratio > 0.0
    assert np.isnan(other.ratio)
    page = benchmark_page(benchmark(measured(comparison(1.0, 1.1))))
    assert page["Times faster"].tolist() == ["results differ"]
    assert page["Ours"].tolist() == [""]


def test_ratio_is_the_median_of_those_of_the_rounds():
    report = measured(comparison(1.0, 1.0))
    report["comparisons"][0]["seconds"] = {"ours": [1.0, 2.0, 1.0], "theirs": [4.0, 4.0, 6.0]}
    (row,) = benchmark(report).itertuples()
    assert (row.ratio, row.ratio_low, row.ratio_high) == (4.0, 2.0, 6.0)


def test_simulated_time_is_compared_with_real_time():
    run = {"loop": "open loop", "simulated_s": 120.0, "aim": 1000, "seconds": [0.1, 0.2, 0.4]}
    (row,) = benchmark(measured(real_time=[run])).itertuples()
    assert row.ratio == pytest.approx(600.0)


def test_whole_workflow_stands_in_the_table_once_it_was_measured():
    whole = {"cores": 2, "ours": {"seconds": 200.0}, "theirs": {"seconds": 3000.0}, "limit": 0.02}
    report = measured(comparison(1.0, 1.0))
    assert len(benchmark(report)) == 1
    _, row = benchmark(report | {"all": whole | {"difference": 0.01}}).itertuples()
    assert (row.ratio, row.against) == (15.0, "the same rules, not compiled")
    page = benchmark_page(benchmark(report | {"all": whole | {"difference": 0.01}}))
    assert page["Times faster"].iloc[-1] == "15.0 (once)"
    _, row = benchmark(report | {"all": whole | {"difference": 0.03}}).itertuples()
    assert np.isnan(row.ratio)


def test_share_of_memory_in_a_step_is_told_where_results_agree():
    steps = {"work": "ESN step in a loop", "agrees": True, "samples": 10}
    bound = {"bytes_8_us": 60.0, "bytes_4_us": 30.0, "gb_per_s": 85.0}
    report = {"comparisons": [steps], "bound": bound}
    steps["seconds"] = {"ours": [3e-4, 4e-4, 5e-4]}
    assert "75 % of our step" in bound_note(report)
    steps["agrees"] = False
    assert "%" not in bound_note(report)


def test_growth_is_drawn_on_logarithmic_axes_with_a_law_where_it_fits():
    sizes = np.array([1.0, 2.0, 4.0, 8.0])
    table = pd.DataFrame({"size": sizes, "seconds": 0.1 * sizes**2.5, "peak_mb": sizes})
    _, (ax, bent) = plt.subplots(1, 2)
    memory = plot_growth(table, ax)
    assert {axis.get_yscale() for axis in (ax, memory)} == {ax.get_xscale()} == {"log"}
    assert (ax.get_ylabel(), memory.get_ylabel()) == ("Time [s]", "Memory [MB]")
    assert ax.lines[0].get_ydata().tolist() == table["seconds"].tolist()
    assert memory.lines[0].get_ydata().tolist() == table["peak_mb"].tolist()
    assert [label.get_text() for label in ax.get_xticklabels()] == ["1", "2", "4", "8"]
    assert ax.get_title("right") == "$n^{2.50}$"
    assert ax.lines[1].get_ydata() == pytest.approx(table["seconds"].tolist())
    plot_growth(table.assign(seconds=[1.0, 1.0, 1.0, 4.0]), bent)
    assert bent.get_title("right") == ""
    assert len(bent.lines) == 1
    plt.close()


def keep(folder, file, rule, log, seconds):
    """Write what Snakemake keeps of a job, where it keeps it for one of the job's outputs."""
    name = urlsafe_b64encode(file.encode()).decode()
    *first, last = textwrap.wrap(name, 40)
    path = folder.joinpath(*(f"@{part}" for part in first), last)
    path.parent.mkdir(parents=True, exist_ok=True)
    job = {"rule": rule, "log": [log], "starttime": 10.0, "endtime": 10.0 + seconds}
    path.write_text(json.dumps(job), encoding="utf-8")


def test_seconds_are_summed_over_the_jobs_of_each_rule(tmp_path):
    jobs = [
        ("results/crossval/sweep_fprc.json", "judge", "results/logs/judge_fprc.log", 3.0),
        ("results/models/a_name_longer_than_one_folder.h5", "judge", "results/logs/judge_fprc.log",
         3.0),
        ("results/crossval/sweep_esn.json", "judge", "results/logs/judge_esn.log", 5.0),
        ("results~~/tables/table2.md", "table", "results/logs/table.log", 1.0),
    ]  # fmt: skip
    others = [
        ("results/smoke/tables/table2.md", "table", "results/smoke/logs/table.log", 9.0),
        ("results/ensemble/rigs_0.json", "ensemble_chunk", "results/logs/ensemble_0.log", 900.0),
    ]
    for job in (*jobs, *others):
        keep(tmp_path / "metadata", *job)
    csv, files = tmp_path / "rules.csv", [file for file, *_ in jobs]
    tabulate_rules(str(csv), files=files, metadata=str(tmp_path / "metadata"))
    table = pd.read_csv(csv)
    assert table.to_dict("list") == {
        "rule": ["judge", "table"],
        "jobs": [2, 1],
        "seconds": [8.0, 1.0],
        "longest_s": [5.0, 1.0],
    }


def test_rules_that_take_little_are_summed():
    rules = pd.DataFrame(
        {
            "rule": ["judge", "sweep", "table", "figure"],
            "jobs": [6, 3, 1, 2],
            "seconds": [60.0, 38.0, 0.5, 1.5],
            "longest_s": [20.0, 30.0, 0.5, 1.0],
        }
    )
    assert rules_page(rules).to_numpy().tolist() == [
        ["judge", "6", "60.0", "20.0"],
        ["sweep", "3", "38.0", "30.0"],
        ["2 other rules", "3", "2.00", "1.00"],
    ]
    assert rules_page(rules, least=0.0)["Rule"].tolist() == rules["rule"].tolist()
    note = rules_note(rules, {"draws": [0.7, 0.9, 0.8]})
    assert note.startswith("The 12 jobs took 100 s in all")
    assert "0.800 s if it draws" in note


def test_plain_steps_of_fprc_are_those_of_the_model():
    time = np.arange(300) * 0.02
    X = np.column_stack([30.0 + 25.0 * np.sin(time), 150.0 + 40.0 * np.sin(time - 0.5)])
    model = FPRC(n_c=3, random_state=0).fit(X, 5.0 * X[:, 0])
    assert np.allclose(peers.numpy_fprc_steps(model, X), model.predict(X), rtol=1e-9)
