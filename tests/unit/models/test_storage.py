import json
import os

import h5py
import numpy as np
import pandas as pd
import pytest
from sklearn.base import clone
from sklearn.exceptions import NotFittedError
from sklearn.linear_model import Ridge

from fprc.errors import FprcError
from fprc.models import (
    ESN,
    FPRC,
    NVAR,
    EchoStates,
    FeatureModel,
    FuzzyLinear,
    LowpassBank,
    PlayOperators,
    RidgeReadout,
    SideBySide,
    TakagiSugenoReadout,
    TapFeatures,
    load_model,
    save_model,
)

BANK = SideBySide([("taps", TapFeatures(), None), ("bank", LowpassBank([0.5, 0.1]), [0])])
SEQUENCE_MODELS = [
    FeatureModel(NVAR(n_taps=2, spacing=3), RidgeReadout(0.1)),
    FeatureModel(BANK, TakagiSugenoReadout(n_c=3), random_state=1),
    ESN(r=12, washout=20, random_state=1),
    FPRC(n_c=3, random_state=1),
    FuzzyLinear(n_c=3, random_state=1),
]
FEATURE_MAPS = [
    TapFeatures(n_u=2),
    EchoStates(r=12, random_state=1),
    NVAR(n_taps=2, spacing=3),
    LowpassBank([0.5, 0.1]),
    PlayOperators(n_plays=3),
    SideBySide([("inner", BANK, [1, 0]), ("plays", PlayOperators(n_plays=2), [0])]),
]
READOUTS = [RidgeReadout(alpha=0.5), TakagiSugenoReadout(n_c=3, random_state=1)]


def named(estimator):
    return type(estimator).__name__


@pytest.fixture
def path(tmp_path):
    return tmp_path / "model.h5"


@pytest.fixture
def saved(path):
    model = FPRC(n_c=3, random_state=1).fit(log(), pressure())
    save_model(model, path)
    return model


@pytest.mark.parametrize("model", SEQUENCE_MODELS, ids=named)
def test_loaded_model_predicts_and_steps_identically(model, path):
    model.fit(log(), pressure())
    save_model(model, path)
    loaded = load_model(path)
    assert type(loaded) is type(model)
    lists = str.maketrans("()", "[]")  # JSON has no tuples
    assert str(loaded.get_params()).translate(lists) == str(model.get_params()).translate(lists)
    assert np.array_equal(loaded.predict(log()), model.predict(log()))
    model.reset()
    assert [loaded.step(x) for x in log()] == [model.step(x) for x in log()]


@pytest.mark.parametrize("features", FEATURE_MAPS, ids=named)
def test_loaded_features_transform_and_step_identically(features, path):
    features.fit(log())
    save_model(features, path)
    loaded = load_model(str(path))
    assert np.array_equal(loaded.transform(log()), features.transform(log()))
    assert np.array_equal([loaded.step(x) for x in log()], [features.step(x) for x in log()])


@pytest.mark.parametrize("readout", READOUTS, ids=named)
def test_loaded_readout_predicts_identically(readout, path):
    readout.fit(log(), pressure())
    save_model(readout, path)
    loaded = load_model(path)
    assert np.array_equal(loaded.predict(log()), readout.predict(log()))
    assert loaded.output(log()[3]) == readout.output(log()[3])


def test_loaded_model_starts_a_new_stream(path):
    model = ESN(r=12, random_state=1).fit(log(), pressure())
    for x in log()[:10]:
        model.step(x)
    save_model(model, path)
    loaded = load_model(path)
    first = [loaded.step(x) for x in log()]
    np.testing.assert_allclose(first, loaded.predict(log()), rtol=0, atol=1e-9)


def test_loaded_model_still_checks_the_number_of_columns(saved, path):
    with pytest.raises(ValueError, match="3 features.*expecting 2"):
        load_model(path).predict(np.ones((20, 3)))


def test_model_without_a_seed_keeps_its_weights(path):
    model = ESN(r=12).fit(log(), pressure())
    save_model(model, path)
    loaded = load_model(path)
    assert loaded.random_state is None
    assert np.array_equal(loaded.predict(log()), model.predict(log()))


def test_model_trained_on_named_columns_knows_the_names_again(path):
    frame = pd.DataFrame(log(), columns=["theta_deg", "p_o_kpa"])
    model = FPRC(n_c=3, random_state=1).fit(frame, pressure())
    save_model(model, path)
    loaded = load_model(path)
    assert list(loaded.feature_names_in_) == ["theta_deg", "p_o_kpa"]
    assert np.array_equal(loaded.predict(frame), model.predict(frame))


def test_same_model_gives_the_same_bytes(saved, path, tmp_path):
    save_model(saved, tmp_path / "again.h5")
    assert (tmp_path / "again.h5").read_bytes() == path.read_bytes()


def test_numpy_seed_is_a_number_too(path):
    model = FPRC(n_c=3, random_state=np.int64(1)).fit(log(), pressure())
    save_model(model, path)
    assert load_model(path).random_state == 1


def test_random_state_that_is_no_number_is_refused_with_a_remedy(path):
    model = FPRC(n_c=3, random_state=np.random.RandomState(1)).fit(log(), pressure())
    with pytest.raises(FprcError, match=r"RandomState.*give random_state a number"):
        save_model(model, path)


def test_wrapped_regressor_of_scikit_learn_is_refused(path):
    model = FeatureModel(TapFeatures(), Ridge()).fit(log(), pressure())
    with pytest.raises(FprcError, match="Ridge is not a model of fprc"):
        save_model(model, path)
    assert not path.exists()


def test_foreign_class_is_refused_with_those_that_are_known(path):
    with pytest.raises(FprcError, match="Ridge is not a model of fprc.*FPRC"):
        save_model(Ridge().fit(log(), pressure()), path)


@pytest.mark.parametrize("model", SEQUENCE_MODELS + READOUTS, ids=named)
def test_unfitted_model_is_refused(model, path):
    with pytest.raises((FprcError, NotFittedError), match="not fitted|fit"):
        save_model(clone(model), path)


@pytest.mark.parametrize(
    "model",
    [Ridge(), FPRC(n_c=3, random_state=np.random.RandomState(1))],
    ids=["foreign class", "random_state"],
)
def test_refused_model_leaves_the_earlier_file_as_it_was(model, saved, path):
    before = path.read_bytes()
    model.fit(log(), pressure())
    with pytest.raises(FprcError):
        save_model(model, path)
    assert path.read_bytes() == before


def test_missing_file_is_named(path):
    with pytest.raises(FprcError, match=r"model\.h5"):
        load_model(path)


@pytest.mark.parametrize("content", [b"", b"hello", b"\x89HDF\r\n\x1a\n" + b"\0" * 200])
def test_file_that_is_no_hdf5_is_named(content, path):
    path.write_bytes(content)
    with pytest.raises(FprcError, match=r"model\.h5: holds no model"):
        load_model(path)


@pytest.mark.parametrize("share", [0.01, 0.1, 0.5, 0.99])
def test_file_that_is_cut_short_is_named(share, saved, path):
    os.truncate(path, int(share * path.stat().st_size))
    with pytest.raises(FprcError, match=r"model\.h5: holds no model"):
        load_model(path)


def test_hdf5_file_without_a_model_is_named(path):
    with h5py.File(path, "w") as file:
        file.create_dataset("theta_deg", data=np.arange(3.0))
    with pytest.raises(FprcError, match=r"model\.h5: holds no model.*train it again"):
        load_model(path)


def test_class_of_another_version_is_named(saved, path):
    with h5py.File(path, "a") as file:
        file.attrs["class"] = "NeuralNetwork"
    with pytest.raises(FprcError, match=r"model\.h5.*NeuralNetwork"):
        load_model(path)


def test_class_of_a_part_of_another_version_is_named(saved, path):
    with h5py.File(path, "a") as file:
        file["readout_"].attrs["class"] = "NeuralNetwork"
    with pytest.raises(FprcError, match=r"model\.h5.*NeuralNetwork"):
        load_model(path)


def test_parameter_of_another_version_is_named(saved, path):
    with h5py.File(path, "a") as file:
        parameters = json.loads(file.attrs["parameters"]) | {"n_layers": 3}
        file.attrs["parameters"] = json.dumps(parameters)
    with pytest.raises(FprcError, match=r"model\.h5.*n_layers"):
        load_model(path)


@pytest.mark.parametrize("part", ["readout_", "readout_/W_out_"])
def test_model_that_lacks_a_part_is_refused(part, saved, path):
    with h5py.File(path, "a") as file:
        del file[part]
    with pytest.raises(FprcError, match=r"model\.h5"):
        load_model(path)


def log():
    time = np.arange(120) / 10.0
    return np.column_stack([20.0 + 15.0 * np.sin(time), 100.0 + 5.0 * np.sin(time - 0.5)])


def pressure():
    return 175.0 + 120.0 * np.sin(np.arange(120) / 10.0 + 0.2)
