from itertools import count
from types import SimpleNamespace

import numpy as np
import pytest

from fprc.evaluation import time_models, timing
from fprc.evaluation.timing import multiplications
from fprc.models import (
    ESN,
    FPRC,
    NVAR,
    FeatureModel,
    FuzzyLinear,
    RidgeReadout,
    fcm,
)


def log(size):
    time = np.arange(size) / 10.0
    X = np.column_stack([20.0 + 15.0 * np.sin(time), 100.0 + 5.0 * np.sin(time - 0.5)])
    return X, 175.0 + 120.0 * np.sin(time + 0.2)


def test_steps_are_timed_on_an_excerpt_and_all_else_on_whole_logs_in_every_second_turn(monkeypatch):
    """On a clock that moves on by a second whenever it is read."""
    clock = SimpleNamespace(perf_counter=map(float, count()).__next__)
    monkeypatch.setattr(timing, "time", clock)
    monkeypatch.setattr(timing, "WARM_UP", 8)
    monkeypatch.setattr(timing, "EXCERPT", 10)
    model = FPRC(n_c=2, random_state=1).fit(*log(40))
    models = {name: (model, log(40), log(30)) for name in ("a", ("b", 2))}
    found = time_models(models, repeats=3)
    assert list(found) == ["a", ("b", 2)]
    for entries in found.values():
        taken = {(e["phase"], e["mode"]): (e["samples"], e["seconds"]) for e in entries}
        assert taken == {
            ("train", "sequential"): (40, [pytest.approx(4.0 + 1.0)] * 2),  # steps, and the fit
            ("train", "batch"): (40, [1.0 + 1.0] * 2),
            ("test", "sequential"): (30, [pytest.approx(3.0)] * 3),
            ("test", "batch"): (30, [1.0] * 2),
        }
    only_batch = time_models({"a": models["a"]}, 1, sequential=False)
    assert {entry["mode"] for entry in only_batch["a"]} == {"batch"}


class Counted(float):
    """A number that counts the multiplications that it is part of."""

    made = 0

    def __mul__(self, other):
        Counted.made += 1
        return Counted(float(self) * float(other))

    def __add__(self, other):
        return Counted(float(self) + float(other))

    def __sub__(self, other):
        return Counted(float(self) - float(other))

    __rmul__, __radd__ = __mul__, __add__


def counted(values):
    return np.vectorize(Counted, otypes=[object])(values)


@pytest.fixture
def samples():
    Counted.made = 0
    rng = np.random.default_rng(0)
    return rng.normal(size=(600, 2)), rng.normal(size=600)


def test_step_of_the_network_multiplies_as_often_as_its_equations(samples):
    X, y = samples[0][:, :1], samples[1]
    model = ESN(r=7, n_y=3, random_state=0).fit(X, y)
    w_in, W_r = model.features_.w_in_, model.features_.W_r_
    x, theta = counted(np.ones(7)), counted(X[:3, 0])
    target = counted(np.tanh((w_in @ theta[:1] + W_r @ x).astype(float)))
    moved = x * model.gamma + target * (1.0 - model.gamma)
    np.concatenate([theta, moved]) @ model.readout_.w_out_[1:]
    assert multiplications(model, "test", 1) == Counted.made


def test_step_of_the_rules_multiplies_as_often_as_their_equations(samples):
    readout = (model := FPRC(n_c=3, random_state=0).fit(*samples)).readout_
    row = counted(np.ones(readout.n_features_in_))
    away = row - readout.centers_
    exponents = (away * away).sum(axis=1) * -0.125
    rules = readout.W_out_[:, 1:] @ row + readout.W_out_[:, 0]
    (np.exp(exponents.astype(float)) * rules).sum()
    exponentials, quotient, low_pass = 3, 1, 1
    assert multiplications(model, "test", 1) == Counted.made + exponentials + quotient + low_pass


@pytest.mark.parametrize("model", [FPRC(n_c=4, random_state=1), FuzzyLinear(n_c=4, random_state=1)])
def test_training_counts_the_iterations_that_the_clustering_took(samples, monkeypatch, model):
    rows, alternate = [], fcm.alternate

    def noted(columns, *rest):
        rows.append(columns.shape[1])
        return alternate(columns, *rest)

    monkeypatch.setattr(fcm, "alternate", noted)
    model.fit(samples[0][:, : 2 if isinstance(model, FPRC) else 1], samples[1])
    assert min(rows) == 60
    assert max(rows) == 600
    size, mapped = model.readout_.n_features_in_, int(isinstance(model, FPRC))
    iterations = sum(rows) * 4 * (2 * size + 3)
    # of each rule: the weighted rows, half of the symmetric products, those with y, the solution
    rule = 600 * (1 + size) * (1 + (2 + size) / 2 + 1) + (1 + size) ** 3 // 6
    assert multiplications(model, "train", 600) == 600 * mapped + iterations + 4 * rule


def test_ridge_counts_half_of_the_symmetric_products(samples):
    model = ESN(r=50, n_y=1, random_state=0).fit(samples[0][:, :1], samples[1])
    states = multiplications(model, "test", 1000) - 1000 * 51
    fit = multiplications(model, "train", 1000) - states
    assert fit == 1000 * (52 * 53 // 2 + 52) + 52**3 // 6


def test_other_features_have_no_count(samples):
    model = FeatureModel(NVAR(), RidgeReadout()).fit(*samples)
    assert multiplications(model, "test", 60) is None
