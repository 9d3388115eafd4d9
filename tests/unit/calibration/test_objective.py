import copy
import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from fprc.calibration import Aim, loss_of, properties, residuals
from fprc.config import Settings

#: Errors in the order that is wanted: FPRC's test error is the lowest by far.
ERRORS = {
    f"{trained_on}/{model}/{phase}": value
    for trained_on, model, *values in (
        ("sweep", "esn", 11.0, 16.0),
        ("sweep", "fprc", 12.0, 10.0),
        ("sweep", "fuzzy_linear", 15.0, 17.0),
        ("complex", "esn", 10.0, 60.0),
        ("complex", "fprc", 9.0, 26.0),
        ("complex", "fuzzy_linear", 13.0, 50.0),
    )
    for phase, value in zip(("train", "test"), values, strict=True)
}
RANGES = {"angle_deg": (57.0, 63.0), "loop_kpa": (45.0, 75.0), "p_o_loop": (0.2, 0.4)}
PROPERTIES = {"angle_deg": 60.0, "loop_kpa": 60.0, "p_o_loop": 0.3}
MARGIN, RATIO = 0.05, 1.15
TARGET = Aim(ERRORS, RANGES, MARGIN, RATIO)

keys = st.sampled_from(list(ERRORS))
factors = st.floats(1.0, 10.0)


def loss(*seeds, target=TARGET, found=(PROPERTIES,)):
    """Return the loss of changes to errors that are on target, one mapping a seed."""
    return loss_of([ERRORS | changes for changes in seeds], found, target)


def aimed_at(*seeds):
    """Return a target whose errors are the means of these seeds, and no properties."""
    means = {key: float(np.mean([(ERRORS | seed)[key] for seed in seeds])) for key in ERRORS}
    return TARGET._replace(errors=means, ranges={})


def test_loss_is_zero_where_all_is_on_target():
    assert loss({}) == 0.0
    assert loss({}, {}, {}, found=[PROPERTIES] * 3) == 0.0


def test_loss_is_zero_at_the_very_ends_of_the_ranges():
    for end in (0, 1):
        found = {name: limits[end] for name, limits in RANGES.items()}
        assert loss({}, found=[found]) == 0.0


@given(keys, st.floats(1.001, 10.0), st.booleans())
def test_loss_is_above_zero_off_each_target(key, factor, up):
    assert loss({key: ERRORS[key] * (factor if up else 1.0 / factor)}) > 0.0


@given(keys, factors, factors, st.booleans())
def test_loss_rises_with_the_deviation(key, one, other, up):
    near, far = (
        loss({key: ERRORS[key] * (factor if up else 1.0 / factor)})
        for factor in sorted((one, other))
    )
    assert near <= far


# --- published errors -----------------------------------------------------------------------------


def test_residuals_are_the_relative_deviations_of_the_means():
    found = residuals(
        [ERRORS | {"sweep/esn/test": 16.0}, ERRORS | {"sweep/esn/test": 24.0}], TARGET
    )
    assert list(found) == list(ERRORS)
    assert found.pop("sweep/esn/test") == pytest.approx(0.25)
    assert found == pytest.approx(dict.fromkeys(found, 0.0))


@pytest.mark.parametrize("factor", [2.0, 0.5])
def test_deviation_alone_is_the_mean_square_of_its_logarithm(factor):
    # neither key is part of an order
    changes = {
        key: factor * ERRORS[key] for key in ("sweep/fuzzy_linear/train", "complex/esn/train")
    }
    assert loss(changes) == pytest.approx(2.0 * math.log(2.0) ** 2 / 12.0)


def test_deviations_that_cancel_in_the_mean_of_the_seeds_cost_nothing():
    key = "complex/fuzzy_linear/train"
    assert loss({key: 0.5 * ERRORS[key]}, {key: 1.5 * ERRORS[key]}) == 0.0


def test_only_the_errors_of_the_target_deviate():
    few = TARGET._replace(errors={"sweep/esn/test": 16.0})
    assert loss({"complex/esn/train": 99.0}, target=few) == 0.0
    assert loss({"sweep/esn/test": 32.0}, target=few) == pytest.approx(math.log(2.0) ** 2)


# --- orders ---------------------------------------------------------------------------------------


@pytest.mark.parametrize("trained_on", ["sweep", "complex"])
@pytest.mark.parametrize("best", ["esn", "fuzzy_linear"])
def test_test_error_within_the_margin_of_the_best_other_alone(trained_on, best):
    seed = {f"{trained_on}/{model}/test": 40.0 for model in ("esn", "fuzzy_linear")}
    seed |= {f"{trained_on}/{best}/test": 20.0, f"{trained_on}/fprc/test": 30.0}
    expected = math.log(30.0 * 1.05 / 20.0) ** 2 / 3.0
    assert loss(seed, target=aimed_at(seed)) == pytest.approx(expected)


@pytest.mark.parametrize(("ours", "misses"), [(19.0, False), (19.1, True)])
def test_test_error_must_be_below_the_others_by_the_margin(ours, misses):
    seed = {"sweep/fprc/test": ours, "sweep/esn/test": 20.0, "sweep/fuzzy_linear/test": 20.0}
    assert (loss(seed, target=aimed_at(seed)) > 0.0) is misses


@pytest.mark.parametrize(("esn", "fprc"), [(10.0, 20.0), (20.0, 10.0)])
def test_training_errors_that_are_apart_alone(esn, fprc):
    seed = {"sweep/esn/train": esn, "sweep/fprc/train": fprc}
    expected = math.log(2.0 / 1.15) ** 2 / 3.0
    assert loss(seed, target=aimed_at(seed)) == pytest.approx(expected)


def test_training_errors_within_the_ratio_cost_nothing():
    for esn in (12.0 * 1.149, 12.0 / 1.149):
        seed = {"sweep/esn/train": esn}
        assert loss(seed, target=aimed_at(seed)) == 0.0


def test_training_errors_on_the_complex_log_have_no_order():
    seed = {"complex/esn/train": 90.0}
    assert loss(seed, target=aimed_at(seed)) == 0.0


def test_orders_are_missed_by_each_seed_and_not_by_the_mean():
    seeds = ({"sweep/fprc/test": 5.0}, {"sweep/fprc/test": 20.0})
    mean = {"sweep/fprc/test": 12.5}
    assert loss(mean, target=aimed_at(*seeds)) == 0.0
    expected = math.log(20.0 * 1.05 / 16.0) ** 2 / 6.0
    assert loss(*seeds, target=aimed_at(*seeds)) == pytest.approx(expected)


# --- properties -----------------------------------------------------------------------------------


@pytest.mark.parametrize("value", [37.5, 22.5, 150.0, 90.0])
def test_property_outside_of_its_range_alone(value):
    distance = math.log(max(45.0 / value, value / 75.0))
    assert loss({}, found=[PROPERTIES | {"loop_kpa": value}]) == pytest.approx(distance**2 / 3.0)


@pytest.mark.parametrize("value", [0.0, -60.0, math.nan])
def test_property_that_is_no_positive_number_costs_as_much_as_one_far_outside(value):
    assert loss({}, found=[PROPERTIES | {"loop_kpa": value}]) == pytest.approx(9.0 / 3.0)


def test_properties_count_in_the_mean_of_the_seeds():
    found = [PROPERTIES | {"loop_kpa": value} for value in (30.0, 90.0)]
    assert loss({}, {}, found=found) == 0.0


def test_properties_without_a_range_do_not_count():
    assert loss({}, found=[PROPERTIES | {"another": -1.0}]) == 0.0
    assert loss({}, found=[{}], target=TARGET._replace(ranges={})) == 0.0


def test_three_parts_add_up():
    seed, found = {"sweep/fprc/test": 16.0}, {"angle_deg": 126.0}
    parts = (
        math.log(1.6) ** 2 / 12.0,
        math.log(1.05) ** 2 / 3.0,
        math.log(2.0) ** 2 / 3.0,
    )
    assert loss(seed, found=[PROPERTIES | found]) == pytest.approx(sum(parts))


RATE_HZ, DURATION_S = 200, 40


def ellipses(width_kpa, growth, p_o_width_kpa, p_o_growth):
    """Return a log of 1 Hz whose loops are as wide in the first half, and grown in the second.

    At mid-angle the cosine is 0 and the sine 1 where the angle rises, -1 where it falls.
    """
    t = np.arange(RATE_HZ * DURATION_S) / RATE_HZ
    phase = 2.0 * np.pi * (t + 0.3 / RATE_HZ)  # no sample is at mid-angle
    along, across = -np.cos(phase), np.sin(phase)
    late = t >= 0.5 * DURATION_S
    return {
        "time_s": t,
        "theta_deg": 30.0 + 30.0 * along,
        "p_target_kpa": 175.0
        + 170.0 * along
        + 0.5 * width_kpa * np.where(late, growth, 1.0) * across,
        "p_o_kpa": 130.0
        + 25.0 * along
        + 0.5 * p_o_width_kpa * np.where(late, p_o_growth, 1.0) * across,
    }


@pytest.mark.parametrize(
    ("width", "growth", "p_o_width", "p_o_growth"),
    [(60.0, 1.0, 15.0, 1.0), (80.0, 1.25, 10.0, 0.8), (20.0, 0.5, 20.0, 2.0)],
)
def test_properties_of_loops_of_known_width(width, growth, p_o_width, p_o_growth):
    found = properties({"sweep": ellipses(width, growth, p_o_width, p_o_growth)})
    semi_axes = 25.0, 0.5 * p_o_width * max(p_o_growth, 1.0)
    swing = 2.0 * math.hypot(*semi_axes)
    assert found == pytest.approx(
        {
            "angle_deg": 60.0,
            "loop_kpa": width * 0.5 * (1.0 + growth),
            "loop_growth": growth,
            "p_o_swing_kpa": swing,
            "p_o_loop": p_o_width * 0.5 * (1.0 + p_o_growth) / swing,
            "p_o_loop_growth": p_o_growth,
        },
        rel=2e-3,
    )


def test_properties_are_those_of_the_sweep_and_leave_the_logs_alone():
    logs = {"sweep": ellipses(60.0, 1.1, 15.0, 0.9), "complex": ellipses(10.0, 1.0, 5.0, 1.0)}
    before = copy.deepcopy(logs)
    assert properties(logs) == properties({"sweep": logs["sweep"]})
    for name, log in logs.items():
        for channel, values in log.items():
            np.testing.assert_array_equal(values, before[name][channel])


def test_every_property_has_a_range_in_the_configuration():
    plausible = Settings().calibration.plausible.model_dump()
    assert set(properties({"sweep": ellipses(60.0, 1.0, 15.0, 1.0)})) == set(plausible)
