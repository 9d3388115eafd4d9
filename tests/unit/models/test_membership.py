import numpy as np
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays
from numpy.testing import assert_allclose

from fprc.models.takagi_sugeno import gaussian_memberships


def points(limit):
    return st.integers(1, 6).flatmap(
        lambda size: arrays(float, (size, 8), elements=st.floats(-limit, limit))
    )


@given(points(1e8), points(1e8), st.floats(0.1, 10.0))
def test_memberships_are_finite_and_sum_to_one_anywhere(X, centers, sigma):
    beta = gaussian_memberships(X, centers, sigma)
    assert beta.shape == (len(X), len(centers))
    assert np.all(np.isfinite(beta))
    assert np.all(beta >= 0.0)
    assert_allclose(beta.sum(axis=1), 1.0, rtol=1e-12)
