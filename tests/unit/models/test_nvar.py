import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.testing import assert_allclose

from fprc.models import NVAR


@given(st.integers(1, 3), st.integers(1, 4), st.integers(2, 3), st.integers(1, 2), st.data())
def test_features_are_those_of_literal_loops(n_taps, spacing, degree, columns, data):
    seed = data.draw(st.integers(0, 99))
    X = np.random.default_rng(seed).normal(30.0, 17.0, (25, columns))
    z = (X - X.mean(axis=0)) / X.std(axis=0)
    expected = []
    for k in range(len(X)):
        linear = [z[max(k - j * spacing, 0), i] for i in range(columns) for j in range(n_taps)]
        products = []
        for a in range(len(linear)):
            for b in range(a, len(linear)):
                if degree == 2:
                    products.append(linear[a] * linear[b])
                else:
                    products += [linear[a] * linear[b] * linear[c] for c in range(b, len(linear))]
        expected.append(linear + products)
    features = NVAR(n_taps, spacing, degree).fit(X)
    assert_allclose(features.transform(X), expected, rtol=1e-10, atol=1e-12)
    assert_allclose([features.step(x) for x in X], expected, rtol=1e-10, atol=1e-12)


@pytest.mark.parametrize("value", [42.0, 5e-324, 101.3, 101325.3])
@pytest.mark.parametrize("size", [10, 24_000])
def test_column_that_is_constant_but_for_rounding_gives_zeros(value, size):
    """The rounding of its standard deviation grows with the value and the number of samples."""
    features = NVAR(2, 3).fit(value * (1.0 + 1e-15 * (np.arange(size) % 10))[:, None])
    assert features.scale_.tolist() == [1.0]
    assert_allclose(features.transform(np.full((10, 1), value)), 0.0, atol=1e-9)


def test_products_of_the_smallest_allowed_scale_are_finite():
    features = NVAR(2, 3, degree=10).fit(log())
    allowed = {name: array.each for name, array in features.learned()}
    features.mean_, features.scale_ = np.array([[allowed["mean_"].high], [allowed["scale_"].low]])
    with np.errstate(all="raise"):
        largest = np.abs(features.step([-1e9])).max()
        assert np.isfinite(largest * 1e30 * 1e5)


def test_log_shorter_than_the_taps_is_refused_with_both_numbers():
    with pytest.raises(ValueError, match="n_samples = 10 is less than the 11 .*longer log"):
        NVAR(n_taps=3, spacing=5).fit(log()).transform(log()[:10])


def log():
    time = np.arange(60) / 3.0
    return (35.0 + 20.0 * np.sin(time) + 5.0 * np.cos(2.3 * time))[:, None]
