import numpy as np
import pytest
from numpy.testing import assert_allclose

from fprc.models import esn
from fprc.models.esn import echo_states


def network(r=40, rho=0.4, inputs=1):
    rng = np.random.default_rng(0)
    W_r = rng.normal(size=(r, r))
    W_r *= rho / np.abs(np.linalg.eigvals(W_r)).max()
    return 0.02 * rng.normal(size=(r, inputs)), W_r


def angles(size, inputs=1):
    time = np.arange(size)[:, None] * (1.0 + np.arange(inputs))
    return 30.0 + 25.0 * np.sin(0.01 * time) + np.random.default_rng(1).normal(size=(size, inputs))


def by_step(X, w_in, W_r, gamma):
    states, x = np.empty((len(X), len(W_r))), np.zeros(len(W_r))
    for k, theta in enumerate(X):
        states[k] = x
        x = gamma * x + (1.0 - gamma) * np.tanh(w_in @ theta + W_r @ x)
    return states


def by_log(X, w_in, W_r, gamma, state=None):
    states = np.empty((len(X), len(W_r)))
    state = np.zeros((2, len(W_r))) if state is None else state
    echo_states(X, state, (W_r, w_in, gamma), states)
    return states


@pytest.mark.parametrize(
    ("size", "r"),
    [
        *((size, 5) for size in (1, 600, 2396, 2397, 2400, 2401)),
        *((3333, r) for r in (1, 2, 3, 40)),
    ],
)
@pytest.mark.parametrize("inputs", [1, 2])
def test_segments_give_the_states_of_steps(size, inputs, r):
    w_in, W_r = network(r=r, inputs=inputs)
    X = angles(size, inputs)
    expected = by_step(X, w_in, W_r, 0.8)
    assert_allclose(by_log(X, w_in, W_r, 0.8), expected, rtol=0, atol=1e-13)


def test_log_goes_on_from_the_state_in_which_another_ended():
    w_in, W_r = network()
    X, state = angles(6000), np.zeros((2, 40))
    parts = [by_log(part, w_in, W_r, 0.8, state) for part in np.split(X, [2500, 2600])]
    assert_allclose(np.vstack(parts), by_step(X, w_in, W_r, 0.8), rtol=0, atol=1e-13)


def test_network_that_does_not_forget_runs_sample_by_sample():
    w_in, W_r = network(r=100, rho=3.0)
    X, w_in = angles(3000), 0.01 * w_in
    states = by_log(X, w_in, W_r, 0.5)
    state = np.zeros((2, len(W_r)))
    for u, row in zip(X, states, strict=True):
        esn.update(state, u, (W_r, w_in, 0.5))
        assert np.array_equal(row, state[0])
    # chaos: no two ways of rounding agree for long
    assert_allclose(states[:10], by_step(X[:10], w_in, W_r, 0.5), atol=1e-9)
