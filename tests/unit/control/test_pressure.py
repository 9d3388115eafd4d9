import math

import pytest

from fprc.control import PressurePI


def test_constant_error_is_answered_by_the_closed_form_of_a_pi_loop():
    loop = PressurePI(0.03, 0.002, 0.005)
    for k in range(1, 401):
        expected = 5.0 + 0.03 * 12.0 + 0.002 * 12.0 * 0.005 * k
        assert loop.step(112.0, 100.0) == pytest.approx(expected, rel=1e-12)


@pytest.mark.parametrize("error", [1000.0, -1000.0])
def test_integral_does_not_wind_up_while_the_output_is_clamped(error):
    loop = PressurePI(0.03, 0.5, 0.005)
    for _ in range(20_000):
        loop.step(error, 0.0)
    assert loop.step(0.0, 0.0) == pytest.approx(5.0)


@pytest.mark.parametrize(
    "sample", [(math.nan, 100.0), (100.0, math.nan), (math.inf, 0.0), (math.inf, math.inf)]
)
def test_sample_that_is_not_finite_is_refused_and_leaves_the_integral_alone(sample):
    loop = PressurePI(0.03, 1e-6, 0.005)
    with pytest.raises(ValueError, match="must be finite"):
        loop.step(*sample)
    assert loop.step(110.0, 100.0) == pytest.approx(5.3, abs=1e-4)
