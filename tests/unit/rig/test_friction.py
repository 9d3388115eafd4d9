import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.integrate import solve_ivp

from fprc.rig.friction import bouc_wen, friction, slip

DELTA = np.array([1.0, 3.0, 7.0, 14.0])
WEIGHT = np.array([0.3, 0.3, 0.25, 0.15])

positions = st.lists(st.floats(-30.0, 30.0), min_size=2, max_size=12)


def follow(path, z=None):
    """Forces along a path of positions that begins where ``z`` stands."""
    z = np.zeros(len(DELTA)) if z is None else z
    return np.array([slip(z, float(step), DELTA, WEIGHT) for step in np.diff(path)])


def play_model(path):
    """Same friction as stops that complete play operators: z = x - play(x)."""
    play = np.zeros(len(DELTA))
    forces = []
    for x in np.asarray(path[1:]) - path[0]:
        play = np.maximum(x - DELTA, np.minimum(x + DELTA, play))
        forces.append(np.dot(WEIGHT, (x - play) / DELTA))
    return np.array(forces)


def refine(path, pieces):
    """Same turning points, each leg cut into ``pieces``."""
    legs = [np.linspace(a, b, pieces + 1)[1:] for a, b in zip(path, path[1:], strict=False)]
    return np.concatenate([[path[0]], *legs])


@given(positions)
def test_force_agrees_with_play_operators(path):
    np.testing.assert_allclose(follow(path), play_model(path), atol=1e-12)


@given(positions, st.floats(-30.0, 30.0), st.floats(0.0, 1.0))
def test_minor_loop_closes_and_is_forgotten(path, leg, share):
    """Back at the point where a minor loop began, every element is as it was."""
    z = np.zeros(len(DELTA))
    follow([*path, path[-1] + leg], z)
    began = z.copy()
    follow([0.0, -share * leg, 0.0], z)
    np.testing.assert_allclose(z, began, atol=1e-12)


@given(positions)
def test_closed_cycle_never_returns_more_work_than_it_took(path):
    cycle = [path[0], *path[1:], path[0]]
    z = np.zeros(len(DELTA))
    follow(cycle, z)
    work = np.dot(follow(cycle, z), np.diff(cycle))
    assert work >= -1e-9


def test_wide_cycle_dissipates_the_area_of_a_coulomb_loop():
    """Far beyond every slip distance the loop is 2 F wide, less the elastic corners."""
    cycle = refine([0.0, 50.0, -50.0, 0.0], 5000)
    z = np.zeros(len(DELTA))
    follow(cycle, z)
    work = np.dot(follow(cycle, z), np.diff(cycle))
    exact = 4.0 * np.dot(WEIGHT, 50.0 - DELTA)
    assert work == pytest.approx(exact, rel=2e-3)


# --- Bouc-Wen -----------------------------------------------------------------------------------

#: Slip distance of the element that stands for DELTA and WEIGHT.
ONE = 0.8 * np.dot(WEIGHT, DELTA)


def follow_bouc_wen(path, z=None):
    z = np.zeros(len(DELTA)) if z is None else z
    return np.array([bouc_wen(z, float(step), DELTA, WEIGHT) for step in np.diff(path)])


def test_bouc_wen_solves_its_equation_on_a_sine():
    """With the usual symbols A = 1, beta = gamma = 1/2, n = 1, of z over the slip distance."""
    amplitude, times = 9.0, np.linspace(0.0, 3.0, 601)

    def rate(t, z):
        speed = amplitude * 2.0 * np.pi * np.cos(2.0 * np.pi * t) / ONE
        return speed - 0.5 * np.abs(speed) * z - 0.5 * speed * np.abs(z)

    solved = solve_ivp(rate, (0.0, 3.0), [0.0], t_eval=times, max_step=0.01, rtol=1e-9, atol=1e-11)
    forces = follow_bouc_wen(amplitude * np.sin(2.0 * np.pi * times))
    np.testing.assert_allclose(forces, solved.y[0, 1:], atol=2e-5)


@given(positions, st.integers(2, 40))
def test_bouc_wen_does_not_depend_on_the_speed_along_the_path(path, pieces):
    fast = follow_bouc_wen(path)
    slow = follow_bouc_wen(refine(path, pieces))[pieces - 1 :: pieces]
    np.testing.assert_allclose(slow, fast, atol=1e-11)


@given(positions)
def test_bouc_wen_force_stays_between_minus_one_and_one(path):
    assert np.abs(follow_bouc_wen(path)).max() <= 1.0


@given(positions)
def test_bouc_wen_returns_no_more_work_than_it_has_stored(path):
    """Stored is the work of an elastic unloading, delta force^2 / 2."""
    fine = refine(path, 200)
    force = np.concatenate([[0.0], follow_bouc_wen(fine)])
    work = np.cumsum(0.5 * (force[1:] + force[:-1]) * np.diff(fine))
    dissipated = np.diff(work - 0.5 * ONE * force[1:] ** 2, prepend=0.0)
    assert dissipated.min() >= -1e-3  # of the trapezoidal rule


def test_wide_cycle_dissipates_the_same_under_both_laws():
    cycle = refine([0.0, 100.0, -100.0, 0.0], 10000)
    found = []
    for law in (follow, follow_bouc_wen):
        z = np.zeros(len(DELTA))
        law(cycle, z)
        found.append(np.dot(law(cycle, z), np.diff(cycle)))
    assert found[1] == pytest.approx(found[0], rel=1e-3)


def test_bouc_wen_minor_loop_does_not_close():
    """This is why it is not the default: those of Maxwell slip do, see above."""
    z = np.zeros(len(DELTA))
    began = follow_bouc_wen([0.0, 4.0], z)[-1]
    assert follow_bouc_wen([4.0, 3.0, 4.0], z)[-1] < began - 0.1


@pytest.mark.parametrize(("law", "expected"), [(1, follow), (2, follow_bouc_wen)])
def test_length_of_the_law_chooses_it(law, expected):
    z = np.zeros(len(DELTA))
    found = [friction(np.zeros(law), z, step, DELTA, WEIGHT) for step in (2.0, -5.0, 0.0, 9.0)]
    np.testing.assert_array_equal(found, expected([0.0, 2.0, -3.0, -3.0, 6.0]))
