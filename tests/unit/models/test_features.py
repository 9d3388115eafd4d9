"""Feature maps against literal formulas and loops, in a log and sample by sample."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays
from numpy.testing import assert_allclose
from scipy.signal import lfilter
from sklearn.base import clone

from fprc.models import NVAR, EchoStates, LowpassBank, PlayOperators, TapFeatures, kernels

epsilons = st.floats(1e-3, 1.0)


@st.composite
def logs(draw, columns, shortest=8):
    shape = draw(st.integers(shortest, 30)), columns
    return draw(arrays(float, shape, elements=st.floats(-500, 500, allow_subnormal=False)))


@given(logs(3), st.integers(1, 6), st.integers(1, 6), st.sampled_from([None, 0, 1, 2]), epsilons)
def test_tap_features_step_by_step_equal_those_of_the_whole_log(X, n_y, n_u, n_references, epsilon):
    features = TapFeatures(n_y=n_y, n_references=n_references, n_u=n_u, epsilon=epsilon).fit(X)
    assert_allclose([features.step(x) for x in X], features.transform(X), rtol=1e-11, atol=1e-9)


def test_tap_features_put_references_before_filtered_readouts():
    theta, p_o, p_2 = np.array([[1.0, 2, 4, 8], [0, 10, 10, 20], [5, 5, 5, 9]])
    X = np.column_stack([theta, p_o, p_2])
    rows = TapFeatures(n_y=3, n_u=2, epsilon=0.5).fit_transform(X)
    assert rows.tolist() == [
        [1, 1, 1, 0, 0, 5, 5],
        [2, 1, 1, 5, 0, 5, 5],
        [4, 2, 1, 7.5, 5, 5, 5],
        [8, 4, 2, 13.75, 7.5, 7, 5],
    ]


@given(logs(2, shortest=1), st.lists(epsilons, min_size=1, max_size=4))
def test_bank_is_scipys_filter_of_each_column_with_each_factor(X, factors):
    features = LowpassBank(factors).fit(X)
    expected = [
        lfilter([epsilon], [1.0, epsilon - 1.0], column, zi=[(1.0 - epsilon) * column[0]])[0]
        for column in X.T
        for epsilon in factors
    ]
    assert_allclose(features.transform(X).T, expected, rtol=1e-9, atol=1e-9)
    # a tree would tell the last digits apart
    assert np.array_equal([features.step(x) for x in X], features.transform(X))


@given(logs(2, shortest=1))
def test_plays_are_those_of_a_loop_over_samples_and_columns(X):
    features = PlayOperators(n_plays=3).fit([[-300.0, 0.0], [300.0, 80.0]])
    expected = np.empty((len(X), 6))
    for i, widths in enumerate([[75.0, 150.0, 225.0], [10.0, 20.0, 30.0]]):
        for j, r in enumerate(widths):
            p = X[0, i]
            for k, x in enumerate(X[:, i]):
                p = max(x - r, min(x + r, p))
                expected[k, 3 * i + j] = p
    assert np.array_equal(features.transform(X), expected)
    assert np.array_equal([features.step(x) for x in X], expected)


@given(st.integers(1, 3), st.integers(1, 4), st.integers(2, 3), st.integers(1, 2), st.data())
def test_products_are_those_of_literal_loops(n_taps, spacing, degree, columns, data):
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


@pytest.mark.parametrize("value", [42.0, 5e-324, 101325.3])
@pytest.mark.parametrize("size", [10, 24_000])
def test_column_that_is_constant_but_for_rounding_gives_no_products(value, size):
    """The rounding of its standard deviation grows with the value and the number of samples."""
    features = NVAR(2, 3).fit(value * (1.0 + 1e-15 * (np.arange(size) % 10))[:, None])
    assert features.scale_.tolist() == [1.0]
    assert_allclose(features.transform(np.full((10, 1), value)), 0.0, atol=1e-9)


def test_weights_of_the_network_are_dense_and_normal_and_their_largest_eigenvalue_is_rho():
    features = EchoStates(r=200, f_input=0.02, rho=0.7, random_state=0).fit(log(9))
    assert np.abs(np.linalg.eigvals(features.W_r_)).max() == pytest.approx(0.7, rel=1e-6)
    network = features.W_r_.ravel() / features.W_r_.std()
    for weights, spread in ((features.w_in_.ravel() / 0.02, 0.15), (network, 0.02)):
        assert np.mean(weights) == pytest.approx(0.0, abs=spread)
        assert np.std(weights) == pytest.approx(1.0, abs=spread)
        assert np.mean(np.abs(weights) < 1.0) == pytest.approx(0.683, abs=spread)


@pytest.mark.parametrize(
    "features", [TapFeatures(n_y=3, n_u=2), EchoStates(r=8, n_y=3, random_state=0)]
)
def test_rows_of_any_layout_compile_nothing_anew(features):
    X = log(20)
    features.fit(X)
    features.step(X[0])
    compiled = [list(function.signatures) for function in (kernels.advance, kernels.excite)]
    fixed = X.copy()
    fixed.flags.writeable = False
    for rows in (fixed, X[:, ::-1], np.asfortranarray(X), X.astype(np.float32), X.tolist()):
        features.step(rows[1])
    found = [list(function.signatures) for function in (kernels.advance, kernels.excite)]
    assert found == compiled


@pytest.mark.parametrize("r", [1, 2, 3, 4, 5, 7, 8, 31])
def test_steps_of_a_network_of_any_size_give_its_states(r):
    X = log(30)
    features = EchoStates(r=r, washout=7, random_state=0).fit(X)
    steps = [features.step(x) for x in X]
    assert_allclose(steps, features.transform(X), rtol=1e-11, atol=1e-14)


MAPS = [EchoStates(r=12, washout=30, random_state=1), TapFeatures(), PlayOperators()]


@given(st.lists(st.integers(5, 20), min_size=1, max_size=5), st.sampled_from(MAPS))
def test_features_equal_a_stream_that_is_reset_at_each_recording(lengths, features):
    X = 30.0 * np.random.default_rng(sum(lengths)).normal(size=(sum(lengths), 2))
    features = clone(features).fit(X)
    starts, stepped = np.cumsum([0, *lengths]), []
    for k, x in enumerate(X):
        if k in starts:
            features.reset()
        stepped.append(features.step(x))
    assert_allclose(features.transform(X, lengths), stepped, rtol=0, atol=1e-9)


@pytest.mark.parametrize(
    ("lengths", "problem"),
    [([60, 3, 37], "n_samples = 3 is")]
    + [(wrong, "100 samples") for wrong in ([60], [60, 50], [60, 40, 0], [103, -3], [])],
)
def test_lengths_that_do_not_suit_the_log_or_the_taps_are_refused(lengths, problem):
    with pytest.raises(ValueError, match=problem):
        TapFeatures().fit(log(100)).transform(log(100), lengths)


def log(size):
    time = np.arange(size) / 10.0
    return np.column_stack([20.0 + 15.0 * np.sin(time), 100.0 + 5.0 * np.cos(1.3 * time)])
