import numpy as np
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays
from numpy.testing import assert_allclose
from scipy.signal import lfilter

from fprc.models import LowpassBank

logs = st.integers(1, 40).flatmap(
    lambda size: arrays(float, (size, 2), elements=st.floats(-1e3, 1e3, allow_subnormal=False))
)
factors = st.lists(st.floats(1e-3, 1.0), min_size=1, max_size=4)


@given(logs, factors)
def test_bank_is_scipys_filter_of_each_column_with_each_factor(X, epsilons):
    features = LowpassBank(epsilons).fit(X)
    expected = [
        lfilter([epsilon], [1.0, epsilon - 1.0], column, zi=[(1.0 - epsilon) * column[0]])[0]
        for column in X.T
        for epsilon in epsilons
    ]
    assert_allclose(features.transform(X).T, expected, rtol=1e-9, atol=1e-9)
    assert_allclose([features.step(x) for x in X], np.transpose(expected), rtol=1e-9, atol=1e-9)


def test_steps_have_every_digit_of_the_whole_log():
    """A tree would tell the last digits apart."""
    X = np.cumsum(np.random.default_rng(0).normal(size=(200, 2)), axis=0)
    features = LowpassBank((0.03, 0.7)).fit(X)
    assert np.array_equal([features.step(x) for x in X], features.transform(X))
