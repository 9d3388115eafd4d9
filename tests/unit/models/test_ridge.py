import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays
from numpy.testing import assert_allclose

from fprc.models import RidgeReadout, ridge
from fprc.models.ridge import solve_ridge


@st.composite
def problems(draw):
    samples, weights = draw(st.integers(1, 12)), draw(st.integers(1, 5))
    numbers = st.floats(-100, 100, allow_subnormal=False)
    return (
        draw(arrays(float, (samples, weights), elements=numbers)),
        draw(arrays(float, samples, elements=numbers)),
        draw(st.floats(1e-3, 1e3)),
        draw(arrays(float, samples, elements=st.floats(0, 1))),
    )


@given(problems())
def test_gradient_of_the_printed_objective_is_zero_at_the_solution(problem):
    extended, y, alpha, weights = problem
    weighted = extended * weights[:, None]
    w = solve_ridge(weighted.T @ extended, weighted.T @ y, alpha)
    gradient = extended.T @ (weights * (extended @ w - y)) + alpha * w
    scale = np.abs(extended.T) @ (weights * (np.abs(extended) @ np.abs(w) + np.abs(y)))
    assert np.all(np.abs(gradient) <= 1e-9 * (scale + alpha * np.abs(w)) + 1e-12)


def test_readouts_of_complements_equal_those_trained_on_them():
    rng = np.random.default_rng(3)
    X, y = rng.normal(40.0, 20.0, (200, 6)), rng.normal(175.0, 50.0, 200)
    parts = np.array_split(rng.permutation(200), 4)
    readouts = RidgeReadout(alpha=1e-3).fit_complements([X[:70], X[70:]], y, parts)
    for part, ours in zip(parts, readouts, strict=True):
        rest = np.setdiff1d(np.arange(200), part)
        plain = RidgeReadout(alpha=1e-3).fit(X[rest], y[rest])
        assert_allclose(ours.w_out_, plain.w_out_, rtol=1e-9)
        assert_allclose(ours.predict(X), plain.predict(X), rtol=1e-12)


def test_blocks_of_rows_give_the_weights_of_all_rows_at_once(monkeypatch):
    monkeypatch.setattr(ridge, "ROWS", 30)
    rng = np.random.default_rng(5)
    X, y = rng.normal(40.0, 20.0, (200, 6)), rng.normal(175.0, 50.0, 200)
    in_blocks = RidgeReadout().fit_blocks(iter(np.split(X, [100, 131])), y)
    extended = np.column_stack([np.ones(200), X])
    expected = np.linalg.solve(extended.T @ extended + 1e-3 * np.eye(7), extended.T @ y)
    assert_allclose(in_blocks.w_out_, expected, rtol=1e-9)
    assert in_blocks.n_features_in_ == 6


def test_part_that_is_large_costs_the_others_no_digits():
    rng = np.random.default_rng(4)
    X, y = rng.normal(0.0, 1.0, (200, 3)), rng.normal(0.0, 1.0, 200)
    X[:50] *= 1e7
    parts = np.array_split(np.arange(200), 4)
    without_large = RidgeReadout(alpha=1e-3).fit_complements([X[:70], X[70:]], y, parts)[0]
    plain = RidgeReadout(alpha=1e-3).fit(X[50:], y[50:])
    assert_allclose(without_large.w_out_, plain.w_out_, rtol=1e-9)


@pytest.mark.parametrize(
    "X",
    [np.eye(3, 6), np.repeat(np.arange(50.0)[:, None] ** 0.5, 2, axis=1), np.full((50, 1), 33.3)],
    ids=["fewer samples than weights", "repeated column", "constant column"],
)
def test_singular_regression_without_ridge_asks_for_a_larger_alpha(X):
    with pytest.raises(ValueError, match=r"alpha = 0.*larger alpha"):
        RidgeReadout(alpha=0.0).fit(X, np.arange(len(X), dtype=float))
