import copy

import numpy as np
import pytest

from fprc.config import Settings
from fprc.rig.bending import angular_acceleration
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
