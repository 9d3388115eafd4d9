import numpy as np
import pytest
from numpy.testing import assert_allclose

from fprc.models import echo
from fprc.models.echo import echo_states


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


@pytest.fixture
def runs(monkeypatch):
    """Return the segments and samples of each run, in the order of the runs."""
    seen = []
    run = echo._run

    def counted(inputs, *rest, **options):
        seen.append(inputs.shape[:2])
        return run(inputs, *rest, **options)

    monkeypatch.setattr(echo, "_run", counted)
    return seen


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
    assert_allclose(echo_states(X, w_in, W_r, 0.8), expected, rtol=0, atol=1e-13)


def test_network_that_forgets_runs_twice_in_segments(runs):
    w_in, W_r = network()
    echo_states(angles(3000), w_in, W_r, 0.8)
    assert runs == [(4, 750), (4, 750)]


def test_network_that_does_not_forget_runs_sample_by_sample(runs):
    w_in, W_r = network(r=100, rho=3.0)
    X = angles(3000)
    states = echo_states(X, 0.01 * w_in, W_r, 0.5)
    assert runs == [(4, 750), (4, 750)]
    x, target = np.zeros((2, len(W_r)))
    for k, u in enumerate(X):
        echo.update(x, target, u, 0.01 * w_in, W_r, 0.5, k % 2 == 0)
        assert np.array_equal(states[k], x)
    # chaos: no two ways of rounding agree for long
    assert_allclose(states[:10], by_step(X[:10], 0.01 * w_in, W_r, 0.5), atol=1e-9)
