from unittest.mock import Mock

import pytest

from fprc.apparatus.safety import CheckedRig
from fprc.channels import Readings
from fprc.config import Settings
from fprc.errors import SafetyError

PERIOD_S = 0.005
REST = {"p_exp_kpa": 0.1, "theta_deg": 0.2, "p_i_kpa": -0.3, "p_o_kpa": 100.0, "phi_deg": 0.4}
QUANTITIES = list(REST)


@pytest.fixture
def rig():
    """A rig that reads ``rig.now``."""
    rig = Mock(now={"time_s": 0.0} | REST)
    rig.read.side_effect = lambda: Readings(**rig.now)
    return rig


@pytest.fixture
def limits():
    return Settings().model_dump()["hardware"]["limits"]


@pytest.fixture
def guarded(rig, limits):
    return CheckedRig(rig, limits, PERIOD_S)


def step(rig, guarded, ticks=1, **values):
    """Advance time; every sensor without a given value has noise."""
    for _ in range(ticks):
        k = round(rig.now["time_s"] / PERIOD_S) + 1
        noisy = {name: value + 0.01 * (k % 2) for name, value in REST.items()}
        rig.now = {"time_s": k * PERIOD_S} | noisy | values
        now = guarded.read()
    return now


def refusal(rig, guarded, **values):
    with pytest.raises(SafetyError) as caught:
        step(rig, guarded, **values)
    return str(caught.value)


@pytest.mark.parametrize("name", QUANTITIES)
@pytest.mark.parametrize("end", [0, 1])
def test_every_reading_is_stopped_beyond_either_limit(rig, limits, name, end):
    limits |= {"pressure_step_kpa": 1e6, "angle_step_deg": 1e6}
    guarded = CheckedRig(rig, limits, PERIOD_S)
    low, high = limits[name]
    edge, beyond = (low, low - 0.1) if end == 0 else (high, high + 0.1)
    assert step(rig, guarded, **{name: edge})
    text = refusal(rig, guarded, **{name: beyond})
    assert text.startswith(f"{name} = {beyond:.1f} is outside {low:g} to {high:g} ")


def test_first_reading_is_checked_too(rig, guarded):
    rig.now["p_o_kpa"] = 0.0  # PAM B was not filled
    with pytest.raises(SafetyError, match=r"p_o_kpa = 0\.0 is outside 20 to 400"):
        guarded.read()


@pytest.mark.parametrize("name", QUANTITIES)
@pytest.mark.parametrize("value", [float("nan"), float("inf"), float("-inf")])
def test_reading_that_is_no_number_stops_the_run(rig, guarded, name, value):
    step(rig, guarded)
    assert refusal(rig, guarded, **{name: value}).startswith(f"{name}: ")


@pytest.mark.parametrize(("name", "jump"), [("p_exp_kpa", 60.0), ("theta_deg", 15.0)])
@pytest.mark.parametrize("periods", [1, 4])
def test_jump_is_judged_by_the_time_that_passed(rig, guarded, name, jump, periods):
    step(rig, guarded, 2, **{name: 1.0})
    rig.now["time_s"] += (periods - 1) * PERIOD_S
    step(rig, guarded, **{name: 1.0 + 0.99 * jump * periods})
    rig.now["time_s"] += (periods - 1) * PERIOD_S
    text = refusal(rig, guarded, **{name: 1.0 - 0.03 * jump * periods})
    assert all(part in text for part in (name, f"in {periods:.1f} samples", f"{jump:g} per"))


@pytest.mark.parametrize("name", QUANTITIES)
def test_sensor_that_repeats_one_value_is_stopped_after_the_time_allowed(rig, guarded, name):
    step(rig, guarded, 3)
    step(rig, guarded, 51, **{name: REST[name] + 0.5})  # the first of them is new
    text = refusal(rig, guarded, **{name: REST[name] + 0.5})
    assert all(part in text for part in (name, f"{REST[name] + 0.5:g} for 0.26 s", "stale_s"))


def test_reservoir_without_angle_sensor_is_not_asked_for_one(rig, limits):
    guarded = CheckedRig(rig, limits, PERIOD_S, phi=False)
    step(rig, guarded, 100, phi_deg=float("nan"))
    assert "theta_deg" in refusal(rig, guarded, theta_deg=float("nan"), phi_deg=float("nan"))


@pytest.mark.parametrize("wrong", [-1e-9, 10.0 + 1e-9, float("nan"), float("inf")])
@pytest.mark.parametrize("place", [0, 1])
def test_voltage_that_no_valve_takes_is_never_written(rig, guarded, place, wrong):
    volts = [5.0, 5.0]
    volts[place] = wrong
    with pytest.raises(SafetyError, match=f"valve of the {('actuator', 'reservoir')[place]}"):
        guarded.write(*volts)
    assert rig.method_calls == []
