"""The files that the workflow makes, for given settings and logs."""

from pathlib import Path

import pytest

from fprc.channels import RAW_CHANNELS
from fprc.config import Settings, check
from fprc.errors import ConfigError, LogError
from fprc.logs import Columns
from fprc.paper import CONTROLLERS, EXPERIMENTS, REFERENCES, run_log
from fprc.plan.plan import Plan, read_plan
from fprc.plan.results import BY_NAME, RESULTS

MODELS = ("esn", "fprc", "fuzzy_linear")
FIVE = (*REFERENCES, "disturbance")
DATA = {
    f"{folder}/{name}.{kind}"
    for name in EXPERIMENTS
    for folder, kind in (("data/raw", "h5"), ("results/data", "h5"), ("results/quality", "json"))
}
REPLICATES = {
    f"results/replicates/{part}_{seed}.json"
    for part in ("models", "grids", "control")
    for seed in range(501, 511)
}
OF_RIGS = {"seeds", "claims"}
CLOSED_LOOP = {"table4", *(f"fig{number}" for number in range(12, 18))}


def judged(experiment, models=MODELS):
    return {
        f"results/{file}"
        for model in models
        for file in (
            f"crossval/{experiment}_{model}.json",
            f"models/{experiment}_{model}.h5",
            f"predictions/{experiment}_{model}_train.h5",
            f"predictions/{experiment}_{model}_test.h5",
        )
    }


def raw(*references, controllers=CONTROLLERS):
    return {f"data/raw/{run_log(r, c)}.h5" for r in references for c in controllers}


@pytest.fixture(scope="module")
def simulated():
    """The plan of the default settings."""
    return Plan(Settings().model_dump(mode="json"), {}, "data/raw")


def recorded(*names, lacking=()):
    """Return the plan of logs that were recorded elsewhere."""
    settings = check({"source": "recorded"}).model_dump(mode="json")
    channels = frozenset(RAW_CHANNELS) - {*lacking}
    there = {name: Columns(Path(f"data/raw/{name}.h5"), {}, {}, names=channels) for name in names}
    return Plan(settings, there, "data/raw")


# --- the table of results -------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("name", "values"),
    [("epsilon", [0.1]), ("epsilon", [0.1, 0.01, 0.01]), ("n_c", [1, 2]), ("n_u", [1, 2]),
     ("n_y", [1, 5])],
)  # fmt: skip
def test_grid_in_which_no_value_is_between_others_is_refused_where_claims_are_judged(
    name, values, tmp_path
):
    settings = check({"grids": {name: values}}).model_dump(mode="json")
    with pytest.raises(ConfigError, match=f"grids.{name} = "):
        read_plan(settings, str(tmp_path))
    with pytest.raises(LogError, match="contains no raw log"):
        read_plan(settings | {"source": "recorded"}, str(tmp_path))


def test_every_result_has_a_name_and_files_of_its_own():
    names = [result.name for result in RESULTS]
    files = [file for result in RESULTS for file in result.files]
    assert len(set(names)) == len(names)
    assert len(set(files)) == len(files)


# --- on the simulated rig -------------------------------------------------------------------------


def test_every_result_can_be_made_on_the_simulated_rig(simulated):
    assert list(simulated.targets) == [result.name for result in RESULTS]
    assert simulated.unavailable == {}
    assert simulated.models == list(MODELS)


@pytest.mark.parametrize(
    ("name", "files"),
    [
        ("table1", {"results/tables/table1.md"}),
        ("table2", {"results/tables/table2.md"} | DATA | judged("sweep")),
        (
            "table4",
            {"results/tables/table4.md"} | DATA | judged("sweep") | raw(*FIVE),
        ),
        ("fig3", {"results/figures/fig03_apparatus.pdf"}),
        ("fig9", {"results/figures/fig09_weights.pdf", "results/weights/fprc.json"} | DATA),
        (
            "fig10",
            {
                "results/figures/fig10_settings.pdf", "results/timing/times_over_n_c.json",
            } | DATA | REPLICATES,
        ),
        (
            "fig16",
            {"results/figures/fig16_loops.pdf"}
            | DATA | judged("sweep")
            | raw("sine_0p5", "sweep", controllers=("pd", "fprc_pd")),
        ),
    ],
)  # fmt: skip
def test_target_names_its_result_and_all_that_it_is_made_of(simulated, name, files):
    assert set(simulated.targets[name]) == files


def test_what_shows_further_seeds_is_made_of_every_replicate(simulated):
    for name in ("seeds", "claims", "fig10", "fig11"):
        assert set(simulated.targets[name]) >= REPLICATES


def test_log_to_come_lacks_only_what_the_rig_does_not_measure():
    for phi, lacking in ((None, {"phi_deg"}), ({}, set())):
        settings = check({"source": "rig", "hardware": {"phi": phi}}).model_dump(mode="json")
        plan = Plan(settings, {}, "data/raw")
        assert {"phi_deg", "p_o_kpa"} - plan.contents["sweep"].names == lacking
        assert ("fig17" in plan.unavailable) is bool(lacking)


def test_recorded_logs_have_no_further_seeds():
    plan = recorded(*EXPERIMENTS)
    for name in ("fig10", "fig11"):
        assert not set(plan.targets[name]) & REPLICATES


# --- on recorded logs -----------------------------------------------------------------------------


def test_without_closed_loops_what_shows_them_is_refused():
    plan = recorded(*EXPERIMENTS)
    assert set(plan.unavailable) == CLOSED_LOOP | OF_RIGS
    assert not plan.targets.keys() & (CLOSED_LOOP | OF_RIGS)
    assert set(plan.targets["table2"]) == (
        {"results/tables/table2.md"} | DATA | judged("sweep")
    )  # fmt: skip
    assert plan.runs == []
    assert [Path(figure).name[:5] for figure in plan.figures] == [
        f"fig{number:02}" for number in range(1, 12)
    ]
    assert [Path(page).stem for page in plan.pages] == [
        "table1", "table2", "table3", "table2_timing"
    ]  # fmt: skip


def test_closed_loop_results_of_recorded_logs_are_made_of_the_runs_that_are_there():
    runs = [run_log("sine_0p5", name) for name in ("fprc", "fprc_pd", "pd")]
    plan = recorded(*EXPERIMENTS, *runs)
    assert plan.runs == sorted(runs, key=plan.every_run.index)
    logs = {f"data/raw/{run}.h5" for run in runs}
    assert set(plan.targets["table4"]) == {"results/tables/table4.md"} | logs
    shown = raw("sine_0p5", controllers=("fprc", "fprc_pd"))
    assert set(plan.targets["fig13"]) == {"results/figures/fig13_sine_0p5.pdf"} | shown
    assert {"fig12", "fig14", "fig15", "fig16", "fig17"} <= set(plan.unavailable)


@pytest.mark.parametrize("number", range(12, 18))
def test_closed_loop_figure_is_made_of_its_own_runs(number):
    name = f"fig{number}"
    own = set(BY_NAME[name].logs)
    plan = recorded(*own)
    assert own <= set(plan.every_run)
    assert name not in plan.unavailable
    for run in own:
        found = recorded(*own - {run}).unavailable
        assert f"{run}.h5, which is not in data/raw" in found[name]


def test_without_p_o_fprc_is_left_out_everywhere():
    plan = recorded(*EXPERIMENTS, lacking=["p_o_kpa"])
    assert plan.models == ["esn", "fuzzy_linear"]
    assert plan.left_out == {"fprc": "needs p_o_kpa, which sweep.h5 and complex.h5 do not have"}
    assert set(plan.unavailable) - CLOSED_LOOP - OF_RIGS == {
        "fig5", "fig8", "fig9", "fig11"
    }  # fmt: skip
    assert set(plan.targets["table2"]) == (
        {"results/tables/table2.md"} | DATA | judged("sweep", plan.models)
    )
    assert "results/grids.json" in plan.targets["fig10"]


def test_model_from_outside_is_judged_and_drives_if_it_can():
    other = {"estimator": "fprc.models.fprc.FuzzyLinear", "inputs": ["theta_deg"]}
    settings = check({"models": {"others": {"taps": other}}}).model_dump(mode="json")
    plan = Plan(settings, {}, "data/raw")
    assert plan.models == [*MODELS, "taps"]
    assert judged("sweep", ["taps"]) <= set(plan.targets["table2"])
    assert raw(*FIVE, controllers=["taps", "taps_pd"]) <= set(plan.targets["table4"])
    assert "taps" in plan.feedforward


# --- what a reader is told ------------------------------------------------------------------------


def test_further_training_logs_are_read_in_order_and_only_where_recorded():
    names = ("sweep", "sweep_10", "sweep_2", "complex")
    plan = recorded(*names)
    assert plan.logs_of("sweep") == [
        f"data/raw/{name}.h5" for name in ("sweep", "sweep_2", "sweep_10")
    ]
    assert plan.logs_of("complex") == ["data/raw/complex.h5"]
    assert {"data/raw/sweep_2.h5", "data/raw/sweep_10.h5"} < set(plan.targets["table2"])
