import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.integrate import solve_ivp

from fprc.rig.valve import mass_flow, spool_acceleration

CRITICAL_RATIOS = (0.2, 0.3, 0.5)

pressures = st.floats(50.0, 800.0)
critical_ratios = st.floats(0.2, 0.5)


@given(pressures, pressures, critical_ratios)
def test_flow_reverses_when_the_pressures_swap(p1, p2, b):
    assert mass_flow(4.0, p1, p2, b) == -mass_flow(4.0, p2, p1, b)


@pytest.mark.parametrize("b", CRITICAL_RATIOS)
def test_slope_stays_finite_where_the_pressures_meet(b):
    gaps_kpa = np.array([1e-9, 1e-6, 1e-3, 1.0])
    slopes = [mass_flow(4.0, 600.0, 600.0 - gap, b) / gap for gap in gaps_kpa]
    np.testing.assert_allclose(slopes, slopes[-1], rtol=1e-4)
    # the ellipse alone has an infinite slope there: sqrt(gap)
    assert mass_flow(4.0, 600.0, 600.0 - 1e-9, b) < 1e-3 * 4.0 * 600.0 * np.sqrt(1e-9 / 600.0)


def underdamped(t, wn, zeta):
    wd = wn * np.sqrt(1.0 - zeta**2)
    decay = np.exp(-zeta * wn * t)
    return 1.0 - decay * (np.cos(wd * t) + zeta * wn / wd * np.sin(wd * t))


def overdamped(t, wn, zeta):
    root = wn * np.sqrt(zeta**2 - 1.0)
    slow, fast = -zeta * wn + root, -zeta * wn - root
    return 1.0 - (fast * np.exp(slow * t) - slow * np.exp(fast * t)) / (fast - slow)


@pytest.mark.parametrize(
    ("zeta", "closed_form"), [(0.3, underdamped), (0.7, underdamped), (1.5, overdamped)]
)
@pytest.mark.parametrize("command", [1.0, -0.4])
def test_spool_follows_the_step_response_of_a_second_order_system(zeta, closed_form, command):
    wn = 2.0 * np.pi * 100.0
    t = np.linspace(0.0, 0.03, 61)
    spool = solve_ivp(
        lambda _, y: (y[1], spool_acceleration(y[0], y[1], command, wn, zeta)),
        (0.0, t[-1]),
        (0.0, 0.0),
        t_eval=t,
        rtol=1e-9,
        atol=1e-11,
    )
    np.testing.assert_allclose(spool.y[0], command * closed_form(t, wn, zeta), atol=1e-7)
