import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.integrate import solve_ivp

from fprc.rig.chamber import ATMOSPHERE_KPA, pressure_rate, sealed_pressure

DURATION_S = 0.5


def fill(n, flow, volume, volume_rate, p0=150.0):
    """Integrate a chamber; columns of the answer: p, inflow, work on the wall."""

    def rates(t, y):
        p_rate = pressure_rate(y[0], flow(t), volume(t), volume_rate(t), n)
        return p_rate, flow(t), y[0] * volume_rate(t)

    times = np.linspace(0.0, DURATION_S, 41)
    run = solve_ivp(rates, (0.0, DURATION_S), (p0, 0.0, 0.0), t_eval=times, rtol=1e-10, atol=1e-10)
    return times, *run.y


def breathing(t):
    return 20.0 + 6.0 * np.sin(9.0 * t)


def breathing_rate(t):
    return 54.0 * np.cos(9.0 * t)


def test_adiabatic_chamber_obeys_the_first_law():
    """U - U0 = enthalpy carried in - work done on the wall, with U = p V/(n - 1)."""
    n = 1.4
    times, p, inflow_ml, work = fill(
        n, lambda t: 400.0 * np.exp(-3.0 * t), breathing, breathing_rate
    )
    energy = p * breathing(times) / (n - 1.0)
    enthalpy = n / (n - 1.0) * ATMOSPHERE_KPA * inflow_ml
    np.testing.assert_allclose(energy - energy[0], enthalpy - work, rtol=1e-6, atol=1e-3)


@given(st.floats(100.0, 1000.0), st.floats(5.0, 60.0), st.floats(0.2, 1.0))
def test_sealed_pressure_is_the_ideal_gas_law(p0_kpa_abs, volume_ml, share):
    """m R T from moles and 293 K, then Boyle's law between two volumes."""
    moles = p0_kpa_abs * 1e3 * volume_ml * 1e-6 / (8.314462618 * 293.15)
    gas_kpa_ml = moles * 8.314462618 * 293.15 * 1e3
    squeezed = sealed_pressure(gas_kpa_ml, share * volume_ml)
    assert squeezed + 101.325 == pytest.approx(p0_kpa_abs / share, rel=1e-9)
