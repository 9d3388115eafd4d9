import json
from pathlib import Path

import numpy as np
import pytest
from numpy.testing import assert_allclose

from fprc.artifacts import read_json
from fprc.config import Settings
from fprc.experiments import tracking
from fprc.experiments.data import read_data
from fprc.experiments.hysteresis import simulate
from fprc.experiments.measures import measure_hysteresis, measure_pressure_error, measure_runs
from fprc.experiments.settings import Judgement, RigSettings
from fprc.logs import read_columns
from fprc.models import load_model
from fprc.paper import CONTROLLERS
from fprc.registry import build
from fprc.stages.grid import judge_grid, weigh
from fprc.stages.judge import judge
from fprc.stages.preprocess import preprocess
from fprc.stages.record import record
from fprc.stages.replicate import replicate
from fprc.stages.track import track

pytestmark = pytest.mark.slow

SEED, SETTLE_S, QUIET_S = 7, 0.5, 1.5
VALUES = {"epsilon": [1.0, 0.1], "n_c": [1, 2], "n_u": [1, 4], "n_y": [2]}
SWEEPS = {
    "epsilon": [("fprc", 1.0), ("fprc", 0.1)],
    "n_c": [("fprc", 1), ("fprc", 2), ("fuzzy_linear", 1), ("fuzzy_linear", 2)],
    "taps": [("fprc", 1, 2), ("fprc", 4, 2)],
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
    found["models"] |= {"n_y": 2}
    found["models"]["esn"] |= {"r": 12, "washout": 10}
    found["models"]["fprc"] |= {"n_c": 2, "n_u": 2}
    return found


@pytest.fixture(scope="module")
def judgement(settings):
    return {"models": settings["models"], "folds": 2, "split": "shuffled", "seed": SEED}


@pytest.fixture(scope="module")
def on_rig(settings):
    return {
        "rig": settings["rig"],
        "control": settings["control"],
        "signals": settings["experiments"],
        "target": "command",
    }


@pytest.fixture(scope="module")
def repeat(settings, judgement, on_rig):
    """Repeat everything with a seed; return the files by what they hold."""

    def call(folder, seed=SEED):
        files = {name: folder / f"{name}.json" for name in ("compared", "cells", "measures")}
        replicate(
            **{name: str(path) for name, path in files.items()},
            on_rig=on_rig,
            judgement=judgement | {"seed": seed},
            values=VALUES,
            tracking=settings["tracking"],
        )
        return files

    return call


@pytest.fixture(scope="module")
def repeated(repeat, tmp_path_factory):
    """What the stage wrote, and the runs that it measured."""
    seen = []

    def spy(runs, unpushed, quiet_s):
        seen.append((runs, unpushed, quiet_s))
        return measure_runs(runs, unpushed, quiet_s)

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(tracking, "measure_runs", spy)
        files = repeat(tmp_path_factory.mktemp("repeated"))
    ((runs, unpushed, quiet_s),) = seen
    assert quiet_s == QUIET_S
    return files, runs, unpushed


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
    judge(**logs, **files, name=model, judgement=judgement)
    return files


# Tables II and III, and the weights


@pytest.fixture(scope="module")
def errors(repeated):
    return repeated[0]["compared"]


@pytest.mark.parametrize("model", ["esn", "fprc", "fuzzy_linear"])
def test_main_run_writes_the_same_errors_and_what_they_are_of(
    model, errors, logs, judgement, tmp_path
):
    written = judge_both(model, logs, judgement, tmp_path)
    reports = [read_json(path) for path in written["errors"]]
    assert reports == [entry for entry in read_json(errors)["models"] if entry["model"] == model]
    for i, (train, test) in enumerate([("sweep", "complex"), ("complex", "sweep")]):
        fit, prediction = (
            read_columns(written[kind][i], ("p_target_kpa", "p_ff_kpa"))
            for kind in ("fits", "predictions")
        )
        assert fit.attributes["experiment"] == train
        assert prediction.attributes["experiment"] == test
        away_kpa = prediction.channels["p_ff_kpa"] - prediction.channels["p_target_kpa"]
        assert np.sqrt(np.mean(away_kpa**2)) == pytest.approx(reports[i]["test_rmse_kpa"])
        again = load_model(written["fitted"][i])
        X, _ = read_data(logs[test]).pair(model)
        assert_allclose(again.predict(X), prediction.channels["p_ff_kpa"], rtol=1e-9)


def test_weights_are_those_of_the_main_run_with_that_seed(errors, logs, judgement, tmp_path):
    path = str(tmp_path / "weights.json")
    weigh(logs["sweep"], path, judgement=judgement)
    main = read_json(path)
    assert read_json(errors)["weights"] == {key: main[key] for key in ("mean_share", "shares")}
    assert sum(main["mean_share"].values()) <= 1.0 + 1e-9


def test_starts_train_on_one_fold_and_differ_from_each_other(errors, on_rig, judgement):
    """A start is a fit of the readout by itself, on the rows of the first fold."""
    found = read_json(errors)["fprc_test_rmse_over_starts"]
    assert {log: len(set(values)) for log, values in found.items()} == {"sweep": 10, "complex": 10}
    logs, how = simulate(RigSettings(**on_rig), SEED), Judgement(**judgement)
    model = build("fprc", how.models, SEED)
    (X, y), (other, expected) = (logs[name].pair("fprc") for name in ("complex", "sweep"))
    features = model.make_features().fit(X)
    part = how.split_rows(logs["complex"])[0][0]
    seed = int(np.random.SeedSequence(SEED).generate_state(10)[3])
    readout = model.make_readout().set_params(random_state=seed)
    readout.fit(features.transform(X)[part], y[part])
    error = np.sqrt(np.mean((readout.predict(features.transform(other)) - expected) ** 2))
    assert found["complex"][3] == pytest.approx(error)


# Grids


@pytest.fixture(scope="module")
def cells(repeated):
    return repeated[0]["cells"]


def described(cell):
    return tuple(cell[key] for key in ("model", "epsilon", "n_c", "n_u", "n_y") if key in cell)


@pytest.mark.parametrize("name", SWEEPS)
def test_cells_are_the_first_fold_of_the_main_run_with_that_seed(
    cells, name, logs, judgement, tmp_path
):
    path = str(tmp_path / f"{name}.json")
    judge_grid(
        logs["sweep"], logs["complex"], path, grid=name, values=VALUES,
        judgement=judgement, workers=1, checkpoint=str(tmp_path / "partial.jsonl"), version="v",
    )  # fmt: skip
    for found, whole in zip(read_json(cells)[name], read_json(path)["cells"], strict=True):
        assert described(found) == described(whole)
        for phase in ("train_rmse_kpa", "validation_rmse_kpa"):
            assert found[phase] == pytest.approx(whole[phase][:1], rel=1e-6)


# Closed loops


@pytest.fixture(scope="module")
def control(repeated):
    """What the stage wrote of the closed loops, and the runs that it measured."""
    return repeated[0]["measures"], *repeated[1:]


@pytest.fixture(scope="module")
def followed(logs, settings, judgement, tmp_path_factory):
    """Logs of the main run's stages with this seed."""
    folder = tmp_path_factory.mktemp("followed")
    model = judge_both("fprc", logs, judgement, folder)["fitted"][0]
    bench = {name: settings[name] for name in ("tracking", "control", "rig")} | {"seed": SEED}
    runs = {}
    for reference in settings["tracking"]["references"]:
        paths = [str(folder / f"{reference}_{name}.h5") for name in CONTROLLERS]
        names = {"names": ["fprc"], "controllers": CONTROLLERS}
        track([model], paths, reference=reference, **names, **bench)
        for path in paths:
            wanted = ("time_s", "theta_d_deg", "theta_deg", "p_ff_kpa", "p_fb_kpa", "p_i_kpa",
                      "p_o_kpa", "phi_deg")  # fmt: skip
            log = read_columns(path, wanted)
            runs[f"{reference}/{log.attributes['controller']}"] = log.channels
    return runs


def test_settling_part_of_every_run_is_cut_off_before_it_is_measured(control, followed):
    runs, whole = control[1], followed
    assert list(runs) == list(whole)
    for name, channels in runs.items():
        settling = int(SETTLE_S * 200)
        assert channels["time_s"][0] == pytest.approx(SETTLE_S)
        for channel, values in whole[name].items():
            # one is driven by compiled code
            np.testing.assert_allclose(
                channels[channel], values[settling:], rtol=1e-9, atol=1e-9, err_msg=name
            )
        assert {len(values) for values in channels.values()} == {4 * 200}


def test_other_measures_are_those_of_the_runs_and_of_the_sweep(control, logs):
    found = read_json(control[0])
    wanted = (
        "time_s", "p_exp_kpa", "p_exp_command_kpa", "theta_deg", "p_o_kpa", "p_i_kpa",
        "p_i_command_kpa",
    )  # fmt: skip
    sweep = read_columns(str(Path(logs["sweep"]).with_name("sweep_raw.h5")), wanted)
    assert found["hysteresis"] == pytest.approx(measure_hysteresis(sweep.channels), rel=1e-12)
    assert found["pressure_error"] == pytest.approx(measure_pressure_error(sweep.channels))
    again = measure_runs(*control[1:], QUIET_S)
    assert {key: found[key] for key in again} == json.loads(json.dumps(again))
