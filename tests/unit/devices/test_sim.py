import pytest

from fprc.devices.sim import SimulatedRig


@pytest.fixture
def device(rig):
    return SimulatedRig(rig, seed=1, run=0, sample_rate_hz=200.0)


def history(device, ticks, volts=(6.0, 5.5)):
    device.write(*volts)
    readings = []
    for k in range(ticks):
        device.wait_for(k)
        readings.append(device.read())
    return readings


def test_waiting_in_one_go_equals_waiting_tick_by_tick(rig):
    at_once = SimulatedRig(rig, seed=3, run=0, sample_rate_hz=200.0)
    stepwise = SimulatedRig(rig, seed=3, run=0, sample_rate_hz=200.0)
    at_once.write(6.0, 5.5)
    at_once.wait_for(200)
    history(stepwise, 201)
    assert at_once.state == stepwise.state
    assert at_once.read() == stepwise.read()


def test_rig_that_is_made_safe_vents_both_chambers(device):
    device.write(6.5, 6.5)
    device.wait_for(100)
    assert min(device.read().p_exp_kpa, device.read().p_i_kpa) > 150.0
    device.safe()
    device.wait_for(600)
    assert max(device.read().p_exp_kpa, device.read().p_i_kpa) < 12.0
