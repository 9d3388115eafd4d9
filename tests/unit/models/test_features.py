import numpy as np
import pandas as pd
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays
from numpy.testing import assert_allclose
from sklearn import config_context
from sklearn.base import clone

from fprc.models import (
    ESN,
    FPRC,
    EchoStates,
    FuzzyLinear,
    TapFeatures,
    kernels,
)

epsilons = st.floats(1e-4, 1.0)


@st.composite
def logs(draw, columns):
    shape = draw(st.integers(8, 30)), columns
    numbers = st.floats(-500, 500, allow_subnormal=False)
    return draw(arrays(float, shape, elements=numbers))


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


@pytest.mark.parametrize("seed", range(5))
def test_largest_absolute_eigenvalue_of_the_network_is_rho(seed):
    W_r = EchoStates(r=30, rho=0.7, random_state=seed).fit(log(9)).W_r_
    assert np.abs(np.linalg.eigvals(W_r)).max() == pytest.approx(0.7, rel=1e-7)


def test_weights_of_the_network_are_dense_and_normally_distributed():
    features = EchoStates(r=200, f_input=0.02, random_state=0).fit(log(9))
    inputs = features.w_in_.ravel() / 0.02
    network = features.W_r_.ravel() / features.W_r_.std()
    for weights, spread in ((inputs, 0.15), (network, 0.02)):
        assert np.mean(weights) == pytest.approx(0.0, abs=spread)
        assert np.std(weights) == pytest.approx(1.0, abs=spread)
        assert np.mean(np.abs(weights) < 1.0) == pytest.approx(0.683, abs=spread)
        assert np.all(weights != 0.0)


@pytest.mark.parametrize(
    "features",
    [TapFeatures(n_y=3, n_u=2), EchoStates(r=8, n_y=3, random_state=0)],
    ids=["taps", "network"],
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
@pytest.mark.parametrize("halves", [True, False])
def test_steps_of_a_network_of_any_size_give_its_states(r, halves):
    X = log(30)
    features = EchoStates(r=r, washout=7, random_state=0).fit(X)
    if not halves:
        features.W_r_ = features.W_r_ * (1.0 + 1e-12)
        features.reset()
    steps = [features.step(x) for x in X]
    assert features._W_r.dtype == (np.float32 if halves else np.float64)
    assert_allclose(steps, features.transform(X), rtol=1e-11, atol=1e-14)


def log(size):
    time = np.arange(size) / 10.0
    return np.column_stack([20.0 + 15.0 * np.sin(time), 100.0 + 5.0 * np.cos(1.3 * time)])


# --- names ----------------------------------------------------------------------------------


def table(samples=30):
    values = np.random.default_rng(4).standard_normal((samples, 2))
    return pd.DataFrame(values, columns=["theta", "p_o"], index=np.arange(samples) / 200.0)


@pytest.mark.parametrize(
    "model", [FPRC(n_c=2, random_state=0), FuzzyLinear(n_c=2, random_state=0), ESN(r=5)]
)
def test_model_is_the_same_where_maps_give_tables(model):
    X = table().to_numpy()
    with config_context(transform_output="pandas"):
        fitted = clone(model).set_params(random_state=0).fit(X, X.sum(axis=1))
        tables = fitted.predict(X)
    arrays_ = clone(model).set_params(random_state=0).fit(X, X.sum(axis=1)).predict(X)
    assert tables.tolist() == fitted.predict(X).tolist() == arrays_.tolist()
