from types import SimpleNamespace

import numpy as np
import pytest
from numpy.testing import assert_allclose

from fprc.evaluation import time_models, timing
from fprc.models import RidgeReadout, SequenceModel, TapFeatures


class Clock:
    """A clock that moves on by itself at every look, and when a test says so."""

    def __init__(self):
        self.now = 0.0

    def perf_counter(self):
        self.now += 1.0
        return self.now


@pytest.fixture
def clock(monkeypatch):
    clock = Clock()
    monkeypatch.setattr(timing, "time", SimpleNamespace(perf_counter=clock.perf_counter))
    return clock


class Features(TapFeatures):
    calls = []
    stepped = []

    def transform(self, X):
        self.calls.append(f"transform {len(X)}")
        return super().transform(X)

    def advance(self, x):
        self.calls.append("step")
        row = super().advance(x)
        self.stepped.append(row.copy())
        return row


class Readout(RidgeReadout):
    trained = []

    def fit(self, X, y):
        Features.calls.append("fit")
        self.trained.append(X)
        return super().fit(X, y)


class Model(SequenceModel):
    def make_features(self):
        return Features(n_y=2, n_u=2)

    def make_readout(self):
        return Readout()


def fitted():
    return Model().fit(*log(20))


def time_model(model, train, test, repeats, **more):
    return time_models({"it": (model, train, test)}, repeats, **more)["it"]


@pytest.fixture(autouse=True)
def forget():
    Features.calls.clear()
    Features.stepped.clear()
    Readout.trained.clear()


def test_sequential_work_goes_sample_by_sample_and_batch_work_at_once(monkeypatch):
    monkeypatch.setattr(timing, "WARM_UP", 8)
    calls = {}

    def heard(text, phase, mode, repeats):
        calls[f"{phase}, {mode}"] = len(Features.calls)

    monkeypatch.setattr(timing.log, "info", heard)
    time_model(fitted(), log(20), log(10), repeats=2)
    starts = [*calls.values(), len(Features.calls)]
    work = [Features.calls[a:b] for a, b in zip(starts, starts[1:], strict=False)]
    assert list(calls) == [
        "train, sequential", "train, batch", "test, sequential", "test, batch"
    ]  # fmt: skip
    assert work == [
        [*["step"] * 8, "fit", *["step"] * 20, "fit"] * 2,
        ["transform 8", "fit", "transform 20", "fit"] * 2,
        ["step"] * (8 + 10) * 2,
        ["transform 8", "transform 10"] * 2,
    ]


def test_every_repeat_begins_the_log_anew_and_leaves_the_model_as_it_is_fitted():
    model, train, test = fitted(), log(20), log(10)
    before = model.readout_.w_out_.copy()
    time_model(model, train, test, repeats=2)
    whole, *trained = Readout.trained
    assert len(trained) == 2 * 2 * 2
    for rows in trained:
        assert_allclose(rows, whole, rtol=1e-12)
    whole = Features(n_y=2, n_u=2).fit(train[0]).transform(test[0])
    assert_allclose(Features.stepped[-20:], np.vstack([whole, whole]), rtol=1e-12)
    np.testing.assert_array_equal(model.readout_.w_out_, before)


def test_models_take_turns_and_keep_their_own_times(clock, monkeypatch):
    monkeypatch.setattr(timing, "WARM_UP", 5)
    turns = []

    def predict(self, X):
        turns.append((self.slowness, len(X)))
        clock.now += self.slowness
        return np.zeros(len(X))

    def step(self, x):
        clock.now += 7.0
        return 0.0

    monkeypatch.setattr(Model, "predict", predict)
    monkeypatch.setattr(Model, "step", step)
    models = {}
    for name, slowness, samples in (("a", 10.0, 8), (("b", 2), 20.0, 9)):
        model = fitted()
        model.slowness = slowness
        models[name] = (model, log(20), log(samples))
    found = time_models(models, repeats=2)
    assert turns == [(10.0, 5), (10.0, 8), (20.0, 5), (20.0, 9)] * 2
    assert list(found) == ["a", ("b", 2)]
    tests = [
        (entry["mode"], entry["samples"], entry["seconds"])
        for entries in found.values()
        for entry in entries
        if entry["phase"] == "test"
    ]
    assert tests == [
        ("sequential", 8, [57.0] * 2), ("batch", 8, [11.0] * 2),
        ("sequential", 9, [64.0] * 2), ("batch", 9, [21.0] * 2),
    ]  # fmt: skip


def log(size):
    time = np.arange(size) / 10.0
    X = np.column_stack([20.0 + 15.0 * np.sin(time), 100.0 + 5.0 * np.sin(time - 0.5)])
    return X, 175.0 + 120.0 * np.sin(time + 0.2)
