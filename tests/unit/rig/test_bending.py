import copy

import numpy as np
import pytest
from scipy.optimize import brentq

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
