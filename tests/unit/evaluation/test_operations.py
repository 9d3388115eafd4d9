import numpy as np
import pytest

from fprc.evaluation.timing import multiplications
from fprc.models import ESN, FPRC, NVAR, FeatureModel, FuzzyLinear, RidgeReadout, fcm


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
def log():
    Counted.made = 0
    rng = np.random.default_rng(0)
    return rng.normal(size=(600, 2)), rng.normal(size=600)


def test_step_of_the_network_multiplies_as_often_as_its_equations(log):
    X, y = log[0][:, :1], log[1]
    model = ESN(r=7, n_y=3, random_state=0).fit(X, y)
    w_in, W_r = model.features_.w_in_, model.features_.W_r_
    x, theta = counted(np.ones(7)), counted(X[:3, 0])
    target = counted(np.tanh((w_in @ theta[:1] + W_r @ x).astype(float)))
    moved = x * model.gamma + target * (1.0 - model.gamma)
    np.concatenate([theta, moved]) @ model.readout_.w_out_[1:]
    assert multiplications(model, "test", 1) == Counted.made


def test_step_of_the_rules_multiplies_as_often_as_their_equations(log):
    readout = (model := FPRC(n_c=3, random_state=0).fit(*log)).readout_
    row = counted(np.ones(readout.n_features_in_))
    away = row - readout.centers_
    exponents = (away * away).sum(axis=1) * -0.125
    rules = readout.W_out_[:, 1:] @ row + readout.W_out_[:, 0]
    (np.exp(exponents.astype(float)) * rules).sum()
    exponentials, quotient, low_pass = 3, 1, 1
    assert multiplications(model, "test", 1) == Counted.made + exponentials + quotient + low_pass


@pytest.mark.parametrize("model", [FPRC(n_c=4, random_state=1), FuzzyLinear(n_c=4, random_state=1)])
def test_training_counts_the_iterations_that_the_clustering_took(log, monkeypatch, model):
    rows, alternate = [], fcm.alternate

    def noted(columns, *rest):
        rows.append(columns.shape[1])
        return alternate(columns, *rest)

    monkeypatch.setattr(fcm, "alternate", noted)
    model.fit(log[0][:, : 2 if isinstance(model, FPRC) else 1], log[1])
    assert min(rows) == 60
    assert max(rows) == 600
    size, mapped = model.readout_.n_features_in_, int(isinstance(model, FPRC))
    iterations = sum(rows) * 4 * (2 * size + 3)
    # of each rule: the weighted rows, half of the symmetric products, those with y, the solution
    rule = 600 * (1 + size) * (1 + (2 + size) / 2 + 1) + (1 + size) ** 3 // 6
    assert multiplications(model, "train", 600) == 600 * mapped + iterations + 4 * rule


def test_ridge_counts_half_of_the_symmetric_products(log):
    model = ESN(r=50, n_y=1, random_state=0).fit(log[0][:, :1], log[1])
    states = multiplications(model, "test", 1000) - 1000 * 51
    fit = multiplications(model, "train", 1000) - states
    assert fit == 1000 * (52 * 53 // 2 + 52) + 52**3 // 6


def test_other_features_have_no_count(log):
    model = FeatureModel(NVAR(), RidgeReadout()).fit(*log)
    assert multiplications(model, "test", 60) is None
