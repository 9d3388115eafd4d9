import numpy as np
import pytest

from fprc.control import PD


def test_first_sample_is_proportional_alone():
    assert PD(0.5, 0.005, 0.005).step(30.0, 20.0) == pytest.approx(5.0)


def test_derivative_is_the_backward_difference_of_the_error():
    rng = np.random.default_rng(1)
    theta_d, theta = rng.uniform(0.0, 60.0, (2, 50))
    pd = PD(3.0, 0.02, 0.01)
    found = [pd.step(*pair) for pair in zip(theta_d.tolist(), theta.tolist(), strict=True)]
    e = theta_d - theta
    np.testing.assert_allclose(found, 3.0 * e + 0.02 * np.diff(e, prepend=e[0]) / 0.01)


def test_constant_error_has_no_derivative():
    pd = PD(2.0, 100.0, 0.005)
    assert [pd.step(10.0, 7.0) for _ in range(3)] == pytest.approx([6.0, 6.0, 6.0])


def test_feedback_pushes_towards_the_reference():
    assert PD(1.0, 0.0, 0.005).step(10.0, 20.0) < 0.0 < PD(1.0, 0.0, 0.005).step(20.0, 10.0)
