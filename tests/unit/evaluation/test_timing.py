from types import SimpleNamespace

import numpy as np
import pytest

from fprc.evaluation import time_models, timing
from fprc.models import RidgeReadout, SequenceModel, TapFeatures

STEP, ROW, FIT, TRANSFORMED, TRAIN, TEST = 7.0, 3.0, 50.0, 2.0, 40, 30


class Clock:
    """A clock that moves on when a model works."""

    now = 0.0

    def perf_counter(self):
        return self.now

    def spend(self, seconds):
        self.now += seconds


@pytest.fixture
def clock(monkeypatch):
    clock = Clock()
    monkeypatch.setattr(timing, "time", SimpleNamespace(perf_counter=clock.perf_counter))
    monkeypatch.setattr(timing, "WARM_UP", 8)
    monkeypatch.setattr(timing, "EXCERPT", 10)
    return clock


def timed_model(clock, slowness):
    """Return a fitted model whose work takes a known time on the clock."""

    class Features(TapFeatures):
        def transform(self, X):
            clock.spend(slowness * TRANSFORMED * len(X))
            return super().transform(X)

        def step(self, x):
            clock.spend(slowness * ROW)
            return super().step(x)

    class Readout(RidgeReadout):
        def fit(self, X, y):
            clock.spend(slowness * FIT)
            return super().fit(X, y)

    class Model(SequenceModel):
        def make_features(self):
            return Features(n_y=2, n_u=2)

        def make_readout(self):
            return Readout()

        def predict(self, X):
            clock.spend(slowness * len(X))
            return super().predict(X)

        def step(self, x):
            clock.spend(slowness * STEP)
            return super().step(x)

    return Model().fit(*log(TRAIN))


def log(size):
    time = np.arange(size) / 10.0
    X = np.column_stack([20.0 + 15.0 * np.sin(time), 100.0 + 5.0 * np.sin(time - 0.5)])
    return X, 175.0 + 120.0 * np.sin(time + 0.2)


def test_steps_are_timed_on_an_excerpt_and_all_else_on_whole_logs_in_every_second_turn(clock):
    models = {
        name: (timed_model(clock, slowness), log(TRAIN), log(TEST))
        for name, slowness in (("a", 1.0), (("b", 2), 10.0))
    }
    found = time_models(models, repeats=3)
    assert list(found) == ["a", ("b", 2)]
    for entries, slowness in zip(found.values(), (1.0, 10.0), strict=True):
        expected = {
            ("train", "sequential"): (ROW * TRAIN + FIT, 2),
            ("train", "batch"): (TRANSFORMED * TRAIN + FIT, 2),
            ("test", "sequential"): (STEP * TEST, 3),
            ("test", "batch"): (TEST, 2),
        }
        for (phase, mode), (seconds, times) in expected.items():
            (entry,) = [e for e in entries if (e["phase"], e["mode"]) == (phase, mode)]
            assert entry["samples"] == {"train": TRAIN, "test": TEST}[phase]
            assert entry["seconds"] == pytest.approx([slowness * seconds] * times)


def test_without_sequential_mode_only_whole_logs_are_timed(clock):
    found = time_models(
        {"a": (timed_model(clock, 1.0), log(TRAIN), log(TEST))}, 1, sequential=False
    )
    assert {entry["mode"] for entry in found["a"]} == {"batch"}
