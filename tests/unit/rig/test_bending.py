import numpy as np
import pytest

from fprc.config import Settings
from fprc.rig.bending import angular_acceleration
from fprc.rig.parameters import record

MUSCLE = record(Settings().rig.bending.model_dump())[0]
RELAXED = np.zeros(len(MUSCLE["relaxation_time_s"]))


def torque(slip=0.0, p=0.0, d=0.0):
    """Torque on the straight actuator at rest."""
    acceleration = angular_acceleration(MUSCLE, 0.0, 0.0, RELAXED, slip, p, d)
    return float(MUSCLE["inertia_kpa_s2_per_deg"]) * acceleration


def test_suction_does_not_turn_friction_into_a_drive():
    friction = torque(p=-80.0) - torque(p=-80.0, slip=1.0)
    assert friction == pytest.approx(float(MUSCLE["friction_kpa"]))


def test_disturbance_acts_like_pressure_at_zero_angle():
    assert torque(d=7.0) == pytest.approx(torque(p=7.0))
