import numpy as np
import pytest

from fprc.config import Settings
from fprc.devices.sim import SimulatedRig
from fprc.rig.parameters import record
from fprc.rig.reservoir import squeeze_rate

ATMOSPHERE_KPA = 101.325
DEFAULT = Settings().rig.reservoir.model_dump()


def fabric(**changed):
    return record(DEFAULT | changed)[0]


def gas_volume(states):
    bent = DEFAULT["bending_volume_ml_per_deg"] * states["phi_deg"]
    return DEFAULT["passive_volume_ml"] - states["squeezed_ml"] - bent


def test_suction_in_the_active_chamber_leaves_friction_at_its_dry_value():
    parameters = fabric(friction_kpa=5.0, friction_per_kpa=0.1)
    precharge = DEFAULT["precharge_kpa"]
    without, with_slip = (squeeze_rate(parameters, 1.0, z, -50.0, precharge) for z in (0.0, 1.0))
    assert (without - with_slip) * DEFAULT["squeeze_damping_kpa_s_per_ml"] == pytest.approx(5.0)


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


def test_push_on_the_reservoir_bends_it_but_hardly_reaches_its_pressure(quiet_rig):
    """The paper's disturbance: tens of degrees of bending, next to nothing in P_o."""
    ends = []
    for push in (0.0, 150.0):
        device = SimulatedRig(quiet_rig, seed=1, run=0, sample_rate_hz=200.0)
        device.push_kpa = push
        for k in range(400):
            device.wait_for(k)
            device.write(0.0, np.clip(5.0 + 0.05 * (200.0 - device.read().p_i_kpa), 0.0, 10.0))
        ends.append(device.read())
    free, pushed = ends
    stiffness = quiet_rig["reservoir"]["bending_stiffness_kpa_per_deg"]
    assert pushed.phi_deg - free.phi_deg == pytest.approx(150.0 / stiffness, rel=0.1)
    assert 0.0 < pushed.p_o_kpa - free.p_o_kpa < 2.0


def test_fabric_is_only_squeezed_never_stretched(quiet_rig):
    """A push bends the reservoir and raises P_o; the fabric rests at zero squeeze."""
    quiet_rig["valve"]["leak"] = 0.0
    device = SimulatedRig(quiet_rig, seed=1, run=0, sample_rate_hz=200.0)
    device.push_kpa = 300.0
    device.write(0.0, 0.0)
    device.wait_for(200)
    state = device.state
    assert state["squeezed_ml"][0] == 0.0
    assert state["phi_deg"][0] > 20.0
    expected = state["passive_gas_kpa_ml"] / gas_volume(state) - ATMOSPHERE_KPA
    assert state["sensed_kpa"][0, 2] == pytest.approx(expected[0], abs=0.01)
    assert expected[0] > DEFAULT["precharge_kpa"] + 0.5
