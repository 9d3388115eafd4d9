import numpy as np
import pytest
from scipy.integrate import solve_ivp, trapezoid
from scipy.optimize import brentq

from fprc.config import Settings
from fprc.control import PressurePI
from fprc.devices.sim import SimulatedRig
from fprc.rig.parameters import record
from fprc.rig.reservoir import bending_rate, squeeze_rate

ATMOSPHERE_KPA = 101.325
DEFAULT = Settings().rig.reservoir.model_dump()


def fabric(**changed):
    return record(DEFAULT | changed)[0]


def gas_law(squeezed_ml):
    """Gauge pressure of the passive chamber after an isothermal squeeze (Boyle)."""
    volume = DEFAULT["passive_volume_ml"]
    sealed_at = DEFAULT["precharge_kpa"] + ATMOSPHERE_KPA
    return sealed_at * volume / (volume - squeezed_ml) - ATMOSPHERE_KPA


def gas_volume(states):
    bent = DEFAULT["bending_volume_ml_per_deg"] * states["phi_deg"]
    return DEFAULT["passive_volume_ml"] - states["squeezed_ml"] - bent


@pytest.fixture
def pressurise(quiet_rig):
    """Hold PAM A at the given pressures for a while each; return the states of all ticks."""

    def run(levels_kpa, seconds=0.5, **reservoir):
        quiet_rig["reservoir"] |= reservoir
        device = SimulatedRig(quiet_rig, seed=1, run=0, sample_rate_hz=200.0)
        loop = PressurePI(0.05, 1e-6, 0.005)
        states = []
        for k in range(round(200 * seconds) * len(levels_kpa)):
            device.wait_for(k)
            level = levels_kpa[k // round(200 * seconds)]
            device.write(0.0, loop.step(level, device.read().p_i_kpa))
            states.append(device.state)
        return np.concatenate(states)

    return run


@pytest.mark.parametrize("p_active", [50.0, 200.0, 420.0])
@pytest.mark.parametrize("slip", [-1.0, 0.0, 1.0])
def test_squeeze_rests_at_the_root_of_the_force_balance(p_active, slip):
    parameters = fabric(
        friction_kpa=5.0,
        friction_per_kpa=0.1,
        squeeze_stiffness_kpa_per_ml=35.0,
        back_pressure_gain=1.0,
    )

    def balance(s):
        friction = (5.0 + 0.1 * p_active) * slip
        return p_active - friction - 35.0 * s - (gas_law(s) - DEFAULT["precharge_kpa"])

    s = brentq(balance, -5.0, 20.0)
    assert squeeze_rate(parameters, s, slip, p_active, gas_law(s)) == pytest.approx(0, abs=1e-8)
    assert squeeze_rate(parameters, s - 0.1, slip, p_active, gas_law(s - 0.1)) > 0.0
    assert squeeze_rate(parameters, s + 0.1, slip, p_active, gas_law(s + 0.1)) < 0.0


def test_squeeze_creeps_with_the_time_constant_of_fabric_and_damping():
    parameters = fabric(back_pressure_gain=0.0)
    c = DEFAULT["squeeze_damping_kpa_s_per_ml"]
    k = DEFAULT["squeeze_stiffness_kpa_per_ml"]
    t = np.linspace(0.0, 4.0 * c / k, 21)
    creep = solve_ivp(
        lambda _, s: [squeeze_rate(parameters, s[0], 0.0, 100.0, 0.0)],
        (0.0, t[-1]),
        (0.0,),
        t_eval=t,
        rtol=1e-9,
        atol=1e-10,
    )
    np.testing.assert_allclose(creep.y[0], 100.0 / k * (1.0 - np.exp(-k * t / c)), atol=1e-6)


def test_suction_in_the_active_chamber_leaves_friction_at_its_dry_value():
    parameters = fabric(friction_kpa=5.0, friction_per_kpa=0.1)
    precharge = DEFAULT["precharge_kpa"]
    without, with_slip = (squeeze_rate(parameters, 1.0, z, -50.0, precharge) for z in (0.0, 1.0))
    assert (without - with_slip) * DEFAULT["squeeze_damping_kpa_s_per_ml"] == pytest.approx(5.0)


def test_sealed_chamber_keeps_its_gas_and_obeys_the_gas_law(pressurise):
    states = pressurise([200.0, 400.0, 0.0, 300.0])
    gas = states["passive_gas_kpa_ml"]
    assert (gas == gas[0]).all()
    volume = gas_volume(states)
    # the transducer follows within its lag, here shorter than a tick
    sensed = states["sensed_kpa"][:, 2]
    still = np.abs(states["sensed_rate_kpa_per_s"][:, 2]) < 1.0
    assert still.sum() > 50
    np.testing.assert_allclose(sensed[still], gas[0] / volume[still] - ATMOSPHERE_KPA, atol=0.01)
    assert np.ptp(sensed) > 20.0


def test_squeezed_chamber_never_falls_below_its_precharge(pressurise):
    states = pressurise([200.0, 0.0, 420.0, 0.0], bending_volume_ml_per_deg=0.0)
    assert states["sensed_kpa"][:, 2].min() >= DEFAULT["precharge_kpa"] - 1e-9
    assert states["squeezed_ml"].min() >= 0.0


def test_squeeze_shows_hysteresis_at_equal_active_pressure(pressurise):
    states = pressurise([100.0, 200.0, 300.0, 420.0, 300.0, 200.0, 100.0])
    ends = states[99::100]
    up, down = ends[:3], ends[-1:-4:-1]
    np.testing.assert_allclose(up["p_i_kpa_abs"], down["p_i_kpa_abs"], atol=8.0)
    assert (down["sensed_kpa"][:, 2] > up["sensed_kpa"][:, 2] + 3.0).all()


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
    rate_hz = leak * ATMOSPHERE_KPA / DEFAULT["passive_volume_ml"]
    for t in (0.5, 5.0, 20.0):
        device.wait_for(round(200 * t))
        left_kpa = DEFAULT["precharge_kpa"] * np.exp(-rate_hz * t)
        assert device.state["sensed_kpa"][0, 2] == pytest.approx(left_kpa, rel=2e-4)


def test_gas_lost_through_the_leak_is_what_flowed_out(pressurise):
    leak = 0.005
    states = pressurise([300.0, 0.0, 200.0], leak_ml_per_s_kpa=leak)
    gas = states["passive_gas_kpa_ml"]
    assert (np.diff(gas) < 0.0).all()
    p_o = gas / gas_volume(states) - ATMOSPHERE_KPA
    outflow_ml = leak * trapezoid(p_o, states["time_s"])
    assert gas[0] - gas[-1] == pytest.approx(ATMOSPHERE_KPA * outflow_ml, rel=5e-3)


def test_bending_of_the_actuator_leaves_the_reservoir_alone(quiet_rig):
    """The squeeze hangs on PAM A alone: the paper's reason why disturbances spare P_o."""
    readings = []
    for main_v in (0.0, 6.5):
        device = SimulatedRig(quiet_rig, seed=1, run=0, sample_rate_hz=200.0)
        device.write(main_v, 5.6)
        device.wait_for(60)
        readings.append(device.read())
    still, bent = readings
    assert bent.theta_deg > still.theta_deg + 10.0
    assert (still.p_i_kpa, still.p_o_kpa) == (bent.p_i_kpa, bent.p_o_kpa)
    assert still.p_i_kpa > 20.0


def test_own_bending_approaches_the_pressure_difference_over_its_stiffness():
    parameters = fabric(bending_stiffness_kpa_per_deg=9.0, bending_time_s=0.08)
    precharge = DEFAULT["precharge_kpa"]
    t = np.linspace(0.0, 0.4, 21)
    bend = solve_ivp(
        lambda _, phi: [bending_rate(parameters, phi[0], 250.0, precharge + 30.0, 50.0)],
        (0.0, t[-1]),
        (0.0,),
        t_eval=t,
        rtol=1e-9,
        atol=1e-10,
    )
    rest = (250.0 - 30.0 + 50.0) / 9.0
    np.testing.assert_allclose(bend.y[0], rest * (1.0 - np.exp(-t / 0.08)), atol=1e-6)
    assert bending_rate(parameters, 0.0, 0.0, precharge, 0.0) == 0.0


def test_push_on_the_reservoir_bends_it_but_hardly_reaches_its_pressure(quiet_rig):
    """The paper's disturbance: tens of degrees of bending, next to nothing in P_o."""
    ends = []
    for push in (0.0, 150.0):
        device = SimulatedRig(
            quiet_rig, seed=1, run=0, sample_rate_hz=200.0, push_kpa=lambda tick, push=push: push
        )
        loop = PressurePI(0.05, 1e-6, 0.005)
        for k in range(400):
            device.wait_for(k)
            device.write(0.0, loop.step(200.0, device.read().p_i_kpa))
        ends.append(device.read())
    free, pushed = ends
    stiffness = quiet_rig["reservoir"]["bending_stiffness_kpa_per_deg"]
    assert pushed.phi_deg - free.phi_deg == pytest.approx(150.0 / stiffness, rel=0.1)
    assert 0.0 < pushed.p_o_kpa - free.p_o_kpa < 2.0


def test_fabric_is_only_squeezed_never_stretched(quiet_rig):
    """A push bends the reservoir and raises P_o; the fabric rests at zero squeeze."""
    quiet_rig["valve"]["leak"] = 0.0
    device = SimulatedRig(
        quiet_rig, seed=1, run=0, sample_rate_hz=200.0, push_kpa=lambda tick: 300.0
    )
    device.write(0.0, 0.0)
    device.wait_for(200)
    state = device.state
    assert state["squeezed_ml"][0] == 0.0
    assert state["phi_deg"][0] > 20.0
    expected = state["passive_gas_kpa_ml"] / gas_volume(state) - ATMOSPHERE_KPA
    assert state["sensed_kpa"][0, 2] == pytest.approx(expected[0], abs=0.01)
    assert expected[0] > DEFAULT["precharge_kpa"] + 0.5
