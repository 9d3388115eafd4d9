import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from fprc.config import Settings
from fprc.control import PressurePI

finite = st.floats(-1e6, 1e6)
gains = st.floats(0.0, 1.0)


def test_constant_error_is_answered_by_the_closed_form_of_a_pi_loop():
    loop = PressurePI(0.03, 0.002, 0.005)
    for k in range(1, 401):
        expected = 5.0 + 0.03 * 12.0 + 0.002 * 12.0 * 0.005 * k
        assert loop.step(112.0, 100.0) == pytest.approx(expected, rel=1e-12)


def test_gains_of_the_paper_leave_a_standing_error_alone():
    """5 kPa for 100 s move the valve by 0.5 mV: less than two steps of the board."""
    settings = Settings().control.main_loop
    loop = PressurePI(**settings.model_dump(), period_s=0.005)
    first = loop.step(5.0, 0.0)
    for _ in range(20_000):
        last = loop.step(5.0, 0.0)
    assert first == pytest.approx(5.0 + 0.15, abs=1e-6)
    assert last - first == pytest.approx(0.5e-3, rel=1e-3)


def test_no_error_leaves_the_valve_closed():
    assert PressurePI(0.03, 1e-6, 0.005).step(70.0, 70.0) == 5.0


def test_too_low_a_pressure_opens_the_supply_and_too_high_a_one_the_exhaust():
    loop = PressurePI(0.03, 0.0, 0.005)
    assert loop.step(110.0, 100.0) == pytest.approx(5.3)
    assert loop.step(90.0, 100.0) == pytest.approx(4.7)


@pytest.mark.parametrize(("error", "volts"), [(1000.0, 10.0), (-1000.0, 0.0)])
def test_output_is_clamped_to_the_board(error, volts):
    assert PressurePI(0.03, 0.0, 0.005).step(error, 0.0) == volts


@pytest.mark.parametrize("error", [1000.0, -1000.0])
def test_integral_does_not_wind_up_while_the_output_is_clamped(error):
    loop = PressurePI(0.03, 0.5, 0.005)
    for _ in range(20_000):
        loop.step(error, 0.0)
    assert loop.step(0.0, 0.0) == pytest.approx(5.0)


def test_integral_alone_leaves_the_clamp_as_soon_as_the_error_turns():
    loop = PressurePI(0.0, 1.0, 0.005)
    for _ in range(1000):
        loop.step(100.0, 0.0)
    assert loop.step(100.0, 0.0) == 10.0
    assert loop.step(-100.0, 0.0) < 10.0


@given(gains, gains, st.lists(st.tuples(finite, finite), min_size=1, max_size=30))
def test_output_always_is_a_voltage_of_the_board(kp, ki, samples):
    loop = PressurePI(kp, ki, 0.005)
    assert all(0.0 <= loop.step(*sample) <= 10.0 for sample in samples)


@given(st.floats(0.01, 1.0), finite, finite)
def test_proportional_output_rises_with_the_set_point(kp, measured, setpoint):
    higher = PressurePI(kp, 0.0, 0.005).step(setpoint + 1.0, measured)
    assert higher >= PressurePI(kp, 0.0, 0.005).step(setpoint, measured)


def test_neutral_voltage_and_limit_can_be_those_of_another_board():
    loop = PressurePI(0.03, 0.0, 0.005, neutral_v=2.5, limit_v=5.0)
    assert loop.step(0.0, 0.0) == 2.5
    assert loop.step(1e3, 0.0) == 5.0


@pytest.mark.parametrize(
    "sample", [(math.nan, 100.0), (100.0, math.nan), (math.inf, 0.0), (math.inf, math.inf)]
)
def test_sample_that_is_not_finite_is_refused_and_leaves_the_integral_alone(sample):
    loop = PressurePI(0.03, 1e-6, 0.005)
    with pytest.raises(ValueError, match="must be finite"):
        loop.step(*sample)
    assert loop.step(110.0, 100.0) == pytest.approx(5.3, abs=1e-4)
