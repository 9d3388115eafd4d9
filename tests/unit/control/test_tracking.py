import numpy as np
import pytest

from fprc.channels import Readings
from fprc.control import PD, refuse_impossible, tracking_law
from fprc.errors import ControlError


def reading(theta_deg=0.0, p_o_kpa=50.0):
    return Readings(0.0, 100.0, theta_deg, 120.0, p_o_kpa, 5.0)


def law_of(theta_d, **options):
    return tracking_law(
        np.asarray(theta_d), k_in_kpa_per_deg=7.0, pressure_limit_kpa=450.0, **options
    )


def test_law_returns_both_setpoints_and_their_parts():
    law = law_of([20.0], feedforward=lambda d, now: 5.0 * d + now.p_o_kpa, feedback=PD(2, 0, 0.005))
    assert law(0, reading(theta_deg=17.0)) == pytest.approx((156.0, 140.0, 20.0, 150.0, 6.0))


def test_part_that_is_left_out_is_zero():
    only_feedforward = law_of([20.0], feedforward=lambda d, now: 80.0)
    assert only_feedforward(0, reading(10.0)) == pytest.approx((80.0, 140.0, 20.0, 80.0, 0.0))
    only_feedback = law_of([20.0], feedback=PD(2.0, 0.0, 0.005))
    assert only_feedback(0, reading(10.0)) == pytest.approx((20.0, 140.0, 20.0, 0.0, 20.0))


def test_law_without_both_parts_is_refused():
    with pytest.raises(ControlError):
        law_of([20.0])


@pytest.mark.parametrize(
    ("p_ff", "p_d"), [(-80.0, 0.0), (-0.5, 0.0), (449.0, 449.0), (451.0, 450.0), (9e9, 450.0)]
)
def test_sum_is_clipped_and_its_parts_are_remembered_as_they_were(p_ff, p_d):
    found = law_of([20.0], feedforward=lambda d, now: p_ff)(0, reading())
    assert found == pytest.approx((p_d, 140.0, 20.0, p_ff, 0.0))


def test_every_sample_has_its_own_reference_and_readings():
    seen = []

    def feedforward(theta_d, now):
        seen.append((theta_d, now.p_o_kpa))
        return 0.0

    law = law_of([1.0, 2.0, 3.0], feedforward=feedforward)
    p_i = [law(k, reading(k, 10.0 * k))[1] for k in range(3)]
    assert seen == [(1.0, 0.0), (2.0, 10.0), (3.0, 20.0)]
    assert p_i == pytest.approx([7.0, 14.0, 21.0])


@pytest.mark.parametrize("value", [float("nan"), float("inf"), float("-inf")])
def test_controller_without_a_number_is_refused_and_shown(value):
    feedforward = law_of([20.0], feedforward=lambda d, now: value)
    with pytest.raises(ControlError, match=f"P_ff = {value}, P_fb = 0.0 kPa at theta_d = 20.00"):
        feedforward(0, reading())
    feedback = law_of([20.0], feedback=PD(value, 0.0, 0.005))
    with pytest.raises(ControlError, match=f"P_ff = 0.0, P_fb = {value} kPa"):
        feedback(0, reading())


def play(theta_d, theta, **options):
    """Return the sample at which the law raised, or None."""
    law = law_of(theta_d, feedback=PD(2.0, 0.0, 0.005), **options)
    for k, value in enumerate(theta):
        try:
            law(k, reading(float(value)))
        except ControlError:
            return k
    return None


def test_frozen_bend_sensor_is_noticed_while_the_reference_moves():
    theta_d = 0.1 * np.arange(200)
    theta = np.minimum(theta_d, 5.0)
    assert play(theta_d, theta, stale_samples=40) == 50 + 41


def test_no_alarm_while_the_sensor_still_changes_now_and_then():
    theta = np.repeat(np.arange(25.0), 40)
    assert play(0.1 * np.arange(1000), theta, stale_samples=40) is None


def test_no_alarm_when_the_reference_starts_after_a_long_rest():
    """The sensor may repeat a value this long while the reference moves; rest does not count."""
    theta_d = np.concatenate([np.full(1000, 5.0), 5.0 + 0.2 * np.arange(200)])
    theta = np.concatenate([np.full(1030, 4.0), 4.0 + 0.2 * np.arange(170)])
    assert play(theta_d, theta, stale_samples=40) is None


def test_sensor_that_froze_in_a_rest_is_noticed_after_the_reference_started():
    theta_d = np.concatenate([np.full(1000, 5.0), 5.0 + 0.2 * np.arange(200)])
    noticed = play(theta_d, np.full(1200, 4.0), stale_samples=40)
    assert noticed is not None
    assert 1000 < noticed <= 1060


def refuse(theta_d, low=0.0, high=65.0, limit=450.0):
    refuse_impossible(
        np.asarray(theta_d),
        200.0,
        angle_range_deg=(low, high),
        k_in_kpa_per_deg=7.0,
        reservoir_limit_kpa=limit,
    )


def test_possible_reference_is_accepted_up_to_its_limits():
    refuse([0.0, 30.0, 64.0], limit=448.0)
    refuse([0.0, 65.0], limit=455.0)


@pytest.mark.parametrize("value", [-0.25, 65.25])
def test_reference_outside_the_range_is_refused_at_its_first_time_and_value(value):
    with pytest.raises(ControlError) as caught:
        refuse([10.0, 20.0, value, 10.0, 99.0, -9.0], limit=999.0)
    (line,) = str(caught.value).splitlines()
    assert f"theta_d = {value:.2f} deg at t = 0.010 s" in line
    assert "range of 0 to 65 deg" in line


def test_reservoir_pressure_over_the_limit_is_refused_at_its_first_time_and_value():
    with pytest.raises(ControlError) as caught:
        refuse([10.0, 64.0, 64.5, 65.0])
    (line,) = str(caught.value).splitlines()
    assert "P_i = 451.5 kPa at t = 0.010 s exceeds the reservoir's limit of 450 kPa" in line


def test_both_problems_are_named_at_once():
    with pytest.raises(ControlError) as caught:
        refuse([10.0, 64.5, 70.0])
    first, second = str(caught.value).splitlines()
    assert first.startswith("theta_d = 70.00 deg at t = 0.010 s")
    assert second.startswith("P_i = 451.5 kPa at t = 0.005 s")
