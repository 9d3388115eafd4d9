import math

import numpy as np
import pytest

from fprc.control_laws import NEUTRAL_V, pd_step, pressure_step

PERIOD_S = 0.005
KP, KD = 0.5, 0.005  # paper, Sec. IV


def controller(kp, kd, period_s=PERIOD_S, incremental=True, highest_kpa=math.inf):
    memory = [math.nan, 0.0]

    def step(error, p_ff=0.0, theta=0.0):
        return pd_step(memory, error, theta, p_ff, incremental, kp, kd, period_s, 0.0, highest_kpa)

    return step


def feedback(step, e, p_ff=None):
    p_ff = np.zeros(len(e)) if p_ff is None else p_ff
    return np.array([step(error, ff) for error, ff in zip(e, p_ff, strict=True)])


def authors_commands(e, u_ff, kp, kd, T):  # noqa: N803 (the equation's symbol)
    """u(k) = u(k-1) + u_ff(k) - u_ff(k-1) + kp e(k) + kd (e(k) - e(k-1)) / T, from u = u_ff."""
    u = [u_ff[0] + kp * e[0]]
    for k in range(1, len(e)):
        u.append(u[-1] + u_ff[k] - u_ff[k - 1] + kp * e[k] + kd * (e[k] - e[k - 1]) / T)
    return np.array(u)


def test_incremental_law_is_the_authors_equation():
    rng = np.random.default_rng(1)
    e, p_ff = rng.normal(0.0, 5.0, 400), rng.uniform(1e3, 1350.0, 400)
    pd = controller(KP, KD)
    commands = p_ff + feedback(pd, e, p_ff)
    np.testing.assert_allclose(commands, authors_commands(e, p_ff, KP, KD, PERIOD_S), atol=1e-9)


def test_positional_law_is_proportional_and_backward_difference():
    e = np.random.default_rng(1).uniform(-60.0, 60.0, 50)
    found = feedback(controller(3.0, 0.02, 0.01, incremental=False), e)
    np.testing.assert_allclose(found, 3.0 * e + 0.02 * np.diff(e, prepend=e[0]) / 0.01)


@pytest.mark.parametrize(
    ("p_ff", "error", "bound"), [(300.0, 40.0, 400.0), (50.0, -40.0, 0.0)], ids=["high", "low"]
)
def test_sum_does_not_wind_up_at_a_limit(p_ff, error, bound):
    pd = controller(KP, 0.0, highest_kpa=400.0)
    held = [p_ff + pd(error, p_ff) for _ in range(2000)]
    assert max(abs(p_d - bound) for p_d in held[100:]) <= KP * abs(error)
    # one sample of error to the other side leads off the limit at once
    assert abs(p_ff + pd(-error, p_ff) - bound) <= 2.0 * KP * abs(error)
    back = p_ff + pd(-error, p_ff)
    assert 0.0 < back < 400.0


def test_sum_recovers_where_feedforward_alone_is_beyond_a_limit():
    pd = controller(KP, KD, highest_kpa=400.0)
    assert pd(1.0, 500.0) == 0.0  # kp e does not count
    assert pd(-1.0, 500.0) == pytest.approx(-2.0 * KD / PERIOD_S - KP)


@pytest.mark.parametrize("incremental", [True, False])
@pytest.mark.parametrize("at", [0, 1, 30])
@pytest.mark.parametrize("fault", [1e8, -361.0, math.inf])
def test_angle_that_cannot_be_true_changes_nothing(incremental, at, fault):
    angles = 10.0 * np.sin(np.arange(60) / 7.0)
    pd, disturbed = (
        controller(KP, KD, incremental=incremental, highest_kpa=450.0) for _ in range(2)
    )
    p_fb = 0.0
    for k, angle in enumerate(angles):
        if k == at:
            assert disturbed(12.0 - fault, 100.0, fault) == p_fb
        p_fb = pd(12.0 - angle, 100.0, angle)
        assert disturbed(12.0 - angle, 100.0, angle) == p_fb


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
