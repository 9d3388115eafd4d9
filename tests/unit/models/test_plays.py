import numpy as np
from hypothesis import given
from hypothesis import strategies as st
from numpy.testing import assert_allclose

from fprc.models import PlayOperators

numbers = st.floats(-50, 50, allow_subnormal=False)
paths = st.lists(numbers, min_size=1, max_size=30)


def fitted(n_plays=4, low=-30.0, high=30.0):
    return PlayOperators(n_plays).fit([[low], [high]])


def plays(path):
    """Return the plays of a path; their half-widths are 6, 12, 18 and 24."""
    return fitted().transform(np.array(path)[:, None])


def test_half_widths_divide_half_the_range_of_each_column():
    X = [[0.0, 5.0], [60.0, 5.0], [20.0, 7.0]]
    found = PlayOperators(n_plays=2).fit(X).half_widths_
    assert_allclose(found, [[10.0, 20.0], [1 / 3, 2 / 3]], rtol=1e-15)


@given(paths, paths)
def test_plays_are_those_of_a_loop_over_samples_and_columns(first, second):
    size = min(len(first), len(second))
    X = np.column_stack([first[:size], second[:size]])
    features = PlayOperators(n_plays=3).fit([[-30.0, 0.0], [30.0, 8.0]])
    expected = np.empty((size, 6))
    for i, widths in enumerate([[7.5, 15.0, 22.5], [1.0, 2.0, 3.0]]):
        for j, r in enumerate(widths):
            p = X[0, i]
            for k, x in enumerate(X[:, i]):
                p = max(x - r, min(x + r, p))
                expected[k, 3 * i + j] = p
    assert np.array_equal(features.transform(X), expected)
    assert np.array_equal([features.step(x) for x in X], expected)


@given(paths, st.sampled_from([1.0, -1.0]))
def test_play_of_a_monotone_input_waits_for_r_and_then_lags_by_r(path, sign):
    x = np.sort(path)
    expected = np.maximum(x[0], x[:, None] - [6.0, 12.0, 18.0, 24.0])
    assert_allclose(plays(sign * x), sign * expected, rtol=1e-12)


@given(paths, st.lists(numbers, min_size=3, max_size=3), st.sampled_from([1.0, -1.0]))
def test_input_that_returns_to_a_reversal_wipes_out_the_loop_between(past, levels, sign):
    low, inner, high = sorted(levels)
    after = plays(sign * np.array([*past, low, high, inner, high]))
    assert np.array_equal(after[-1], after[-3])


@given(paths, st.integers(2, 5))
def test_plays_do_not_depend_on_the_speed_of_the_input(path, times):
    assert np.array_equal(plays(np.repeat(path, times))[times - 1 :: times], plays(path))


def test_closed_loop_of_a_play_is_a_parallelogram_of_width_2_r():
    wave = 30.0 - np.abs(np.linspace(-60.0, 60.0, 241))
    path = np.concatenate([wave, wave])
    rows, x = plays(path)[241:], path[241:]
    for p, r in zip(rows.T, [6.0, 12.0, 18.0, 24.0], strict=True):
        area = np.abs(np.sum((p[1:] + p[:-1]) / 2 * np.diff(x)))
        assert_allclose(area, 2.0 * r * (60.0 - 2.0 * r), rtol=1e-3)


def test_names_number_the_plays_of_each_column():
    names = fitted(n_plays=2).get_feature_names_out(["theta_deg"])
    assert names.tolist() == ["theta_deg_play0", "theta_deg_play1"]
