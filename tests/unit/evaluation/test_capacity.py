"""Capacities that are known, and a memory capacity by another definition."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import fprc
from fprc.errors import EvaluationError
from fprc.models import EchoStates


def inputs(size=6000, a=0.0, seed=0):
    """Return an AR(1) input, independent and uniform if ``a`` is 0."""
    u = np.random.default_rng(seed).uniform(-1.0, 1.0, size)
    for k in range(1, size):
        u[k] += a * u[k - 1]
    return u


def delayed(u, *lags):
    return np.column_stack([np.append(np.zeros(lag), u[: len(u) - lag]) for lag in lags])


def network(u, r, **settings):
    states = EchoStates(r=r, gamma=0.0, n_y=1, random_state=1, **settings).fit(u[:, None])
    return states.transform(u[:, None])[:, 1:]


@pytest.mark.parametrize("a", [0.0, 0.9, 0.99])
@pytest.mark.parametrize("taps", [1, 5, 12])
def test_delay_line_has_as_many_capacities_as_taps_also_of_correlated_input(a, taps):
    u = inputs(3000, a)
    found = fprc.capacity(delayed(u, *range(taps)), u, lags=20, degree=2, most=30)
    assert found.degrees == pytest.approx([taps, 0.0], abs=0.02)
    assert found.rank == taps
    assert found.degrees.sum() <= taps + 1e-9


@pytest.mark.parametrize("degree", [2, 3])
def test_power_of_a_delay_is_of_its_degree(degree):
    u = inputs()
    # a cube is in part a line: u^3 - 3 u / 5 is orthogonal to it for uniform numbers
    state = u**2 if degree == 2 else u**3 - 0.6 * u
    found = fprc.capacity(delayed(state, 3), u, lags=10, most=60)
    expected = np.zeros(3)
    expected[degree - 1] = 1.0
    assert found.degrees == pytest.approx(expected, abs=0.03)
    best = max(found.targets, key=found.targets.get)
    assert best == (3,) * degree


def test_degree_one_is_the_memory_capacity_of_unseen_inputs():
    """Of an independent uniform input: squared correlation of a trained readout, by lag."""
    u = inputs(16000)
    state = network(u, 50, f_input=0.2, rho=0.9)
    train, test = slice(100, 12000), slice(12000, None)
    extended = np.column_stack([np.ones(len(u)), state])
    expected = 0.0
    for lag in range(60):
        past = delayed(u, lag)[:, 0]
        weights = np.linalg.lstsq(extended[train], past[train])[0]
        expected += np.corrcoef(extended[test] @ weights, past[test])[0, 1] ** 2
    found = fprc.capacity(state, u, lags=60, degree=1)
    assert found.degrees[0] == pytest.approx(expected, rel=0.02)


@settings(max_examples=15, deadline=None)
@given(
    states=st.integers(1, 8), a=st.floats(0.0, 0.995), seed=st.integers(0, 99),
    noise=st.floats(0.0, 1.0),
)  # fmt: skip
def test_sum_never_exceeds_the_rank(states, a, seed, noise):
    u = inputs(800, a, seed)
    rng = np.random.default_rng(seed)
    state = np.tanh(delayed(u, 0, 1, 2) @ rng.standard_normal((3, states)))
    state += noise * rng.standard_normal(state.shape)
    found = fprc.capacity(state, u, lags=8, most=20)
    assert found.degrees.sum() <= found.rank + 1e-9
    assert found.rank == states


def test_what_another_time_does_as_well_is_no_memory():
    u = inputs(4000, 0.99)
    found = fprc.capacity(np.random.default_rng(1).standard_normal((4000, 3)), u, most=30)
    assert found.degrees.sum() < 0.1
    assert found.memory_s == pytest.approx(0.0, abs=0.05)


def test_memory_is_the_share_that_the_own_taps_leave():
    """Of an AR(1) input the newest tap explains a^(2 lag); a perfect state adds the rest."""
    u, a = inputs(8000, 0.8), 0.8
    found = fprc.capacity(delayed(u, 2, 4), u, lags=5, degree=1, rate_hz=10.0)
    assert found.memory[[2, 4]] == pytest.approx([1 - a**4, 1 - a**8], abs=0.02)
    assert found.memory[0] == pytest.approx(0.0, abs=1e-3)
    assert found.lags_s == pytest.approx([0.0, 0.1, 0.2, 0.3, 0.4])
    assert found.memory_s == pytest.approx(found.memory.sum() / 10.0)
    own = fprc.capacity(delayed(u, 0, 1, 2, 3), u, lags=6, degree=1, taps=4)
    assert own.memory_s == pytest.approx(0.0, abs=0.01)


def test_constant_states_and_inputs_have_no_capacity():
    u = inputs(1000)
    assert fprc.capacity(np.ones((1000, 2)), u, lags=5, most=10).degrees.sum() == 0.0
    assert fprc.capacity(u, np.ones(1000), lags=5, most=10).degrees.sum() == pytest.approx(
        0.0, abs=0.02
    )


@pytest.mark.parametrize(
    ("state", "u"),
    [
        (np.zeros((10, 1)), np.zeros(9)),
        (np.zeros((400, 1)), np.full(400, np.nan)),
        (np.zeros((50, 1)), np.zeros(50)),
    ],
)
def test_arrays_that_do_not_suit_are_refused(state, u):
    with pytest.raises(EvaluationError):
        fprc.capacity(state, u)
