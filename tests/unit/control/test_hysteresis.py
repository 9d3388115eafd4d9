import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

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


@given(st.floats(-360.0, 360.0), st.floats(0.1, 20.0), st.floats(100.0, 500.0))
def test_reservoir_is_never_asked_for_more_than_its_limit(theta_deg, k_in, limit):
    p_i = hysteresis_law(np.zeros(1), k_in, limit)(0, bent(theta_deg))[1]
    assert 0.0 <= p_i <= limit


def test_commanded_pressure_does_not_depend_on_the_bending():
    law = hysteresis_law(np.array([10.0, 20.0]), 7.0, 450.0)
    assert law(1, bent(0.0))[0] == law(1, bent(60.0))[0] == 20.0


def test_later_changes_of_the_signal_do_not_reach_the_law():
    signal = np.array([10.0, 20.0])
    law = hysteresis_law(signal, 7.0, 450.0)
    signal[:] = -1.0
    assert law(0, bent(0.0))[0] == 10.0


def test_no_sample_lies_beyond_the_signal():
    with pytest.raises(IndexError):
        hysteresis_law(np.zeros(2), 7.0, 450.0)(2, bent(0.0))
