import numpy as np
import pytest

from fprc.studies.calibration.smoother import assimilate

MEMBERS, TURNS = 4000, 4


def smoothed(points, numbers_of, low, high, tolerance, seed=2):
    rng = np.random.default_rng(seed)
    for _ in range(TURNS):
        points = assimilate(points, numbers_of(points), *map(np.array, (low, high, tolerance)),
                            widened=TURNS, rng=rng)  # fmt: skip
    return points


def test_linear_numbers_give_the_posterior_of_the_closed_form():
    prior = np.random.default_rng(1).standard_normal((MEMBERS, 3))
    h = np.array([[1.0, 0.5, 0.0], [0.0, 1.0, -1.0]])
    observed, tolerance = np.array([0.8, -0.5]), np.array([0.3, 0.5])
    found = smoothed(prior, lambda x: x @ h.T, observed, observed, tolerance)
    precision = np.eye(3) + h.T @ np.diag(tolerance**-2) @ h
    covariance = np.linalg.inv(precision)
    mean = covariance @ h.T @ (observed / tolerance**2)
    assert found.mean(axis=0) == pytest.approx(mean, abs=0.06)
    np.testing.assert_allclose(np.cov(found.T), covariance, atol=0.06)


def test_nothing_moves_where_all_numbers_lie_within_their_ranges():
    prior = np.random.default_rng(1).standard_normal((50, 3))
    found = smoothed(prior, lambda x: np.tanh(x), [-9.0] * 3, [9.0] * 3, [0.1] * 3)
    np.testing.assert_array_equal(found, prior)


def test_members_outside_a_range_move_to_its_end_and_a_parameter_of_no_effect_stays():
    prior = np.random.default_rng(1).standard_normal((MEMBERS, 2))
    found = smoothed(prior, lambda x: x[:, :1], [1.0], [np.inf], [0.05])
    assert np.quantile(found[:, 0], 0.02) > 0.8
    assert found[:, 1].std() == pytest.approx(1.0, abs=0.05)


def test_one_absurd_number_does_not_move_the_ensemble():
    prior = np.random.default_rng(1).standard_normal((200, 2))

    def with_outlier(x):
        return np.where(np.arange(len(x))[:, None] == 0, 1e6, x)

    calm = smoothed(prior, lambda x: x, [0.5, 0.5], [0.5, 0.5], [0.2, 0.2])
    found = smoothed(prior, with_outlier, [0.5, 0.5], [0.5, 0.5], [0.2, 0.2])
    assert found[1:].mean(axis=0) == pytest.approx(calm[1:].mean(axis=0), abs=0.15)
