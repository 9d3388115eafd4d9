import numpy as np
import pytest
from numpy.testing import assert_allclose
from sklearn.utils import check_random_state

from fprc.models import RidgeReadout, TakagiSugenoReadout


@pytest.fixture
def regimes():
    """Two straight lines, each on a stretch of its own."""
    x = np.concatenate([np.linspace(-1.0, 1.0, 60), np.linspace(99.0, 101.0, 60)])
    return x[:, None], np.where(x < 50.0, 2.0 + 3.0 * x, 500.0 - 4.0 * x)


def test_one_rule_is_the_plain_ridge(rows):
    X, y = rows
    one = TakagiSugenoReadout(n_c=1).fit(X, y)
    assert_allclose(one.W_out_[0], RidgeReadout().fit(X, y).w_out_, rtol=1e-9)
    assert_allclose(one.predict(X), RidgeReadout().fit(X, y).predict(X), rtol=1e-9)


def test_each_rule_learns_the_line_of_its_own_cluster(regimes):
    X, y = regimes
    readout = TakagiSugenoReadout(n_c=2, alpha=1e-9, random_state=0).fit(X, y)
    low, high = np.argsort(readout.centers_[:, 0])
    assert_allclose(readout.centers_[[low, high], 0], [0.0, 100.0], atol=0.1)
    assert_allclose(readout.W_out_[low], [2.0, 3.0], atol=0.1)
    assert_allclose(readout.predict(X), y, atol=0.1)


def test_far_sample_gets_the_line_of_the_nearest_rule(regimes):
    X, y = regimes
    readout = TakagiSugenoReadout(n_c=2, random_state=0).fit(X, y)
    bias, slope = readout.W_out_[readout.centers_[:, 0].argmax()]
    assert_allclose(readout.predict([[1e6]]), [bias + slope * 1e6], rtol=1e-12)
    assert readout.output(np.array([1e6])) == pytest.approx(bias + slope * 1e6, rel=1e-12)


def test_seeded_training_leaves_the_global_generator_alone(rows):
    before = check_random_state(None).get_state()[1].copy()
    TakagiSugenoReadout(n_c=4, random_state=3).fit(*rows)
    assert np.array_equal(check_random_state(None).get_state()[1], before)


@pytest.fixture
def rows():
    rng = np.random.default_rng(1)
    X = rng.normal(scale=3.0, size=(80, 3))
    return X, X @ [1.0, -2.0, 0.5] + np.abs(X[:, 0]) + rng.normal(size=80)
