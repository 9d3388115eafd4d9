import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.stats import chi2

from fprc.errors import EvaluationError
from fprc.studies.beyond.capacity import processing_capacity

examples = settings(max_examples=15, deadline=None, derandomize=True)

N = 4000
U = np.random.default_rng(5).uniform(-1.0, 1.0, N)


def delayed(u, delay):
    return np.concatenate([np.zeros(delay), u[: len(u) - delay]])


def by_degree(found):
    return list(found["by_degree"].values())


def delay_line(u, delays):
    return np.column_stack([delayed(u, delay) for delay in delays])


@pytest.mark.parametrize("delays", [range(6), range(1, 7), [3]])
def test_delay_line_remembers_as_many_inputs_as_it_is_long(delays):
    found = processing_capacity(U, delay_line(U, delays), max_delay=8, max_degree=3)
    assert by_degree(found) == pytest.approx([len(delays), 0.0, 0.0])
    assert np.flatnonzero(found["by_delay"]).tolist() == list(delays)
    assert found["rank"] == len(delays)


def test_cube_is_split_between_its_linear_and_its_cubic_part():
    """u^3 = 3/5 P1 + 2/5 P3, whose variances are 1/3 and 1/7."""
    linear, cubic = (3 / 5) ** 2 / 3, (2 / 5) ** 2 / 7
    share = linear / (linear + cubic)
    found = processing_capacity(U, U[:, None] ** 3, max_delay=1, max_degree=3)
    assert by_degree(found) == pytest.approx([share, 0.0, 1.0 - share], abs=0.03)


def test_all_polynomials_up_to_a_degree_fill_the_capacity():
    """Nine independent functions of three inputs, as powers instead of Legendre polynomials."""
    a, b, c = delay_line(U, range(3)).T
    states = np.column_stack([a, b, c, a * a, b * b, c * c, a * b, a * c, b * c])
    found = processing_capacity(U, states, max_delay=4, max_degree=2)
    assert by_degree(found) == pytest.approx([3.0, 6.0])


def test_capacity_agrees_with_a_least_squares_fit():
    states = np.tanh(delay_line(U, range(4)) @ np.random.default_rng(3).normal(size=(4, 6)))
    found = processing_capacity(U, states, max_delay=4, max_degree=1)
    design = np.column_stack([np.ones(N - 4), states[4:]])
    for delay in range(4):
        target = U[4 - delay : N - delay]
        residual = target - design @ np.linalg.lstsq(design, target, rcond=None)[0]
        expected = 1.0 - residual.var() / target.var()
        assert found["by_delay"][delay] == pytest.approx(expected, abs=1e-9)


@examples
@given(st.integers(0, 2**32 - 1), st.integers(1, 8))
def test_capacity_depends_on_the_span_of_the_states_only(seed, columns):
    rng = np.random.default_rng(seed)
    u = rng.uniform(-1.0, 1.0, 800)
    states = np.tanh(delay_line(u, range(3)) @ rng.normal(size=(3, columns)))
    mixed = states @ np.linalg.qr(rng.normal(size=(columns, columns)))[0] * 50.0 - 7.0
    kept = {"max_delay": 3, "max_degree": 3}
    one, other = (processing_capacity(u, x, **kept) for x in (states, mixed))
    np.testing.assert_allclose(by_degree(other), by_degree(one), atol=1e-6)
    assert sum(by_degree(one)) <= 1.1 * one["rank"]


@pytest.mark.parametrize("columns", [1, 10])
def test_shuffled_states_have_no_capacity(columns):
    """The threshold is twice the one that independent states of any kind exceed with p."""
    states = delay_line(U, range(columns))
    shuffled = states[np.random.default_rng(4).permutation(N)]
    found = processing_capacity(U, shuffled, max_delay=10, max_degree=3)
    assert by_degree(found) == [0.0, 0.0, 0.0]
    assert found["threshold"] == pytest.approx(2.0 * chi2.isf(1e-4, columns) / (N - 10))


def test_dependent_and_constant_states_do_not_count():
    line = delay_line(U, range(2))
    states = np.column_stack([line, line.sum(axis=1), np.full(N, 0.1), line[:, 0] * 1e9])
    assert processing_capacity(U, states, max_delay=2, max_degree=1)["rank"] == 2
    still = processing_capacity(U, np.full((N, 2), 0.1), max_delay=2, max_degree=1)
    assert (still["rank"], by_degree(still)) == (0, [0.0])
    nearly = np.column_stack([U, U + 1e-8 * delayed(U, 1)])
    assert processing_capacity(U, nearly, max_delay=2, max_degree=1)["rank"] == 1


@pytest.mark.parametrize(
    ("u", "states"),
    [
        (U, np.where(U > 0.999, np.inf, U)[:, None]),
        (U[:60], np.random.default_rng(7).normal(size=(60, 30))),
    ],
    ids=["states not finite", "too few"],
)
def test_refuses_what_gives_no_capacity(u, states):
    with pytest.raises(EvaluationError):
        processing_capacity(u, states, max_delay=3, max_degree=1)
