import json
import os
from fractions import Fraction

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
    FeatureModel,
    FuzzyLinear,
    LowpassBank,
    PlayOperators,
    RidgeReadout,
    SequenceModel,
    SideBySide,
    TakagiSugenoReadout,
    TapFeatures,
    load_model,
    save_model,
)
from fprc.models.storage import sealed

BANK = SideBySide([(TapFeatures(), [0, 1]), (LowpassBank([0.5, 0.1]), [0])])
FUZZY = FPRC(n_c=3, random_state=1)


def on(features):
    return FeatureModel(features, RidgeReadout())


SEQUENCE_MODELS = [
    on(NVAR(n_taps=2, spacing=3)),
    FeatureModel(BANK, TakagiSugenoReadout(n_c=3), random_state=1),
    ESN(r=12, washout=20, random_state=1),
    FUZZY,
    FuzzyLinear(n_c=3, random_state=1),
    on(SideBySide([(BANK, [1, 0]), (PlayOperators(n_plays=2), [0])])),
]


@pytest.fixture
def path(tmp_path):
    return tmp_path / "model.h5"


@pytest.fixture
def saved(path):
    model = clone(FUZZY).fit(log(), pressure())
    save_model(model, path)
    return model


@pytest.mark.parametrize("model", SEQUENCE_MODELS, ids=lambda model: type(model).__name__)
def test_loaded_model_predicts_and_steps_identically(model, path):
    model.fit(log(), pressure())
    model.step(log()[7])  # a stream is no part of the file
    save_model(model, path)
    loaded = load_model(str(path))
    assert type(loaded) is type(model)
    lists = str.maketrans("()", "[]")  # JSON has no tuples
    assert str(loaded.get_params()).translate(lists) == str(model.get_params()).translate(lists)
    assert np.array_equal(loaded.predict(log()), model.predict(log()))
    model.reset()
    assert [loaded.step(x) for x in log()] == [model.step(x) for x in log()]


def test_model_trained_on_named_columns_knows_the_names_again(path):
    frame = pd.DataFrame(log(), columns=["theta_deg", "p_o_kpa"])
    model = clone(FUZZY).fit(frame, pressure())
    model.units_, model.sample_rate_hz_ = np.array(["kPa", "deg", "kPa"], dtype=object), 1.0 / 0.005
    save_model(model, path)
    loaded = load_model(path)
    assert list(loaded.feature_names_in_) == ["theta_deg", "p_o_kpa"]
    assert (list(loaded.units_), loaded.sample_rate_hz_) == (["kPa", "deg", "kPa"], 1.0 / 0.005)
    assert np.array_equal(loaded.predict(frame), model.predict(frame))


def test_same_model_gives_the_same_bytes(saved, path, tmp_path):
    save_model(saved, tmp_path / "again.h5")
    assert (tmp_path / "again.h5").read_bytes() == path.read_bytes()


def test_unfitted_model_is_refused(path):
    with pytest.raises(NotFittedError):
        save_model(FPRC(), path)


def spoiled(**values):
    model = clone(FUZZY).fit(log(), pressure())
    for key, value in values.items():
        setattr(model.readout_, key, value)
    return model


@pytest.mark.parametrize(
    ("build", "named"),
    [
        (lambda: TapFeatures().fit(log()), "TapFeatures"),
        (lambda: FeatureModel(TapFeatures(), Ridge()).fit(log(), pressure()), "Ridge"),
        (lambda: on(LowpassBank([Fraction(1, 2)])).fit(log(), pressure()), "Fraction"),
        (lambda: spoiled(W_out_=np.ones((3, 3))), r"W_out_: .*\(3, 3\)"),
        (lambda: spoiled(W_out_=np.full((3, 9), np.nan)), r"readout_\.W_out_: .*NaN"),
        (lambda: spoiled(more_=np.nan), "NaN|JSON"),
        (lambda: spoiled(more_=1.0), "more_"),
    ],
)
def test_refused_model_leaves_the_earlier_file_as_it_was(build, named, saved, path):
    before = path.read_bytes()
    with pytest.raises(FprcError, match=named):
        save_model(build(), path)
    assert path.read_bytes() == before


@pytest.mark.parametrize("content", [b"", b"hello", b"\x89HDF\r\n\x1a\n" + b"\0" * 200])
def test_file_that_is_no_model_is_named(content, path):
    path.write_bytes(content)
    with pytest.raises(FprcError, match=r"model\.h5: holds no model"):
        load_model(path)


def test_file_larger_than_any_model_is_not_read(path):
    path.touch()
    os.truncate(path, 10**12)
    with pytest.raises(FprcError, match="at most 150,000,000"):
        load_model(path)


def test_any_byte_that_changed_is_noticed(saved, path, damaged_bytes):
    data = path.read_bytes()
    for at in damaged_bytes(len(data)):
        path.write_bytes(data[:at] + bytes([data[at] ^ 1]) + data[at + 1 :])
        with pytest.raises(FprcError, match=r"model\.h5: "):
            load_model(path)


# --- a file whose checksum was renewed --------------------------------------------------------


def reseal(path):
    path.write_bytes(sealed(path.read_bytes()[512:]))


def put(*keys, value):
    """Return a change of the value at some keys of the text."""

    def change(text):
        inner = text
        for key in keys[:-1]:
            inner = inner[key]
        inner[keys[-1]] = value

    return change


def features(name, value):
    """Return a change of a parameter of the map."""
    return put("learned", "features_", "parameters", name, value=value)


def fprc_of_other_parts(text):
    """Call a model of any other parts an FPRC."""
    text["class"], text["parameters"] = "FPRC", FPRC().get_params()


def of_other_maps(text):
    """Put a map in the place of another one of a SideBySide, which is fitted."""
    maps = text["learned"]["features_"]["learned"]["maps_"]
    maps[0] = maps[1]


readout = ("learned", "readout_")
#: Model, change of its text, and what the message names.
TEXTS = {
    "no text": (FUZZY, lambda text: [1], "list"),
    "no model": (FUZZY, lambda text: text["learned"]["readout_"], "Readout is no model"),
    "no part": (FUZZY, lambda text: text["learned"].pop("features_") and None, "features_"),
    "other part": (FUZZY, put("learned", "features_", value=3), "features_"),
    "of an earlier version": (FUZZY, lambda text: text.pop("learned") and None, "dict"),
    "no class": (FUZZY, put("class", value={}), ""),
    "unknown class": (FUZZY, put("class", value="FPCR"), "class 'FPCR' is unknown"),
    "other class": (FUZZY, put("class", value="FuzzyLinear"), "epsilon"),
    "parameter": (FUZZY, put("parameters", "n_layers", value=3), "n_layers"),
    "no sigma": (FUZZY, lambda text: text["parameters"].pop("sigma") and None, "sigma is missing"),
    "sigma of no part": (FUZZY, put("parameters", "sigma", value=-1.0), "sigma = -1"),
    "seed": (FUZZY, put("parameters", "random_state", value="a"), "random_state = 'a'"),
    "parts of an ESN": (ESN(r=4, random_state=1), fprc_of_other_parts, "FPRC: its parts"),
    "several maps": (on(BANK), fprc_of_other_parts, "FPRC: its parts"),
    "other maps": (on(BANK), of_other_maps, "SideBySide: its parts"),
    "more taps": (FUZZY, features("n_y", 4), "its parts"),
    "unknown name": (FUZZY, put("learned", "more_", value=["a"]), "more_"),
    "no name": (FUZZY, put("learned", "fit", value=["a"]), "fit"),
    "units": (FUZZY, put("learned", "units_", value={"words": ["kPa", "deg"]}), "units_"),
    "rate": (FUZZY, put("learned", "sample_rate_hz_", value=0.0), "sample_rate_hz_"),
    "names": (FUZZY, put("learned", "feature_names_in_", value={"words": ["a"]}), "feature_names"),
    "columns": (FUZZY, put("learned", "n_features_in_", value=10**9), "n_features_in_"),
    "columns of a part": (FUZZY, put(*readout, "learned", "n_features_in_", value=5), "centers_"),
    "another array": (FUZZY, put(*readout, "learned", "W_out_", "array", value="x"), "x"),
    "no array": (FUZZY, put(*readout, "learned", "W_out_", value=[[1.0]]), "W_out_"),
    **{
        f"{name} = {value}": (FUZZY, put(*readout, "parameters", name, value=value), f"{name} = ")
        for name, value in (("n_c", 10**9), ("n_c", "3"), ("sigma", True), ("alpha", -1.0))
    },
    "rules": (FUZZY, put(*readout, "parameters", "n_c", value=4), "centers_"),
    "column of a map": (on(BANK), lambda text: first_map(text).__setitem__(1, [7]), "SideBySide"),
    "fewer columns": (on(BANK), lambda text: first_map(text).__setitem__(1, [0]), "readout"),
    "columns of a map": (on(BANK), lambda text: first_map(text).__setitem__(1, [1, 0]), "parts"),
    "no map": (on(BANK), features("maps", [7]), ""),
    "no maps": (on(BANK), features("maps", []), ""),
    "references": (on(TapFeatures()), features("n_references", 7), "n_references"),
    "40 MB": (FUZZY, put("learned", "units_", value=["k" * 40_000_000]), "too long a text"),
    "factors": (on(LowpassBank()), features("epsilons", "0.1"), "epsilons"),
    "features": (on(TapFeatures()), features("n_y", 10_000), "parts"),
}  # fmt: skip


def first_map(text):
    return text["learned"]["features_"]["parameters"]["maps"][0]


@pytest.mark.parametrize(("model", "change", "named"), TEXTS.values(), ids=TEXTS)
def test_wrong_text_is_named(model, change, named, path):
    save_model(clone(model).fit(log(), pressure()), path)
    with h5py.File(path, "a") as file:
        text = json.loads(file["model"][()])
        text = change(text) or text
        del file["model"]
        file["model"] = np.bytes_(json.dumps(text).encode())
    reseal(path)
    with pytest.raises(FprcError, match=rf"model\.h5: .*{named}"):
        load_model(path)


#: What takes the place of an array: other numbers, or numbers that do not lie in the file.
ARRAYS = {
    "fewer rules": lambda file, name, x: file.__setitem__(name, x[:2]),
    "no axis": lambda file, name, x: file.__setitem__(name, 1.0),
    "big-endian": lambda file, name, x: file.__setitem__(name, x.astype(">f8")),
    "text": lambda file, name, x: file.__setitem__(name, x.astype("S8")),
    "infinity": lambda file, name, x: file.__setitem__(name, x + np.inf),
    "huge": lambda file, name, x: file.__setitem__(name, x * 1e200),
    "gone": lambda file, name, x: None,
    "soft link": lambda file, name, x: file.__setitem__(name, h5py.SoftLink("/model")),
    "link": lambda file, name, x: file.__setitem__(name, h5py.ExternalLink("o.h5", "/x")),
    "link to a pipe": lambda file, name, x: file.__setitem__(name, h5py.ExternalLink("pipe", "x")),
    "in another file": lambda file, name, x: put_outside(file, name, x, "raw.bin"),
    "in a pipe": lambda file, name, x: put_outside(file, name, x, "pipe"),
    "virtual": lambda file, name, x: file.create_virtual_dataset(name, of_another_file(x)),
    "compressed": lambda file, name, x: file.create_dataset(name, data=x, compression="gzip"),
    "chunk of 1 GB": lambda file, name, x: file.create_dataset(
        name, x.shape, "f8", maxshape=(None, None), chunks=(12_000, 12_000), compression="gzip"
    ),
    "words on a heap": lambda file, name, x: file.create_dataset(name, data=["a"] * x.size),
    "promised": lambda file, name, x: file.create_dataset(name, (10**6, 10**6), "f8"),
}


def put_outside(file, name, x, where):
    x.tofile("raw.bin")
    file.create_dataset(name, x.shape, "f8", external=[(where, 0, x.nbytes)])


def of_another_file(x):
    layout = h5py.VirtualLayout(x.shape, "f8")
    layout[:] = h5py.VirtualSource("other.h5", "x", shape=x.shape)
    return layout


@pytest.mark.parametrize("change", ARRAYS.values(), ids=ARRAYS)
def test_wrong_array_is_refused(change, saved, path, monkeypatch):
    monkeypatch.chdir(path.parent)
    os.mkfifo("pipe")
    name = "readout_.W_out_"
    with h5py.File(path, "a") as file:
        values = file[name][()]
        del file[name]
        change(file, name, values)
    reseal(path)
    with pytest.raises(FprcError, match=r"model\.h5: "):
        load_model(path)


@pytest.mark.parametrize(
    ("model", "name", "value"),
    [
        (FUZZY, "readout_.centers_", 1e12),
        (on(NVAR(n_taps=2)), "features_.scale_", 5e-324),
        (on(NVAR(n_taps=2)), "features_.mean_", 1e30),
        (on(PlayOperators(n_plays=3)), "features_.half_widths_", -1.0),
        (ESN(r=4, random_state=1), "features_.W_r_", 1e100),
    ],
)
def test_number_outside_its_limits_is_named(model, name, value, path):
    save_model(clone(model).fit(log(), pressure()), path)
    with h5py.File(path, "a") as file:
        file[name][...] = value
    reseal(path)
    with pytest.raises(FprcError, match=rf"model\.h5: .* {name.partition('.')[2]}: "):
        load_model(path)


# --- models from outside the package ------------------------------------------------------------


class Doubled(TapFeatures):
    """A map with twice the features, which it does not declare."""

    def map_recording(self, X):
        return np.repeat(super().map_recording(X), 2, axis=1)

    def map_sample(self, x):
        return np.repeat(super().map_sample(x), 2)


class Outside(SequenceModel):
    """A model that learns what no class of this package does."""

    def make_features(self):
        return Doubled()

    def make_readout(self):
        return TakagiSugenoReadout(n_c=3, random_state=1)

    def fit(self, X, y):
        super().fit(X, y)
        self.offset_, self.names_ = 0.5, ["a", "b"]
        self.table_ = np.arange(6).reshape(2, 3)
        self.inner_ = [RidgeReadout().fit(X, y)]
        return self


def test_model_from_outside_is_loaded_with_what_it_learned(path):
    outside = Outside().fit(log(), pressure())
    save_model(outside, path, [Outside])
    loaded = load_model(path, [Outside])
    assert type(loaded) is Outside
    assert np.array_equal(loaded.predict(log()), outside.predict(log()))
    assert [loaded.step(x) for x in log()] == [outside.step(x) for x in log()]
    assert (loaded.offset_, loaded.names_) == (0.5, ["a", "b"])
    assert loaded.table_.tolist() == [[0, 1, 2], [3, 4, 5]]
    assert np.array_equal(loaded.inner_[0].w_out_, outside.inner_[0].w_out_)
    with pytest.raises(FprcError, match="class 'Doubled' is unknown"):
        load_model(path)
    outside.inner_[0].w_out_ = np.ones(7)  # a part of this package is checked
    with pytest.raises(FprcError, match="w_out_"):
        save_model(outside, path, [Outside])


def log():
    time = np.arange(120) / 10.0
    return np.column_stack([20.0 + 15.0 * np.sin(time), 100.0 + 5.0 * np.sin(time - 0.5)])


def pressure():
    return 175.0 + 120.0 * np.sin(np.arange(120) / 10.0 + 0.2)
