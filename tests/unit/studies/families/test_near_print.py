"""The distribution to which a linear rig with normal errors is moved is known in closed form."""

import numpy as np
import pytest

from fprc.errors import EvaluationError
from fprc.studies.families.near_print import assimilate, move_near

SLOPES = np.array([[1.0, 0.5, 0.0], [-0.5, 1.0, 0.3]])
TARGET = np.array([1.5, -0.7])
TOLERANCE = 0.3


def linear(points):
    return list(points @ SLOPES.T)


def closed_form():
    precision = np.eye(3) + SLOPES.T @ SLOPES / TOLERANCE**2
    covariance = np.linalg.inv(precision)
    return covariance @ SLOPES.T @ TARGET / TOLERANCE**2, covariance


def prior(number, seed=0):
    return np.random.default_rng(seed).standard_normal((number, 3))


def test_assimilations_of_a_linear_rig_give_the_closed_form():
    points, rng = prior(20000), np.random.default_rng(1)
    for _ in range(4):
        points = assimilate(points, np.array(linear(points)), TARGET, TOLERANCE, 4, rng)
    mean, covariance = closed_form()
    assert points.mean(axis=0) == pytest.approx(mean, abs=0.02)
    assert np.cov(points.T) == pytest.approx(covariance, abs=0.02)


@pytest.mark.slow
def test_sweeps_alone_reach_the_closed_form_and_leave_the_impossible():
    """Without an assimilation, from the prior; one half of the space is impossible."""

    def half(points):
        return [
            None if point[2] < 0 else own for point, own in zip(points, linear(points), strict=True)
        ]

    points = move_near(
        prior(600), half, TARGET, tolerance=TOLERANCE, assimilations=0, sweeps=400, seed=2
    )
    assert (points[:, 2] >= 0).all()
    # by importance: draws of the closed form that are possible
    mean, covariance = closed_form()
    exact = np.random.default_rng(3).multivariate_normal(mean, covariance, 200000)
    exact = exact[exact[:, 2] >= 0]
    assert points.mean(axis=0) == pytest.approx(exact.mean(axis=0), abs=0.12)
    assert points.std(axis=0) == pytest.approx(exact.std(axis=0), abs=0.1)


def test_no_possible_rig_is_an_error():
    with pytest.raises(EvaluationError, match=r"near_print\.rigs"):
        move_near(
            prior(5), lambda points: [None] * len(points), TARGET,
            tolerance=1.0, assimilations=1, sweeps=1, seed=0,
        )  # fmt: skip
