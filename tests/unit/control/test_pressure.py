import pytest

from fprc.control_laws import NEUTRAL_V, pressure_step


def test_constant_error_is_answered_by_the_closed_form_of_a_pi_loop():
    integral = 0.0
    for k in range(1, 401):
        expected = 5.0 + 0.03 * 12.0 + 0.002 * 12.0 * 0.005 * k
        volts, integral = pressure_step(12.0, integral, 0.03, 0.002, 0.005, NEUTRAL_V)
        assert volts == pytest.approx(expected, rel=1e-12)


@pytest.mark.parametrize("error", [1000.0, -1000.0])
def test_integral_does_not_wind_up_while_the_output_is_clamped(error):
    integral = 0.0
    for _ in range(20_000):
        _, integral = pressure_step(error, integral, 0.03, 0.5, 0.005, NEUTRAL_V)
    volts, _ = pressure_step(0.0, integral, 0.03, 0.5, 0.005, NEUTRAL_V)
    assert volts == pytest.approx(5.0)
