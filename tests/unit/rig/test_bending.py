import copy

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

from fprc.config import Settings
from fprc.rig.bending import angular_acceleration, relax
from fprc.rig.parameters import record

DEFAULT = Settings().rig.bending.model_dump()
BRANCHES = len(DEFAULT["relaxation_time_s"])


def muscle(**changed):
    """Parameters of the actuator, without relaxation and friction unless given."""
    values = copy.deepcopy(DEFAULT)
    values["relaxation_stiffness_kpa_per_deg"] = (0.0,) * BRANCHES
    values |= {"friction_kpa": 0.0, "friction_per_kpa": 0.0, "gain_loss_per_deg": 0.0}
    return record(values | changed)[0]


def torque(parameters, theta, *, omega=0.0, relaxed=None, slip=0.0, p=0.0, d=0.0):
    relaxed = np.zeros(BRANCHES) if relaxed is None else np.asarray(relaxed, dtype=float)
    acceleration = angular_acceleration(
        parameters, float(theta), float(omega), relaxed, float(slip), float(p), float(d)
    )
    return float(parameters["inertia_kpa_s2_per_deg"]) * acceleration


@pytest.mark.parametrize("p", [80.0, 200.0, 420.0])
@pytest.mark.parametrize("g0", [0.0, 0.004])
def test_torques_balance_at_the_root_of_the_printed_equation(p, g0):
    parameters = muscle(
        preload_kpa=40.0,
        stiffness_kpa_per_deg=3.0,
        cubic_stiffness_kpa_per_deg3=4e-4,
        gain_loss_per_deg=g0,
    )
    theta = brentq(lambda th: p * (1.0 - g0 * th) - 40.0 - 3.0 * th - 4e-4 * th**3, 0.0, 150.0)
    assert torque(parameters, theta, p=p) == pytest.approx(0.0, abs=1e-9)
    assert torque(parameters, theta - 1.0, p=p) > 3.0
    assert torque(parameters, theta + 1.0, p=p) < -3.0


def test_free_swing_is_the_closed_form_of_a_damped_oscillator():
    j, c, k, p = 6e-4, 0.02, 3.0, 150.0
    parameters = muscle(
        inertia_kpa_s2_per_deg=j,
        damping_kpa_s_per_deg=c,
        preload_kpa=30.0,
        stiffness_kpa_per_deg=k,
        cubic_stiffness_kpa_per_deg3=0.0,
    )
    relaxed = np.zeros(BRANCHES)
    t = np.linspace(0.0, 0.4, 81)
    swing = solve_ivp(
        lambda _, y: (
            y[1],
            angular_acceleration(parameters, y[0], y[1], relaxed, 0.0, p, 0.0),
        ),
        (0.0, t[-1]),
        (50.0, 0.0),
        t_eval=t,
        rtol=1e-9,
        atol=1e-9,
    )
    rest = (p - 30.0) / k
    sigma = c / (2.0 * j)
    wd = np.sqrt(k / j - sigma**2)
    shape = np.exp(-sigma * t) * (np.cos(wd * t) + sigma / wd * np.sin(wd * t))
    np.testing.assert_allclose(swing.y[0], rest + (50.0 - rest) * shape, atol=1e-5)


@pytest.mark.parametrize("frequency_hz", [0.05, 0.6, 5.0])
def test_relaxation_has_the_complex_stiffness_of_standard_linear_solids(frequency_hz):
    stiffness = np.linspace(0.4, 1.2, BRANCHES)
    tau = np.geomspace(0.2, 4.0, BRANCHES)
    elastic = muscle(cubic_stiffness_kpa_per_deg3=0.0)
    solid = muscle(
        cubic_stiffness_kpa_per_deg3=0.0,
        relaxation_stiffness_kpa_per_deg=tuple(stiffness),
        relaxation_time_s=tuple(tau),
    )
    w = 2.0 * np.pi * frequency_hz
    dt = 1.0 / frequency_hz / 2000
    # a swing of 10 deg about 30, begun on the steady cycle
    response = 1.0 / (1.0 + 1j * w * tau)
    relaxed = 30.0 + 10.0 * response.real
    t = dt * np.arange(2001)
    resisted = []
    for theta in 30.0 + 10.0 * np.cos(w * t):
        resisted.append(torque(elastic, theta) - torque(solid, theta, relaxed=relaxed))
        relax(relaxed, float(theta), tau, dt)
    amplitude = 2.0 * np.mean(np.array(resisted[:-1]) * np.exp(-1j * w * t[:-1]))
    expected = 10.0 * np.sum(stiffness * 1j * w * tau / (1.0 + 1j * w * tau))
    assert amplitude == pytest.approx(expected, abs=0.01 * abs(expected))


def test_relaxed_angles_approach_a_held_angle_exponentially():
    tau = np.linspace(0.3, 2.0, BRANCHES)
    relaxed = np.zeros(BRANCHES)
    for _ in range(10_000):
        relax(relaxed, 20.0, tau, 1e-4)
    np.testing.assert_allclose(relaxed, 20.0 * (1.0 - np.exp(-1.0 / tau)), rtol=1e-3)


def test_dry_friction_opposes_the_slip_and_grows_with_pressure():
    parameters = muscle(friction_kpa=4.0, friction_per_kpa=0.08)
    smooth = muscle()

    def friction(slip, p):
        return torque(smooth, 10.0, p=p) - torque(parameters, 10.0, slip=slip, p=p)

    assert friction(1.0, 0.0) == pytest.approx(4.0)
    assert friction(-1.0, 0.0) == pytest.approx(-4.0)
    assert friction(0.5, 300.0) == pytest.approx(0.5 * (4.0 + 0.08 * 300.0))
    # suction must not turn friction into a drive
    assert friction(1.0, -80.0) == pytest.approx(4.0)


def test_disturbance_acts_like_pressure_at_zero_angle():
    parameters = muscle(gain_loss_per_deg=0.004)
    assert torque(parameters, 0.0, d=7.0) == pytest.approx(torque(parameters, 0.0, p=7.0))


def test_damping_takes_energy_in_both_directions():
    parameters = muscle(damping_kpa_s_per_deg=0.05, stop_damping_kpa_s_per_deg=0.2)
    for omega in (-300.0, 300.0):
        drag = torque(parameters, 20.0, omega=omega) - torque(parameters, 20.0)
        assert drag == pytest.approx(-0.05 * omega)
        drag = torque(parameters, -0.1, omega=omega) - torque(parameters, -0.1)
        assert drag == pytest.approx(-0.25 * omega)


def test_stop_carries_the_preload_near_zero_and_is_absent_above():
    parameters = muscle(
        preload_kpa=45.0, stop_stiffness_kpa_per_deg=150.0, stiffness_kpa_per_deg=3.0
    )
    rest = brentq(lambda th: torque(parameters, th), -5.0, 0.0)
    assert rest == pytest.approx(-45.0 / 153.0, rel=1e-3)
    stopless = muscle(preload_kpa=45.0, stop_stiffness_kpa_per_deg=50.0, stiffness_kpa_per_deg=3.0)
    assert torque(parameters, 5.0) == torque(stopless, 5.0)
