"""The files that the workflow makes, for given settings and logs."""

from pathlib import Path

import h5py
import pytest

from fprc.channels import RAW_CHANNELS
from fprc.config import Settings, check
from fprc.errors import LogError
from fprc.experiments.comparison import CrossValidation
from fprc.experiments.data import RigSettings
from fprc.logs import Columns
from fprc.paper import EXPERIMENTS, run_log
from fprc.plan import (
    Plan,
    feedback_in_words,
    of_pressures,
    on_rig,
    paper_models,
    read_plan,
    validation,
)

MODELS = ("esn", "fprc", "fuzzy_linear")
OF_RIGS = {"seeds", "claims"}
CLOSED_LOOP = {"table4", *(f"fig{number}" for number in range(12, 18))}


@pytest.fixture(scope="module")
def simulated():
    """The plan of the default settings."""
    return Plan(Settings(), {})


def recorded(*names, lacking=()):
    """Return the plan of logs that were recorded elsewhere."""
    settings = check({"source": "recorded"})
    channels = frozenset(RAW_CHANNELS) - {*lacking}
    there = {name: Columns(Path(f"data/raw/{name}.h5"), {}, {}, names=channels) for name in names}
    return Plan(settings, there)


# --- on the simulated rig -------------------------------------------------------------------------


def test_every_result_can_be_made_on_the_simulated_rig(simulated):
    assert simulated.unavailable == {}
    assert simulated.models == list(MODELS)
    assert {simulated.source_of(name) for name in ("fig4", "fig8", "fig17")} == {"sim"}
    assert simulated.source_of("fig1") == "none"


def test_log_to_come_lacks_only_what_the_rig_does_not_measure():
    for phi, lacking in ((None, {"phi_deg"}), ({}, set())):
        settings = check({"source": "rig", "hardware": {"phi": phi}})
        plan = Plan(settings, {})
        assert {"phi_deg", "p_o_kpa"} - plan.contents["sweep"] == lacking
        assert ("fig17" in plan.unavailable) is bool(lacking)


# --- on recorded logs -----------------------------------------------------------------------------


def test_without_closed_loops_what_shows_them_is_refused():
    plan = recorded(*EXPERIMENTS)
    assert set(plan.unavailable) == CLOSED_LOOP | OF_RIGS
    assert plan.possible(fig4=["a"], fig12=["b"], claims=["c"]) == {"fig4": ["a"]}
    assert plan.runs == []
    assert plan.data == [
        f"{folder}/{name}.h5" for folder in ("data/raw", "results/data") for name in EXPERIMENTS
    ]
    assert plan.replicates("grids") == []


def test_closed_loop_results_of_recorded_logs_show_the_runs_that_are_there():
    runs = [run_log("sine_0p5", name) for name in ("fprc", "fprc_pd", "pd")]
    plan = recorded(*runs)
    assert runs[1] in recorded(*runs[::2]).unavailable["fig13"]
    assert plan.runs == sorted(runs, key=plan.every_run.index)
    assert {"fig12", "fig14", "fig15", "fig16", "fig17"} <= set(plan.unavailable)
    assert not {"table4", "fig13"} & set(plan.unavailable)


def test_without_p_o_fprc_is_left_out_everywhere():
    plan = recorded(*EXPERIMENTS, lacking=["p_o_kpa"])
    assert plan.models == ["esn", "fuzzy_linear"]
    assert plan.left_out == {"fprc": "needs p_o_kpa in sweep.h5 and p_o_kpa in complex.h5"}
    assert set(plan.unavailable) - CLOSED_LOOP - OF_RIGS == {
        "fig5", "fig8", "fig9", "fig11"
    }  # fmt: skip


def test_model_from_outside_is_judged_and_drives_if_it_can():
    other = {"estimator": "fprc.models.fprc.FuzzyLinear", "inputs": ["theta_deg"]}
    settings = check({"models": {"others": {"taps": other}}})
    plan = Plan(settings, {})
    assert plan.models == [*MODELS, "taps"]
    assert {"taps", "taps_pd"} <= set(plan.controllers)
    assert "taps" in plan.feedforward


def test_further_training_logs_are_read_in_order_and_only_where_recorded():
    plan = recorded("sweep", "sweep_10", "sweep_2", "complex")
    assert plan.logs_of("sweep") == [
        f"data/raw/{name}.h5" for name in ("sweep", "sweep_2", "sweep_10")
    ]
    assert plan.logs_of("complex") == ["data/raw/complex.h5"]
    assert {"data/raw/sweep_2.h5", "data/raw/sweep_10.h5"} < set(plan.data)


# --- logs that exist when the workflow begins -----------------------------------------------------

NAMES = ["sweep", "complex", "track_sweep_fprc"]


def there(folder, source="sim"):
    return read_plan(check({"source": source, "folders": {"raw": str(folder)}})).existing


def test_every_file_that_cannot_be_read_is_named(write_log, tmp_path):
    (tmp_path / "sweep.h5").write_bytes(b"no log at all")
    write_log("complex.h5", notes="{")
    write_log("track_sweep_fprc.h5")
    with pytest.raises(LogError) as caught:
        there(tmp_path)
    first, second = str(caught.value).splitlines()
    assert first.startswith(f"{tmp_path / 'sweep.h5'}: not a log in HDF5")
    assert second.startswith(f"{tmp_path / 'complex.h5'}: attribute notes: must hold a JSON")


def test_logs_are_listed_in_the_order_of_the_plan(write_log, tmp_path):
    assert there(tmp_path) == {}
    for name in reversed(NAMES):
        write_log(f"{name}.h5")
    assert list(there(tmp_path)) == NAMES


@pytest.mark.parametrize(
    ("source", "of_log", "refused"),
    [("sim", "sim", False), ("rig", "sim", True), ("sim", "rig", True), ("sim", "import", True),
     ("sim", None, True), ("rig", None, False), ("rig", "rig", False), ("recorded", "sim", False)],
)  # fmt: skip
def test_log_of_another_source_is_not_overwritten(write_log, tmp_path, source, of_log, refused):
    paths = [write_log(f"{name}.h5", source=of_log or "sim") for name in ("sweep", "complex")]
    for path in paths if of_log is None else ():
        with h5py.File(path, "r+") as file:
            del file.attrs["source"]
    if not refused:
        assert list(there(tmp_path, source)) == ["sweep", "complex"]
        return
    with pytest.raises(LogError) as caught:
        there(tmp_path, source)
    lines = str(caught.value).splitlines()
    assert [line.split(": ")[0] for line in lines] == [str(path) for path in paths]


# --- what the rules pass to their stages ----------------------------------------------------------

SETTINGS = Settings().model_dump(mode="json")
SETTINGS["models"]["others"] = {"mine": {"estimator": "my.Model", "inputs": [], "settings": {}}}
POSITIONAL = {"feedback": "positional", "pd": {"kp_kpa_per_deg": 2.5, "kd_kpa_s_per_deg": 0.07}}


def with_control(**control):
    return SETTINGS | {"control": SETTINGS["control"] | control}


def test_stages_get_the_arguments_that_they_take():
    how = CrossValidation(**validation(SETTINGS, models=paper_models(SETTINGS), seed=7))
    assert (how.folds, how.split, how.seed) == (5, "shuffled", 7)
    assert how.models == SETTINGS["models"] | {"others": {}}
    assert SETTINGS["models"]["others"].keys() == {"mine"}
    assert RigSettings(**on_rig(SETTINGS)).target == "command"


def test_model_is_judged_anew_only_if_its_own_settings_change():
    fprc = SETTINGS["models"]["fprc"] | {"epsilon": 0.5}
    changed = SETTINGS | {"models": SETTINGS["models"] | {"fprc": fprc}}
    for model, same in (("esn", True), ("fuzzy_linear", True), ("fprc", False)):
        assert (validation(changed, model) == validation(SETTINGS, model)) == same


def test_open_loops_are_recorded_with_nothing_of_the_feedback():
    control = of_pressures(SETTINGS)
    assert control == of_pressures(with_control(**POSITIONAL))
    assert control != of_pressures(with_control(k_in_kpa_per_deg=3.0))


def test_words_on_the_feedback_tell_its_gains_but_for_recorded_logs():
    recorded = with_control(**POSITIONAL) | {"source": "recorded"}
    assert feedback_in_words(recorded) == feedback_in_words(SETTINGS | {"source": "recorded"})
    assert "2.5 kPa/deg" in feedback_in_words(with_control(**POSITIONAL))
