import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from pydantic import ValidationError

from fprc.config import Settings, check
from fprc.config.rig import LONGEST_LAG_S, Rig, free_ranges, squeeze_lag, stiffest_squeeze
from fprc.errors import ConfigError
from fprc.studies.calibration.space import decode, encode

RIG = Settings().rig.model_dump(mode="json")
ALL = free_ranges(Settings().calibration.free, Settings().calibration.ranges)
PATH = "drift.time_s"

shares = st.floats(0.0, 1.0)
ranges = st.tuples(st.floats(1e-4, 1e3), st.floats(1.01, 1e4)).map(
    lambda drawn: (drawn[0], drawn[0] * drawn[1])
)
in_the_cube = st.lists(
    shares | st.sampled_from([0.0, 1.0]), min_size=len(ALL), max_size=len(ALL)
).map(np.array)


@given(shares, ranges)
def test_share_undoes_value_within_the_rounding_whatever_the_range(share, limits):
    found = encode(decode([share], RIG, {PATH: limits}), {PATH: limits})
    # four digits are at worst 1.0005 for 1.000
    low, high = limits
    per = 1.0 / math.log(high / low) if high / low >= 10.0 else high / (high - low)
    assert found == pytest.approx([share], abs=1.01 * 5e-4 * per)


@pytest.mark.parametrize(
    ("low", "high", "middle"),
    [(1.0, 10.0, math.sqrt(10.0)), (1.0, 9.999, 5.4995), (0.0, 100.0, 50.0), (-10.0, 100.0, 45.0)],
)
def test_range_of_a_decade_above_zero_is_logarithmic(low, high, middle):
    limits = {PATH: (low, high)}
    value = decode([0.5], RIG, limits)["drift"]["time_s"]
    assert value == pytest.approx(middle, rel=5e-4)  # four digits
    for outside, share in ((low - 1.0, 0.0), (high + 1.0, 1.0)):
        assert encode(RIG | {"drift": {"time_s": outside}}, limits) == pytest.approx([share])


@given(st.lists(shares, min_size=3, max_size=3))
def test_weights_that_leave_room_are_taken_as_they_are(shares):
    free = free_ranges([f"bending.slip_weight.{k}" for k in range(3)], {})
    *own, last = decode(np.array(shares), RIG, free)["bending"]["slip_weight"]
    if sum(shares) <= 0.97:
        assert own == pytest.approx(shares, abs=5e-5)
    else:
        # all alike, and at least 0.03 for the last
        assert np.array(own) * sum(shares) == pytest.approx(0.97 * np.array(shares), abs=1e-3)
        assert last == pytest.approx(0.03, abs=1e-3)


@given(in_the_cube)
def test_rig_of_a_point_is_valid_unless_no_damping_suits_lag_and_step(point):
    found = decode(point, RIG, ALL)
    try:
        Rig.model_validate(found)
    except ValidationError:
        least = found["step_s"] * stiffest_squeeze(found) / 0.48
        lag = squeeze_lag(found) * least / found["reservoir"]["squeeze_damping_kpa_s_per_ml"]
        assert lag > 0.99 * LONGEST_LAG_S


def test_narrower_range_replaces_the_physical_one():
    narrower = {"drift.time_s": [2, 3.5], "bending.slip_distance_deg.0": [0.5, 1.5]}
    found = free_ranges([*narrower, "drift.sigma_kpa"], narrower)
    assert list(found.values()) == [(2.0, 3.5), (0.5, 1.5), (0.0, 15.0)]


WRONG_PATHS = ["bending", "bending.friciton_kpa", "models.esn.r", "bending.relaxation_time_s.-1"]


@pytest.mark.parametrize(
    ("paths", "ranges", "refused"),
    [
        *(
            (["drift.time_s", "step_s"], {"drift.time_s": limits}, ["ranges: drift.time_s"])
            for limits in [(5.0, 5.0), (6.0, 5.0), (0.9, 5.0), (5.0, 60.1), (-1.0, 99.0)]
        ),
        *(
            (["bending.slip_weight.0", path], {}, [f"free: {path}"])
            for path in ("bending.slip_weight.3", "bending.slip_distance_deg")
        ),
        (
            ["bending.friction_kpa", *WRONG_PATHS, "drift.time_s"],
            {"drift.time_s": [3.0, 2.0]},
            [*(f"free: {path}" for path in WRONG_PATHS),
             "ranges: drift.time_s"],
        ),
    ],
)  # fmt: skip
def test_all_paths_and_ranges_that_are_wrong_are_reported_at_once(paths, ranges, refused):
    with pytest.raises(ConfigError) as caught:
        check({"calibration": {"free": paths, "ranges": ranges}})
    for key in refused:
        assert f"calibration: {key} " in str(caught.value)
