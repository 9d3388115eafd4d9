from pathlib import Path

import numpy as np
import pytest

from fprc.errors import LogError
from fprc.evaluation import evaluate
from fprc.experiments.comparison import CrossValidation, compare_models, evaluate_grids
from fprc.experiments.data import Data, join, read_data, refuse_mixture, select_channels
from fprc.logs import Columns, write_columns
from fprc.logs.quality import other_quantity
from fprc.registry import build

MODELS = {
    "n_y": 2, "alpha": 1e-3, "others": {},
    "esn": {"r": 8, "f_input": 0.02, "gamma": 0.5, "rho": 0.4, "washout": 20},
    "fprc": {"epsilon": 0.1, "n_c": 2, "n_u": 2, "sigma": 2.0, "restarts": 1},
}  # fmt: skip
VALIDATION = CrossValidation(models=MODELS, folds=3, split="blocked", seed=1, purge_s=0.0)


def recording(samples=100, begin=5.0, without=(), name="a.h5", **attributes):
    rng = np.random.default_rng(samples)
    theta = begin + np.cumsum(rng.normal(size=samples))
    channels = {
        "time_s": begin + np.arange(samples) / 200.0,
        "theta_deg": theta,
        "p_o_kpa": 100.0 + np.cumsum(rng.normal(size=samples)),
        "p_target_kpa": 3.0 * theta + rng.normal(size=samples),
    }
    described = {"experiment": "sweep", "source": "import", "target": "measured"} | attributes
    return Data({key: channels[key] for key in channels if key not in without}, described, name)


@pytest.fixture
def joined():
    return join([recording(60), recording(90, 30.0, name="b.h5")], 1.0 / 200.0)


def test_joined_log_has_every_sample_and_an_even_clock_also_from_its_file(joined, tmp_path):
    a, b = recording(60), recording(90, 30.0)
    write_columns(tmp_path / "data.h5", joined.channels, joined.attributes)
    again = read_data(tmp_path / "data.h5")
    assert joined.lengths == again.lengths == [60, 90]
    assert again.attributes["recordings"] == {"a.h5": 60, "b.h5": 90}
    np.testing.assert_allclose(again.channels["time_s"], np.arange(150) / 200.0)
    for name in ("theta_deg", "p_o_kpa", "p_target_kpa"):
        both = np.concatenate([a.channels[name], b.channels[name]])
        assert np.array_equal(again.channels[name], both)


def test_logs_that_do_not_go_together_are_refused_with_every_reason():
    logs = [
        recording(60),
        recording(70, name="b.h5", source="recorded", target="command"),
        recording(80, name="c.h5", without=["p_o_kpa"]),
    ]
    with pytest.raises(LogError) as caught:
        join(logs, 0.005)
    lines = str(caught.value).splitlines()
    assert [line.split(" is ")[0] for line in lines] == [
        "b.h5: source", "b.h5: target", "c.h5: list of channels"
    ]  # fmt: skip


@pytest.mark.parametrize("changed", [{"source": "sim"}, {"p_target_unit": "bar"}])
def test_training_and_test_log_have_one_source_and_one_unit(changed):
    train = recording(60, p_target_unit="kPa")
    refuse_mixture(train, recording(60), recording(60, without=["p_o_kpa"], target="command"))
    with pytest.raises(LogError, match=r"b\.h5.*a\.h5"):
        refuse_mixture(train, recording(60, name="b.h5", **changed))


def test_missing_input_is_refused():
    with pytest.raises(LogError, match="p_o_kpa"):
        recording(60, without=["p_o_kpa"]).samples("fprc", MODELS)


@pytest.mark.parametrize(
    ("inputs", "warned"),
    [(("theta_deg",), ["p_exp_kpa"]), (("theta_deg", "p_o_kpa"), ["p_exp_kpa", "p_o_kpa"])],
)
def test_only_another_quantity_in_a_channel_that_is_read_is_warned_of(inputs, warned, caplog):
    units = {"p_exp_kpa": "force [N]", "p_i_kpa": "current [A]", "p_o_kpa": "strain [1]"}
    notes = {name: other_quantity(name) + unit for name, unit in units.items()}
    data = recording()
    channels = {**data.channels, "p_exp_kpa": data.channels["p_target_kpa"]}
    attributes = {**data.attributes, "notes": notes | {"theta_deg": "from a camera"}}
    selected = select_channels(Columns(Path("a.h5"), channels, attributes), "measured", inputs)
    assert selected.name == "a.h5"
    assert [record.getMessage() for record in caplog.records] == [
        f"warning: {name}: not in kPa: {units[name]}" for name in warned
    ]


@pytest.mark.parametrize("other", [{"source": "sim"}, {"p_target_unit": "N"}])
def test_models_are_not_compared_on_logs_of_different_kinds(other):
    logs = {"sweep": recording(60), "complex": recording(110, **other)}
    with pytest.raises(LogError, match="|".join(other.values())):
        compare_models(logs, VALIDATION)


def test_tables_restart_features_at_each_recording(joined):
    logs = {"sweep": joined, "complex": recording(110, experiment="complex")}
    results, fitted = compare_models(logs, VALIDATION)
    reports = {(report["model"], report["trained_on"]): report for report in results["models"]}
    for name, model in fitted.items():
        report = reports[name, "sweep"]
        X, y, _ = joined.samples(name, MODELS)
        rows = np.repeat(np.arange(3), 50)  # three blocks
        trains = rows != report["best_fold"]
        error = (np.concatenate([model.predict(X[:60]), model.predict(X[60:])]) - y)[trains]
        expected = np.sqrt(np.mean(error**2))
        assert report["train_rmse_kpa"][report["best_fold"]] == pytest.approx(expected, abs=1e-9)


@pytest.mark.parametrize("folds", [1, None])
def test_grids_agree_cell_by_cell_on_several_recordings(joined, folds):
    logs = {"sweep": joined, "complex": joined}
    values = {"epsilon": [0.1], "n_c": [1, 2], "n_y": [1, 3], "n_u": [2]}
    grids = evaluate_grids(logs, values, VALIDATION, folds=folds)
    assert {name: len(cells) for name, cells in grids.items()} == {
        "epsilon": 1,
        "n_c": 4,
        "taps": 2,
    }
    for cell in sum(grids.values(), []):
        settings = {k: cell[k] for k in cell if k != "model" and not k.endswith("_kpa")}
        rows = VALIDATION.split_rows(joined)
        model, samples = build(cell["model"], MODELS, 1, **settings), joined.samples(cell["model"])
        alone = evaluate(model, rows, samples, samples)
        for phase in ("train_rmse_kpa", "validation_rmse_kpa"):
            assert cell[phase] == pytest.approx(alone[phase][:folds])
