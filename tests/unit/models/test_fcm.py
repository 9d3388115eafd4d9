import warnings

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays
from numpy.testing import assert_allclose
from scipy.spatial.distance import cdist
from skfuzzy import cmeans
from sklearn.cluster import kmeans_plusplus
from sklearn.exceptions import ConvergenceWarning

from fprc.models.fcm import fuzzy_c_means
from fprc.models.kernels import BLOCK, alternate

seeds = st.integers(0, 2**32 - 1)


@st.composite
def samples(draw):
    shape = draw(st.integers(5, 30)), draw(st.integers(1, 3))
    numbers = st.floats(-1e3, 1e3, allow_subnormal=False)
    return draw(arrays(float, shape, elements=numbers))


def unsettled(X, n_clusters, **options):
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", ConvergenceWarning)
        return fuzzy_c_means(X, n_clusters, **options)


@given(samples(), st.integers(1, 4), seeds)
def test_more_iterations_never_raise_the_objective(X, n_clusters, seed):
    assume(len(np.unique(X, axis=0)) >= n_clusters)
    objectives = [
        unsettled(X, n_clusters, random_state=seed, tolerance=0.0, max_iterations=limit).objective
        for limit in (1, 2, 3, 5, 9, 17)
    ]
    slack = 1e-12 * (np.abs(X).max() ** 2 + objectives[0])
    assert np.all(np.diff(objectives) <= slack)


@pytest.mark.parametrize(("n_clusters", "seed"), [(4, 0), (4, 1), (8, 0), (8, 1), (8, 2)])
def test_extrapolation_ends_in_the_optimum_of_plain_alternation_in_a_third_of_its_iterations(
    n_clusters, seed
):
    X = hysteresis(4000)
    start, _ = kmeans_plusplus(X, n_clusters, random_state=seed)
    objective, iterations = alternated(X, start, tolerance=1e-8)
    ours = fuzzy_c_means(
        X, n_clusters, random_state=seed, coarse=1, tolerance=1e-8, max_iterations=iterations // 3
    )
    assert_allclose(ours.objective, objective, rtol=1e-10)


@pytest.mark.parametrize("size", [1, 2, BLOCK - 1, BLOCK, BLOCK + 1, 3 * BLOCK + 7])
@pytest.mark.parametrize("n_clusters", [1, 3])
def test_iteration_equals_its_formulas_for_any_number_of_blocks(size, n_clusters):
    rng = np.random.default_rng(size)
    X, centers = rng.normal(size=(size, 2)), rng.normal(size=(n_clusters, 2))
    before, memberships = rng.uniform(size=(2, n_clusters, size))
    objective, change, means = alternate(
        np.ascontiguousarray(X.T), centers, before, memberships, 1e-300
    )
    distance2 = cdist(centers, X, "sqeuclidean")
    u = 1.0 / (distance2 * (1.0 / distance2).sum(axis=0))
    assert_allclose(memberships, u, rtol=1e-12)
    assert_allclose(objective, (u**2 * distance2).sum(), rtol=1e-12)
    assert_allclose(change, np.abs(u - before).max(), rtol=1e-12)
    assert_allclose(means, u**2 @ X / (u**2).sum(axis=1, keepdims=True), rtol=1e-11, atol=1e-13)


@pytest.mark.parametrize("n_clusters", [0, 6])
def test_number_of_clusters_that_the_samples_do_not_allow_is_refused(n_clusters):
    with pytest.raises(ValueError, match=rf"n_clusters = {n_clusters}.*n_samples = 5"):
        fuzzy_c_means(np.arange(10.0).reshape(5, 2), n_clusters)


def test_too_few_iterations_warn_with_both_limits():
    with pytest.warns(ConvergenceWarning, match="1e-09 in 2 iterations"):
        fuzzy_c_means(hysteresis(100), 4, random_state=0, tolerance=1e-9, max_iterations=2)


def alternated(X, centers, tolerance):
    """Return the objective that memberships and centres in turn end at, and their iterations."""
    before = np.zeros((len(X), len(centers)))
    change, iterations = 1.0, 0
    while change >= tolerance:
        iterations += 1
        closeness = 1.0 / np.maximum(cdist(X, centers, "sqeuclidean"), 1e-24)
        u = closeness / closeness.sum(axis=1, keepdims=True)
        change = np.abs(u - before).max()
        before, shares = u, u**2
        centers = shares.T @ X / shares.sum(axis=0)[:, None]
    return (u**2 / closeness).sum(), iterations


def hysteresis(size):
    phase = 6.0 * np.pi * np.arange(size) / size
    return np.column_stack([np.sin(phase), np.sin(phase - 0.6), np.sin(phase) ** 3])


@pytest.fixture
def traps():
    """Six blobs, unevenly apart: of four clusters, many starts do not end in the best optimum."""
    rng = np.random.default_rng(1)
    centers = np.array([[0, 0], [1, 0], [9, 0], [10, 0], [5, 20], [5, 21]], dtype=float)
    return rng.normal(np.repeat(centers, 15, axis=0), 0.2)


def test_restarts_keep_the_start_with_the_lowest_objective(traps):
    rng = np.random.RandomState(3)
    alone = [fuzzy_c_means(traps, 4, random_state=rng) for _ in range(5)]
    objectives = [found.objective for found in alone]
    lowest = int(np.argmin(objectives))
    assert lowest > 0
    assert objectives[0] > 1.01 * objectives[lowest]
    kept = fuzzy_c_means(traps, 4, random_state=np.random.RandomState(3), restarts=5)
    # starts that end in the same optimum differ by rounding
    assert kept.objective == pytest.approx(min(objectives), rel=1e-6)
    first = next(found for found in alone if found.objective < (1.0 + 1e-6) * min(objectives))
    assert np.array_equal(kept.centers, first.centers)
    assert np.array_equal(kept.memberships, first.memberships)


def test_scikit_fuzzy_agrees_from_equal_starts():
    X = hysteresis(600)
    init = X[[5, 90, 300]]
    ours = fuzzy_c_means(X, 3, tolerance=1e-12, max_iterations=20_000, init=init)
    closeness = 1.0 / np.maximum(cdist(init, X, "sqeuclidean"), np.finfo(float).eps)
    begin = closeness / closeness.sum(axis=0)
    centers, memberships, *_ = cmeans(X.T, 3, m=2, error=1e-12, maxiter=20_000, init=begin)
    assert_allclose(ours.centers, centers, atol=1e-8)
    assert_allclose(ours.memberships, memberships.T, atol=1e-8)


def test_numbers_whose_squares_overflow_are_refused():
    with pytest.raises(ValueError, match=r"numbers up to 1e\+101"):
        fuzzy_c_means(1e101 * np.eye(5), 2)
