import numpy as np
import pandas as pd
import pytest

from fprc.tables.repeats import (
    Limits,
    beyond_limits,
    beyond_spread,
    ends_of_spread,
    numbers_of_repeat,
    repeats_page,
    upper_end,
    variants_page,
)
from fprc.tables.rigs import rig_errors

METRICS = ("train_rmse_kpa", "validation_rmse_kpa", "test_rmse_kpa")
NAMES = ("esn", "fprc", "fuzzy_linear")
PRINTED = {"train_rmse_kpa": [10.0, 0.1], "validation_rmse_kpa": [20.0, 0.1], "test_rmse_kpa": 40.0}
PUBLISHED = {
    "table_2_models": dict.fromkeys(NAMES, PRINTED),
    "table_3_reversed": dict.fromkeys(NAMES, PRINTED),
    "table_4_tracking_rmse_deg": {"fprc": {"sweep": 2.0}, "fprc_pd": {"sweep": 1.0}},
}
C4B = {"id": "C4b", "verdict": "reproduced",
       "statements": [{"mean": 0.7, "first": 0.6, "last": 0.8}]}  # fmt: skip
LEDGER = ({"id": "C14", "verdict": "reproduced", "statements": [{"mean": 0.1}]}, C4B)
LIMITS = Limits(median=0.08, largest=0.30, points=9, worth=(0.60, 0.82))
LANDED = {"median": 0.08, "largest": 0.30, "points": 9, "worth": 0.82}


def reports(over_print):
    """Reports of one seed on the models, given 18 errors over the printed ones."""
    ratios = iter(over_print)
    return {
        "source": "sim",
        "models": [
            {"model": name, "trained_on": log}
            | {metric: np.atleast_1d(PRINTED[metric])[0] * next(ratios) for metric in METRICS}
            for log in ("sweep", "complex")
            for name in NAMES
        ],
    }


def control():
    runs = {"sweep/fprc": 2.5, "sweep/fprc_pd": 0.4}
    return {"source": "sim", "rmse_deg": runs}


def numbers(ratios, ledger=LEDGER):
    models = [reports(row) for row in ratios]
    errors = rig_errors(models, [control()] * len(models), PUBLISHED)
    return numbers_of_repeat(models, errors, ledger, PUBLISHED)


def test_deviations_are_those_of_the_mean_over_seeds():
    ratios = np.random.default_rng(1).normal(1.0, 0.2, (4, 18))
    off = abs(ratios.mean(axis=0) - 1.0)
    found = numbers(ratios)
    assert found["median"] == pytest.approx(np.median(off))
    assert found["largest"] == pytest.approx(off.max())
    assert (found["worth"], found["worth_low"], found["worth_high"]) == (0.7, 0.6, 0.8)
    assert found["median_low"] < found["median"] < found["median_high"]


def test_seeds_that_agree_leave_no_interval():
    found = numbers([np.linspace(0.9, 1.3, 18)] * 3)
    assert found["median_low"] == pytest.approx(found["median"])
    assert found["median_high"] == pytest.approx(found["median"])


def test_interval_of_the_median_is_the_spread_of_other_seeds():
    # 18 errors that deviate alike: their median deviation is that of a mean of n normal numbers
    n, std = 30, 0.2
    found = [
        numbers(np.repeat(1.5 + std * draw[:, None], 18, axis=1))
        for draw in np.random.default_rng(2).normal(size=(20, n))
    ]
    width = np.mean([each["median_high"] - each["median_low"] for each in found])
    assert width == pytest.approx(2 * 1.96 * std / np.sqrt(n), rel=0.1)


def test_verdicts_that_fail_or_stay_open_are_named():
    ledger = [
        {"id": "C1", "verdict": "undecided"},
        {"id": "C2", "verdict": "not reproduced"},
        {"id": "C3", "verdict": "undecided"},
        C4B,
    ]
    found = numbers([np.ones(18)] * 2, ledger)
    assert (found["undecided"], found["not reproduced"]) == ("C1, C3", "C2")
    assert numbers([np.ones(18)] * 2)["undecided"] == "none"
    # no deviation of Tables II and III gives two points
    assert found["points"] == 2


def test_interval_is_the_same_each_time():
    ratios = np.random.default_rng(4).normal(1.0, 0.2, (5, 18))
    assert numbers(ratios) == numbers(ratios)


def test_upper_end_leaves_one_more_value_of_20_above():
    # Student's t of 3 degrees of freedom, from a table
    assert upper_end([1.0, 2.0, 3.0, 4.0]) == pytest.approx(2.5 + 2.35336 * np.sqrt(5 / 3 * 5 / 4))
    draws = np.random.default_rng(3).normal(5.0, 2.0, (20_000, 5))
    below = [row[4] <= upper_end(row[:4]) for row in draws]
    assert np.mean(below) == pytest.approx(0.95, abs=0.0046)  # three standard errors


def test_upper_end_needs_two_values():
    with pytest.raises(ValueError, match="at least two"):
        upper_end([0.07])


@pytest.mark.parametrize(
    ("change", "missed"),
    [
        ({}, []),
        ({"worth": 0.60}, []),
        ({"median": 0.0801}, ["median"]),
        ({"largest": 0.3001}, ["largest"]),
        ({"points": 8}, ["points"]),
        ({"worth": 0.8201}, ["ratio"]),
        ({"worth": 0.5999}, ["ratio"]),
        ({"median": 1.0, "points": 0}, ["median", "points"]),
    ],
)
def test_repeat_lands_at_the_limits_and_not_beyond(change, missed):
    assert beyond_limits(LANDED | change, LIMITS) == missed


def test_deviations_of_table_4_are_those_of_open_and_closed_loop():
    found = numbers([np.ones(18)] * 2)
    assert (found["open loop"], found["closed loop"]) == pytest.approx((0.25, 0.6))


# mean 0.2 and standard deviation 0.1; Student's t of 2 degrees of freedom, from a table
REACH = 2.919986 * 0.1 * np.sqrt(4.0 / 3.0)
SPREAD = [
    dict.fromkeys(("median", "largest", "open loop", "closed loop", "points"), value)
    for value in (0.1, 0.2, 0.3)
]


def test_ends_are_upper_for_deviations_and_lower_for_closed_loop_and_points():
    ends = ends_of_spread(SPREAD)
    assert [ends[name] for name in ("median", "largest", "open loop")] == pytest.approx(
        [0.2 + REACH] * 3
    )
    assert [ends[name] for name in ("closed loop", "points")] == pytest.approx([0.2 - REACH] * 2)


@pytest.mark.parametrize(
    ("change", "beyond"),
    [
        ({}, []),
        ({"median": 0.2 + REACH + 1e-3}, ["median"]),
        ({"open loop": 0.2 - REACH - 1e-3}, []),
        ({"closed loop": 0.2 + REACH + 1e-3}, []),
        ({"closed loop": 0.2 - REACH - 1e-3, "largest": 1.0}, ["largest", "closed loop"]),
        ({"points": 0.2 - REACH - 1e-3}, ["points"]),
    ],
)
def test_what_is_beyond_the_spread_is_named(change, beyond):
    assert beyond_spread(SPREAD[1] | change, ends_of_spread(SPREAD)) == beyond
    # the ends themselves are within
    assert beyond_spread(ends_of_spread(SPREAD), ends_of_spread(SPREAD)) == []


def test_page_shows_what_the_limits_are_about():
    row = numbers([np.full(18, 1.1)] * 2) | {"rig": "again", "lands": "no: median"}
    (page,) = repeats_page(pd.DataFrame([row])).to_dict("records")
    assert page == {
        "Rig": "again",
        "Median deviation": "10.00 % (10.0 to 10.0)",
        "Largest": "10.0 %",
        "Points": "1",
        "FPRC / FPRC on low-passed theta_d": "0.700 (0.600 to 0.800)",
        "Not reproduced": "none",
        "Undecided": "none",
        "Lands": "no: median",
    }


def test_page_of_variants_has_table_4_too():
    row = numbers([np.full(18, 1.1)] * 2) | {"rig": "other", "beyond": "closed loop"}
    (page,) = variants_page(pd.DataFrame([row])).to_dict("records")
    assert list(page)[2:6] == [
        "Largest", "Table IV, open loop", "Table IV, closed loop", "Points"
    ]  # fmt: skip
    assert (page["Table IV, open loop"], page["Table IV, closed loop"]) == ("25.0 %", "60.0 %")
    assert page["Beyond the spread"] == "closed loop"
