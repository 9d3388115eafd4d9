import json
from pathlib import Path

import numpy as np
import pytest
from numpy.testing import assert_allclose

from fprc.artifacts import read_json
from fprc.claims import measure_hysteresis, measure_runs
from fprc.config import Settings
from fprc.logs import read_columns
from fprc.models import load_model
from fprc.stages import replicate as stage
from fprc.stages.judge import judge, judge_model, read_data
from fprc.stages.preprocess import preprocess
from fprc.stages.record import record
from fprc.stages.sweep import sweep_settings, weigh
from fprc.stages.track import CONTROLLERS, identify_gain, track

SEED, SETTLE_S, QUIET_S = 7, 0.5, 1.5
VALUES = {"epsilon": [1.0, 0.1], "n_c": [1, 2], "n_u": [1, 4], "n_y": [2], "replicate_taps": [1, 3]}
SWEEPS = {
    "epsilon": [("fprc", 1.0), ("fprc", 0.1)],
    "n_c": [("fprc", 1), ("fprc", 2), ("fuzzy_linear", 1), ("fuzzy_linear", 2)],
    "taps": [("fprc", 1, 1), ("fprc", 1, 3), ("fprc", 3, 1), ("fprc", 3, 3)],
}


@pytest.fixture(scope="module")
def settings():
    """The whole configuration with short signals and small models."""
    found = Settings().model_dump(mode="json")
    for signal in found["experiments"].values():
        signal["duration_s"] = 16.0
    for name, reference in found["tracking"]["references"].items():
        # a frequency high enough for a loop or two; the disturbance lasts longer than its quiet
        f_hz = [0.5, 1.0] if name == "sweep" else reference["f_hz"]
        reference |= {"f_hz": f_hz, "duration_s": 4.0, "settle_s": SETTLE_S}
    found["tracking"]["pushes"] |= {"quiet_s": QUIET_S, "every_s": 0.2}
    found["tracking"]["candidate_kp_kpa_per_deg"] = [0.5, 3.0]
    found["models"] |= {"n_y": 2}
    found["models"]["esn"] |= {"r": 12, "washout": 10}
    found["models"]["fprc"] |= {"n_c": 2, "n_u": 2}
    return found


@pytest.fixture(scope="module")
def judgement(settings):
    return {"models": settings["models"], "folds": 2, "split": "shuffled"}


@pytest.fixture(scope="module")
def replication(settings, judgement):
    """What every stage of this module takes, without a seed."""
    rig = {name: settings[name] for name in ("control", "rig")}
    return {"signals": settings["experiments"], "target": "command"} | rig | judgement


@pytest.fixture(scope="module")
def logs(settings, tmp_path_factory):
    """Logs of both experiments, made by the main run's stages with this seed."""
    folder = tmp_path_factory.mktemp("main")
    paths = {}
    for name, signal in settings["experiments"].items():
        raw, paths[name] = str(folder / f"{name}_raw.h5"), str(folder / f"{name}.h5")
        record(
            raw, experiment=name, signal=signal, control=settings["control"],
            rig=settings["rig"], seed=SEED,
        )  # fmt: skip
        preprocess(
            raw, paths[name], str(folder / f"{name}.json"), experiment=name, target="command",
            sample_rate_hz=200.0, limits=settings["quality"],
        )  # fmt: skip
    return paths


def judge_both(model, logs, judgement, folder):
    """Judge a model as the main run does; return its files, sweep first."""
    files = {
        kind: [str(folder / f"{kind}_{name}") for name in logs]
        for kind in ("errors", "fitted", "fits", "predictions")
    }
    judge(**logs, **files, name=model, **judgement, seed=SEED)
    return files


def text(path):
    return Path(path).read_text(encoding="utf-8")


# Tables II and III, and the weights


@pytest.fixture(scope="module")
def errors(replication, tmp_path_factory):
    path = tmp_path_factory.mktemp("errors") / "seed_7.json"
    stage.replicate(str(path), **replication, seed=SEED)
    return path


def test_errors_are_those_of_each_direction_judged_alone(errors, logs, judgement):
    found = read_json(errors)
    assert (found["seed"], found["source"]) == (SEED, "sim")
    assert [(entry["trained_on"], entry["model"]) for entry in found["models"]] == [
        (log, model) for log in ("sweep", "complex") for model in ("esn", "fprc", "fuzzy_linear")
    ]
    data = {name: read_data(path) for name, path in logs.items()}
    settings = [judgement[key] for key in ("models", "folds", "split")]
    for entry in found["models"]:
        train = entry["trained_on"]
        test = "complex" if train == "sweep" else "sweep"
        _, report, _ = judge_model(entry["model"], *settings, SEED, data[train], data[test])
        assert entry == json.loads(json.dumps(report))


@pytest.mark.parametrize("model", ["esn", "fprc", "fuzzy_linear"])
def test_main_run_writes_the_same_errors_and_what_they_are_of(
    model, errors, logs, judgement, tmp_path
):
    written = judge_both(model, logs, judgement, tmp_path)
    reports = [read_json(path) for path in written["errors"]]
    assert reports == [entry for entry in read_json(errors)["models"] if entry["model"] == model]
    for i, (train, test) in enumerate([("sweep", "complex"), ("complex", "sweep")]):
        fit, prediction = (
            read_columns(written[kind][i], ("p_exp_kpa", "p_ff_kpa"))
            for kind in ("fits", "predictions")
        )
        assert fit.attributes["experiment"] == train
        assert prediction.attributes["experiment"] == test
        away_kpa = prediction.channels["p_ff_kpa"] - prediction.channels["p_exp_kpa"]
        assert np.sqrt(np.mean(away_kpa**2)) == pytest.approx(reports[i]["test_rmse_kpa"])
        again = load_model(written["fitted"][i])
        X, _ = read_data(logs[test]).pair(model)
        assert_allclose(again.predict(X), prediction.channels["p_ff_kpa"], rtol=1e-9)


def test_weights_are_those_of_the_main_run_with_that_seed(errors, logs, judgement, tmp_path):
    path = str(tmp_path / "weights.json")
    weigh(logs["sweep"], path, **judgement, seed=SEED)
    main = read_json(path)
    assert read_json(errors)["weights"] == {key: main[key] for key in ("mean_share", "shares")}
    assert sum(main["mean_share"].values()) <= 1.0 + 1e-9


def test_errors_of_one_seed_have_the_same_bytes_and_those_of_another_differ(
    errors, replication, tmp_path
):
    for name, seed in (("again.json", SEED), ("other.json", SEED + 1)):
        stage.replicate(str(tmp_path / name), **replication, seed=seed)
    assert text(tmp_path / "again.json") == text(errors)
    ours, other = read_json(errors), read_json(tmp_path / "other.json")
    assert other["seed"] == SEED + 1
    for mine, theirs in zip(ours["models"], other["models"], strict=True):
        assert mine["test_rmse_kpa"] != theirs["test_rmse_kpa"]
    assert ours["weights"]["mean_share"] != other["weights"]["mean_share"]


def test_measured_pressure_is_another_target_than_the_command(errors, replication, tmp_path):
    stage.replicate(str(tmp_path / "m.json"), **replication | {"target": "measured"}, seed=SEED)
    ours, other = (read_json(path)["models"] for path in (errors, tmp_path / "m.json"))
    assert {entry["target"] for entry in ours} == {"command"}
    assert {entry["target"] for entry in other} == {"measured"}
    for mine, theirs in zip(ours, other, strict=True):
        assert mine["test_rmse_kpa"] != theirs["test_rmse_kpa"]


# Sweeps


def sweep(folder, replication, seed=SEED, version="v", name="cells.json"):
    folder.mkdir(exist_ok=True)
    stage.replicate_sweeps(
        str(folder / name),
        **replication,
        values=VALUES,
        seed=seed,
        version=version,
        checkpoint=str(folder / "cells.partial.jsonl"),
    )
    return folder / name


@pytest.fixture(scope="module")
def cells(replication, tmp_path_factory):
    return sweep(tmp_path_factory.mktemp("cells"), replication)


def described(cell):
    return tuple(cell[key] for key in ("model", "epsilon", "n_c", "n_u", "n_y") if key in cell)


def test_sweeps_hold_every_cell_and_taps_on_the_coarse_grid_only(cells):
    found = read_json(cells)
    assert (found.pop("seed"), found.pop("source")) == (SEED, "sim")
    assert {name: [described(cell) for cell in group] for name, group in found.items()} == SWEEPS


@pytest.mark.parametrize("name", SWEEPS)
def test_cells_are_those_of_the_main_run_with_that_seed(cells, name, logs, judgement, tmp_path):
    coarse = VALUES | dict.fromkeys(("n_u", "n_y"), VALUES["replicate_taps"])
    path = str(tmp_path / f"{name}.json")
    sweep_settings(
        logs["sweep"], logs["complex"], path, sweep=name, values=coarse, **judgement,
        seed=SEED, workers=1, checkpoint=str(tmp_path / "partial.jsonl"), version="v",
    )  # fmt: skip
    assert read_json(cells)[name] == read_json(path)["cells"]


def test_cells_of_one_seed_have_the_same_bytes_and_those_of_another_differ(
    cells, replication, tmp_path
):
    assert text(sweep(tmp_path, replication)) == text(cells)
    other = read_json(sweep(tmp_path, replication, seed=SEED + 1, name="other.json"))
    for name in SWEEPS:
        for mine, theirs in zip(read_json(cells)[name], other[name], strict=True):
            assert mine["test_rmse_kpa"] != theirs["test_rmse_kpa"]


def test_finished_sweeps_leave_no_checkpoint(cells):
    assert [path.name for path in cells.parent.iterdir()] == ["cells.json"]


@pytest.fixture
def judged(monkeypatch):
    """Cells in the order in which they are judged; stops before number ``judged.stop``."""

    class Judge:
        def __init__(self):
            self.cells, self.stop = [], None

        def __call__(self, cell, **settings):
            if len(self.cells) == self.stop:
                raise KeyboardInterrupt
            self.cells.append(described(cell))
            return judge_cell(cell, **settings)

    judge_cell = stage.judge_cell
    spy = Judge()
    monkeypatch.setattr(stage, "judge_cell", spy)
    return spy


ALL = [cell for group in SWEEPS.values() for cell in group]


def stopped(folder, replication, judged, after):
    judged.stop = after
    with pytest.raises(KeyboardInterrupt):
        sweep(folder, replication)
    assert [path.name for path in folder.iterdir()] == ["cells.partial.jsonl"]
    judged.cells, judged.stop = [], None


def test_stopped_sweeps_go_on_where_they_were(cells, replication, tmp_path, judged):
    stopped(tmp_path, replication, judged, after=3)
    assert text(sweep(tmp_path, replication)) == text(cells)
    assert judged.cells == ALL[3:]
    assert [path.name for path in tmp_path.iterdir()] == ["cells.json"]


@pytest.mark.parametrize("what", ["version", "seed", "rig", "models", "folds"])
def test_checkpoint_of_other_code_or_settings_is_not_used(
    replication, tmp_path, judged, settings, what
):
    stopped(tmp_path, replication, judged, after=3)
    models = settings["models"] | {"alpha": 0.5}
    rig = settings["rig"] | {"drift": settings["rig"]["drift"] | {"sigma_kpa": 0.0}}
    changes = {
        "version": {"version": "w"},
        "seed": {"seed": SEED + 1},
        "rig": {"replication": replication | {"rig": rig}},
        "models": {"replication": replication | {"models": models}},
        "folds": {"replication": replication | {"folds": 3}},
    }
    sweep(tmp_path, **{"replication": replication} | changes[what])
    assert judged.cells == ALL


# Closed loops


@pytest.fixture(scope="module")
def control(replication, settings, tmp_path_factory):
    """What the stage wrote, and the runs that it measured."""
    path = tmp_path_factory.mktemp("control") / "control.json"
    seen = []

    def spy(runs, quiet_s):
        seen.append((runs, quiet_s))
        return measure_runs(runs, quiet_s)

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(stage, "measure_runs", spy)
        stage.replicate_control(str(path), **replication, tracking=settings["tracking"], seed=SEED)
    ((runs, quiet_s),) = seen
    assert quiet_s == QUIET_S
    return path, runs


@pytest.fixture(scope="module")
def followed(logs, settings, judgement, tmp_path_factory):
    """Gains and logs of the main run's stages with this seed."""
    folder = tmp_path_factory.mktemp("followed")
    model = judge_both("fprc", logs, judgement, folder)["fitted"][0]
    bench = {name: settings[name] for name in ("tracking", "control", "rig")} | {"seed": SEED}
    gains = str(folder / "gains.json")
    identify_gain(model, gains, **bench)
    runs = {}
    for reference in settings["tracking"]["references"]:
        paths = [str(folder / f"{reference}_{name}.h5") for name in CONTROLLERS]
        track(
            model, gains, paths, reference=reference, controllers=list(CONTROLLERS), **bench
        )  # fmt: skip
        for path in paths:
            wanted = ("time_s", "theta_d_deg", "theta_deg", "p_ff_kpa", "p_fb_kpa", "p_i_kpa",
                      "p_o_kpa", "phi_deg")  # fmt: skip
            log = read_columns(path, wanted)
            runs["/".join(log.attributes[key] for key in ("reference", "controller", "gain"))] = (
                log.channels
            )
    return read_json(gains), runs


def test_gains_are_those_of_the_main_run_with_that_seed(control, followed):
    found = read_json(control[0])
    assert found["gains"] == {name: followed[0][name] for name in ("printed", "identified")}
    assert (found["seed"], found["source"]) == (SEED, "sim")


def test_settling_part_of_every_run_is_cut_off_before_it_is_measured(control, followed):
    runs, whole = control[1], followed[1]
    assert list(runs) == list(whole)
    for name, channels in runs.items():
        settling = int(SETTLE_S * 200)
        assert channels["time_s"][0] == pytest.approx(SETTLE_S)
        for channel, values in whole[name].items():
            np.testing.assert_array_equal(channels[channel], values[settling:], err_msg=name)
        assert {len(values) for values in channels.values()} == {4 * 200}


def test_errors_of_the_runs_are_those_of_the_logs_after_settling(control, followed):
    found = read_json(control[0])["rmse_deg"]
    for name, log in followed[1].items():
        error = (log["theta_d_deg"] - log["theta_deg"])[log["time_s"] >= SETTLE_S]
        assert found[name] == pytest.approx(float(np.sqrt(np.mean(error**2))), rel=1e-12)


def test_other_measures_are_those_of_the_runs_and_of_the_sweep(control, logs):
    found = read_json(control[0])
    sweep = read_columns(logs["sweep"], ("time_s", "p_exp_kpa", "theta_deg", "p_o_kpa"))
    assert found["hysteresis"] == pytest.approx(measure_hysteresis(sweep.channels), rel=1e-12)
    again = measure_runs(control[1], QUIET_S)
    assert {key: found[key] for key in again} == json.loads(json.dumps(again))


def test_measures_of_one_seed_have_the_same_bytes_and_those_of_another_differ(
    control, replication, settings, tmp_path
):
    for name, seed in (("again.json", SEED), ("other.json", SEED + 1)):
        stage.replicate_control(
            str(tmp_path / name), **replication, tracking=settings["tracking"], seed=seed
        )
    assert text(tmp_path / "again.json") == text(control[0])
    ours, other = read_json(control[0]), read_json(tmp_path / "other.json")
    for key in ("rmse_deg", "effort", "hysteresis"):
        assert all(ours[key][name] != other[key][name] for name in ours[key])
