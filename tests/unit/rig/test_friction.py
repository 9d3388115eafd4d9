import numpy as np
import pytest
from scipy.integrate import solve_ivp

from fprc.rig.friction import bouc_wen, friction, slip

DELTA = np.array([1.0, 3.0, 7.0, 14.0])
WEIGHT = np.array([0.3, 0.3, 0.25, 0.15])


#: Slip distance of the Bouc-Wen element that stands for DELTA and WEIGHT.
ONE = 0.8 * np.dot(WEIGHT, DELTA)


def follow(path, law):
    """Forces of a law along a path of positions that begins where nothing is deflected."""
    z = np.zeros(len(DELTA))
    return np.array([law(z, float(step), DELTA, WEIGHT) for step in np.diff(path)])


def test_bouc_wen_solves_its_equation_on_a_sine():
    """With the usual symbols A = 1, beta = gamma = 1/2, n = 1, of z over the slip distance."""
    amplitude, times = 9.0, np.linspace(0.0, 3.0, 601)

    def rate(t, z):
        speed = amplitude * 2.0 * np.pi * np.cos(2.0 * np.pi * t) / ONE
        return speed - 0.5 * np.abs(speed) * z - 0.5 * speed * np.abs(z)

    solved = solve_ivp(rate, (0.0, 3.0), [0.0], t_eval=times, max_step=0.01, rtol=1e-9, atol=1e-11)
    forces = follow(amplitude * np.sin(2.0 * np.pi * times), bouc_wen)
    np.testing.assert_allclose(forces, solved.y[0, 1:], atol=2e-5)


@pytest.mark.parametrize(("length", "law"), [(1, slip), (2, bouc_wen)])
def test_length_of_the_law_chooses_it(length, law):
    z = np.zeros(len(DELTA))
    found = [friction(np.zeros(length), z, step, DELTA, WEIGHT) for step in (2.0, -5.0, 0.0, 9.0)]
    np.testing.assert_array_equal(found, follow([0.0, 2.0, -3.0, -3.0, 6.0], law))
