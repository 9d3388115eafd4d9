import numpy as np
import pytest
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


@pytest.mark.parametrize(("law", "expected"), [(1, follow), (2, follow_bouc_wen)])
def test_length_of_the_law_chooses_it(law, expected):
    z = np.zeros(len(DELTA))
    found = [friction(np.zeros(law), z, step, DELTA, WEIGHT) for step in (2.0, -5.0, 0.0, 9.0)]
    np.testing.assert_array_equal(found, expected([0.0, 2.0, -3.0, -3.0, 6.0]))
