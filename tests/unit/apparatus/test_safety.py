from unittest.mock import Mock

import pytest

from fprc.apparatus.safety import CheckedRig
from fprc.channels import Readings
from fprc.config import Settings
from fprc.errors import SafetyError

PERIOD_S = 0.005
REST = {"p_exp_kpa": 0.1, "theta_deg": 0.2, "p_i_kpa": -0.3, "p_o_kpa": 100.0, "phi_deg": 0.4}
SENSORS = pytest.mark.parametrize("name", REST)


@pytest.fixture
def limits():
    return Settings().model_dump()["hardware"]["limits"]


class Watched:
    """A checked rig whose sensors have noise, but for those that are given a value."""

    def __init__(self, limits, **options):
        self.rig, self.k = Mock(), 0
        self.checked = CheckedRig(self.rig, limits, PERIOD_S, **options)
        self.read()

    def read(self, ticks=1, **values):
        for _ in range(ticks):
            self.k += 1
            noisy = {name: value + 0.01 * (self.k % 2) for name, value in REST.items()}
            self.rig.read.return_value = Readings(self.k * PERIOD_S, **noisy | values)
            now = self.checked.read()
        return now

    def refusal(self, **values):
        with pytest.raises(SafetyError) as caught:
            self.read(**values)
        return str(caught.value)


@SENSORS
def test_every_reading_is_stopped_beyond_either_limit_and_if_it_is_no_number(limits, name):
    limits |= {"pressure_step_kpa": 1e6, "angle_step_deg": 1e6}
    low, high = limits[name]
    for edge, beyond in ((low, low - 0.1), (high, high + 0.1), (high, float("nan"))):
        rig = Watched(limits)
        assert rig.read(**{name: edge})
        assert rig.refusal(**{name: beyond}).startswith(f"{name} = {beyond:.1f} is outside ")


def test_first_reading_is_checked_too(limits):
    with pytest.raises(SafetyError, match=r"p_o_kpa = 100\.0 is outside 120 to 400"):
        Watched(limits | {"p_o_kpa": (120.0, 400.0)})  # PAM B was not filled


@pytest.mark.parametrize(("name", "jump"), [("p_exp_kpa", 60.0), ("theta_deg", 15.0)])
@pytest.mark.parametrize("periods", [1, 4])
def test_jump_is_judged_by_the_time_that_passed(limits, name, jump, periods):
    rig = Watched(limits)
    rig.read(**{name: 1.0})
    rig.k += periods - 1
    rig.read(**{name: 1.0 + 0.99 * jump * periods})
    rig.k += periods - 1
    text = rig.refusal(**{name: 1.0 - 0.03 * jump * periods})
    assert all(part in text for part in (name, f"in {periods:.1f} samples", f"{jump:g} per"))


@SENSORS
def test_sensor_that_repeats_one_value_is_stopped_after_the_time_allowed(limits, name):
    rig, held = Watched(limits), {name: REST[name] + 0.5}
    rig.read(51, **held)  # the first of them is new
    text = rig.refusal(**held)
    assert all(part in text for part in (name, f"{held[name]:g} for 0.26 s", "stale_s"))


def test_reservoir_without_angle_sensor_is_not_asked_for_one(limits):
    rig = Watched(limits, phi=False)
    rig.read(100, phi_deg=float("nan"))


@pytest.mark.parametrize("wrong", [-1e-9, 10.0 + 1e-9, float("nan"), float("inf")])
@pytest.mark.parametrize("at", [0, 1])
def test_voltage_that_no_valve_takes_is_never_written(limits, wrong, at):
    rig = Watched(limits)
    with pytest.raises(SafetyError):
        rig.checked.write(*[(wrong, 5.0), (5.0, wrong)][at])
    rig.rig.write.assert_not_called()
