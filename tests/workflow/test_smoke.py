import h5py
import pandas as pd
import pytest

MODELS = ["esn", "fprc", "fuzzy_linear"]
CONTRACT = [
    *(f"tables/{name}.{kind}" for name in ("table1", "table2") for kind in ("csv", "md", "tex")),
    *(
        f"figures/{name}.{kind}"
        for name in ("fig04_hysteresis_actuator", "fig05_hysteresis_reservoir", "fig08_training")
        for kind in ("pdf", "png")
    ),
    "timing/table2_timing.csv",
]

pytestmark = pytest.mark.slow


@pytest.mark.parametrize("name", CONTRACT)
def test_smoke_makes_every_promised_output(smoked, name):
    assert (smoked[0].folder / "results/smoke" / name).stat().st_size > 100


def test_smoke_writes_nowhere_but_below_results_smoke(smoked):
    files = smoked[0].files("results", "data")
    assert files
    assert all(name.startswith("results/smoke/") for name in files)


def test_smoke_leaves_no_temporary_files(smoked):
    assert not [name for name in smoked[0].files("results") if ".part" in name]


def test_progress_names_stage_fold_and_how_far(smoked):
    printed = smoked[1]
    assert "[judge fprc] fprc: fold 3 of 5: training" in printed
    assert "[record sweep]  10 of  20 s" in printed
    assert "[measure_times] esn: test, sequential, 2 repeats" in printed
    assert "(100%) done" in printed


def test_table2_is_tidy_and_complete(smoked):
    table = pd.read_csv(smoked[0].folder / "results/smoke/tables/table2.csv")
    expected = ["model", "metric", "unit", "mean", "std", "published_mean", "published_std"]
    assert list(table.columns) == [*expected, "source"]
    assert len(table) == 9
    assert set(table["source"]) == {"sim"}
    assert table[["mean", "published_mean"]].notna().all(axis=None)
    errors = table.set_index(["model", "metric"])["mean"]
    assert errors.between(1.0, 100.0).all()
    for model in MODELS:
        assert errors[model, "validation_rmse"] > 0.9 * errors[model, "train_rmse"]


def test_no_table_holds_nan(smoked):
    for name, content in smoked[0].files("results/smoke/tables", "results/smoke/timing").items():
        assert b"nan" not in content.lower(), name


def test_timing_gives_both_modes_of_every_model(smoked):
    table = pd.read_csv(smoked[0].folder / "results/smoke/timing/table2_timing.csv")
    groups = {(row.model, row.metric, row.mode) for row in table.itertuples()}
    assert len(groups) == 12
    assert (table["mean"] > 0).all()
    assert (table["threads"] == 1).all()
    assert table["cpu"].str.len().min() > 0


def test_science_results_hold_no_times(smoked):
    for path in (smoked[0].folder / "results/smoke/tables").glob("*.csv"):
        assert "time" not in path.read_text().lower()


def test_raw_logs_say_simulated_seed_and_version(smoked):
    for experiment in ("sweep", "complex"):
        with h5py.File(smoked[0].folder / f"results/smoke/raw/{experiment}.h5") as log:
            assert log.attrs["source"] == "sim"
            assert log.attrs["simulated"]
            assert log.attrs["seed"] == 1
            assert log.attrs["sample_rate_hz"] == 200.0
            assert log.attrs["software"].startswith("fprc ")
            assert '"valve"' in log.attrs["rig"]


def test_second_run_has_nothing_to_do(smoked):
    assert "Nothing to be done" in smoked[0].smoke("all").stdout


def test_second_build_gives_the_same_bytes(smoked, project):
    # the second one on one core; times are measured and logs name processes
    targets = ["table1", "table2", "seeds", "fig4", "fig5", "fig8"]
    done = project.smoke("--cores", "1", *targets)
    assert done.returncode == 0, done.stdout
    first, second = (
        {
            name: content
            for name, content in run.files("results").items()
            if "/timing/" not in name and "/logs/" not in name
        }
        for run in (smoked[0], project)
    )
    assert first.keys() == second.keys()
    assert [name for name in first if first[name] != second[name]] == []
