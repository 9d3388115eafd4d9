import numpy as np
import pytest
from numpy.testing import assert_allclose
from sklearn.utils import check_random_state

from fprc.models import TakagiSugenoReadout


@pytest.fixture
def regimes():
    """Two straight lines, each on a stretch of its own."""
    x = np.concatenate([np.linspace(-1.0, 1.0, 60), np.linspace(99.0, 101.0, 60)])
    return x[:, None], np.where(x < 50.0, 2.0 + 3.0 * x, 500.0 - 4.0 * x)


def test_far_sample_gets_the_line_of_the_nearest_rule(regimes):
    X, y = regimes
    readout = TakagiSugenoReadout(n_c=2, random_state=0).fit(X, y)
    bias, slope = readout.W_out_[readout.centers_[:, 0].argmax()]
    assert_allclose(readout.predict([[1e6]]), [bias + slope * 1e6], rtol=1e-12)
    assert readout.output(np.array([1e6])) == pytest.approx(bias + slope * 1e6, rel=1e-12)


def test_seeded_training_leaves_the_global_generator_alone(regimes):
    before = check_random_state(None).get_state()[1].copy()
    TakagiSugenoReadout(n_c=4, random_state=3).fit(*regimes)
    assert np.array_equal(check_random_state(None).get_state()[1], before)
