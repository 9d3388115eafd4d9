import numpy as np
import pytest

from fprc.channels import Readings
from fprc.control import hysteresis_law


def bent(theta_deg):
    return Readings(0.0, 0.0, theta_deg, 0.0, 100.0, 0.0)


def test_commanded_pressure_is_the_signal_sample_by_sample():
    signal = np.linspace(0.0, 350.0, 11)
    law = hysteresis_law(signal, 7.0, 450.0)
    assert [law(k, bent(10.0))[0] for k in range(11)] == signal.tolist()


@pytest.mark.parametrize(
    ("theta_deg", "p_i_kpa"), [(30.0, 210.0), (64.0, 448.0), (64.5, 450.0), (0.0, 0.0), (-2.0, 0.0)]
)
def test_reservoir_gets_seven_kpa_per_degree_within_its_limits(theta_deg, p_i_kpa):
    law = hysteresis_law(np.zeros(1), 7.0, 450.0)
    assert law(0, bent(theta_deg))[1] == pytest.approx(p_i_kpa)
