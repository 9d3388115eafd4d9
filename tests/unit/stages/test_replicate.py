import numpy as np
import pandas as pd
import pytest
from numpy.testing import assert_allclose
from pydantic import validate_call

from fprc import plan
from fprc.config import Settings
from fprc.experiments.data import read_data
from fprc.given import read_json
from fprc.logs import read_columns
from fprc.models import load_model
from fprc.stages.draw import draw_experiments
from fprc.stages.models import judge, replicate

pytestmark = pytest.mark.slow

SEED, SETTLE_S, QUIET_S = 7, 0.5, 1.5
VALUES = {"epsilon": [1.0, 0.1], "n_c": [1, 2], "n_u": [1, 4], "n_y": [2]}


@pytest.fixture(scope="module")
def settings():
    """The whole configuration with short signals and small models."""
    found = Settings().model_dump(mode="json")
    for signal in found["experiments"].values():
        signal["duration_s"] = 16.0
    found["experiments"]["sweep"]["f_hz"] = [0.6, 1.0]  # whole loops in its first quarter
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
def validation(settings):
    return plan.validation(settings, folds=2, seed=SEED)


@pytest.fixture(scope="module")
def on_rig(settings):
    return plan.on_rig(settings)


@pytest.fixture(scope="module")
def errors(settings, on_rig, validation, tmp_path_factory):
    """The file of Tables II and III and of the weights."""
    folder = tmp_path_factory.mktemp("repeated")
    files = {name: str(folder / f"{name}.json") for name in ("compared", "cells", "measures")}
    tracking = settings["tracking"]
    validate_call(replicate)(
        **files, on_rig=on_rig, validation=validation, values=VALUES, tracking=tracking
    )
    return files["compared"]


@pytest.fixture(scope="module")
def logs(settings, make_data, tmp_path_factory):
    """Data of both experiments, made by the main run's stages with this seed."""
    folder = tmp_path_factory.mktemp("main")
    return {name: make_data(folder, name, settings, SEED)[1] for name in settings["experiments"]}


def judge_both(model, logs, validation, folder):
    """Judge a model as the main run does; return its files, sweep first."""
    files = {
        kind: [str(folder / f"{kind}_{name}") for name in logs]
        for kind in ("errors", "fitted", "fits", "predictions")
    }
    validate_call(judge)(**logs, **files, name=model, validation=validation)
    return files


@pytest.mark.parametrize("model", ["esn", "fprc", "fuzzy_linear"])
def test_main_run_writes_the_same_errors_and_what_they_are_of(
    model, errors, logs, validation, tmp_path
):
    written = judge_both(model, logs, validation, tmp_path)
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
        X, *_ = read_data(logs[test]).samples(model)
        assert_allclose(again.predict(X), prediction.channels["p_ff_kpa"], rtol=1e-9)


def test_weights_are_those_of_the_main_run_with_that_seed(
    errors, logs, validation, tmp_path, undrawn
):
    csv = str(tmp_path / "weights.csv")
    validate_call(draw_experiments)(logs["sweep"], fig9=[csv], validation=validation)
    shown, ours = pd.read_csv(csv), read_json(errors)["weights"]
    for feature, rules in ours["shares"].items():
        rows = shown[shown["feature"] == feature]
        assert_allclose(rows["share"], np.ravel(rules), rtol=1e-5)
        assert set(rows["mean_of_feature"].round(5)) == {round(ours["mean_share"][feature], 5)}
