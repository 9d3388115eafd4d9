"""Parts of the rig against closed forms and solvers."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.integrate import solve_ivp

from fprc.config import Settings
from fprc.devices.sim import SimulatedRig
from fprc.rig.mechanics import angular_acceleration, bouc_wen, squeeze_rate
from fprc.rig.pneumatics import mass_flow
from fprc.rig.simulator import draw_instruments, pressure_voltage, record

ATMOSPHERE_KPA = 101.325
RIG = Settings().rig
MUSCLE, SENSOR = (record(part.model_dump())[0] for part in (RIG.bending, RIG.pressure_sensor))
RESERVOIR = RIG.reservoir.model_dump()
DELTA = np.array([1.0, 3.0, 7.0, 14.0])
WEIGHT = np.array([0.3, 0.3, 0.25, 0.15])
#: Slip distance of the Bouc-Wen element that stands for DELTA and WEIGHT.
ONE = 0.8 * np.dot(WEIGHT, DELTA)


def test_suction_leaves_friction_at_its_dry_value():
    relaxed = np.zeros(len(MUSCLE["relaxation_time_s"]))
    rates = [angular_acceleration(MUSCLE, 0.0, 0.0, relaxed, z, -80.0, 0.0) for z in (0.0, 1.0)]
    found = float(MUSCLE["inertia_kpa_s2_per_deg"]) * (rates[0] - rates[1])
    assert found == pytest.approx(float(MUSCLE["friction_kpa"]))
    fabric = record(RESERVOIR | {"friction_kpa": 5.0, "friction_per_kpa": 0.1})[0]
    rates = [squeeze_rate(fabric, 1.0, z, -50.0, RESERVOIR["precharge_kpa"]) for z in (0.0, 1.0)]
    found = (rates[0] - rates[1]) * RESERVOIR["squeeze_damping_kpa_s_per_ml"]
    assert found == pytest.approx(5.0)


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


@given(st.floats(50.0, 800.0), st.floats(50.0, 800.0), st.floats(0.2, 0.5))
def test_flow_reverses_when_the_pressures_swap_and_has_a_finite_slope(p1, p2, b):
    assert mass_flow(4.0, p1, p2, b) == -mass_flow(4.0, p2, p1, b)
    gaps_kpa = np.array([1e-9, 1e-6, 1e-3, 1.0])
    slopes = [mass_flow(4.0, 600.0, 600.0 - gap, b) / gap for gap in gaps_kpa]
    np.testing.assert_allclose(slopes, slopes[-1], rtol=1e-4)


@given(st.integers(0, 2**31), st.sampled_from([0.0, 0.003, 0.007, 0.01]))
def test_drawn_instruments_keep_the_linearity_of_the_data_sheet(seed, linearity):
    rig = {"pressure_sensor": {"linearity": linearity}}
    drawn = draw_instruments(rig, np.random.default_rng([seed]))[0]
    for sensor in range(3):
        gain, offset, bow = (float(drawn[name][sensor]) for name in ("gain", "offset", "bow"))
        for p_kpa in (0.0, 250.0, 500.0, 750.0, 1000.0):
            volts = pressure_voltage(SENSOR, p_kpa, gain, offset, bow, 0.0)
            assert abs(volts - (1.0 + 0.004 * p_kpa)) <= linearity * 4.0 + 1e-12


def test_leak_empties_the_passive_chamber_exponentially(quiet_rig):
    leak = 0.01
    quiet_rig["valve"]["leak"] = 0.0
    quiet_rig["reservoir"] |= {
        "leak_ml_per_s_kpa": leak,
        "back_pressure_gain": 0.0,
        "bending_volume_ml_per_deg": 0.0,
    }
    device = SimulatedRig(quiet_rig, seed=1, run=0, sample_rate_hz=200.0)
    device.write(0.0, 0.0)
    rate_hz = leak * ATMOSPHERE_KPA / RESERVOIR["passive_volume_ml"]
    for t in (0.5, 5.0, 20.0):
        device.wait_for(round(200 * t))
        left_kpa = RESERVOIR["precharge_kpa"] * np.exp(-rate_hz * t)
        assert device.state["sensed_kpa"][0, 2] == pytest.approx(left_kpa, rel=2e-4)


def test_push_bends_the_reservoir_hardly_reaches_its_pressure_and_stretches_no_fabric(quiet_rig):
    """The paper's disturbance: tens of degrees of bending, next to nothing in P_o."""
    quiet_rig["valve"]["leak"] = 0.0
    ends = []
    for push in (0.0, 150.0):
        device = SimulatedRig(quiet_rig, seed=1, run=0, sample_rate_hz=200.0)
        device.push_kpa = push
        device.write(0.0, 0.0)
        device.wait_for(400)
        ends.append(device.read())
        assert device.state["squeezed_ml"][0] == pytest.approx(0.0, abs=1e-9)
    free, pushed = ends
    stiffness = quiet_rig["reservoir"]["bending_stiffness_kpa_per_deg"]
    assert pushed.phi_deg - free.phi_deg == pytest.approx(150.0 / stiffness, rel=0.1)
    assert 0.0 < pushed.p_o_kpa - free.p_o_kpa < 2.0
