import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from pydantic import ValidationError

from fprc.config import Settings, check
from fprc.config.rig import LONGEST_LAG_S, Rig, squeeze_lag, stiffest_squeeze
from fprc.errors import ConfigError
from fprc.studies.calibration.space import Free, decode, free_parameters

shares = st.floats(0.0, 1.0)
ranges = st.tuples(st.floats(1e-4, 1e3), st.floats(1.01, 1e4)).map(
    lambda drawn: (drawn[0], drawn[0] * drawn[1])
)


@given(shares, ranges)
def test_share_undoes_value_within_the_rounding_whatever_the_range(share, limits):
    free = Free("drift.time_s", *limits)
    low, high = limits
    # four digits are at worst 1.0005 for 1.000
    worst = 5e-4 * (1.0 / math.log(high / low) if free.logarithmic else high / (high - low))
    assert free.share_of(free.value_at(share)) == pytest.approx(share, abs=1.01 * worst)


@pytest.mark.parametrize(
    ("low", "high", "logarithmic"),
    [(1.0, 10.0, True), (1.0, 9.999, False), (0.0, 1000.0, False), (-10.0, 100.0, False)],
)
def test_range_of_a_decade_above_zero_is_logarithmic(low, high, logarithmic):
    free = Free("drift.time_s", low, high)
    expected = math.sqrt(low * high) if logarithmic else 0.5 * (low + high)
    assert free.logarithmic is logarithmic
    assert free.value_at(0.5) == pytest.approx(expected, rel=5e-4)  # four digits
    assert [free.share_of(value) for value in (low - 1.0, expected, high + 1.0)] == pytest.approx(
        [0.0, 0.5, 1.0]
    )


FULL_RIG = Settings().rig.model_dump(mode="json")
ALL = free_parameters(Settings().calibration.free, Settings().calibration.ranges)
in_the_cube = st.lists(
    st.floats(0.0, 1.0) | st.sampled_from([0.0, 1.0]), min_size=len(ALL), max_size=len(ALL)
).map(np.array)


@given(st.lists(st.floats(0.0, 1.0), min_size=3, max_size=3))
def test_weights_that_leave_room_are_taken_as_they_are(shares):
    free = free_parameters([f"bending.slip_weight.{k}" for k in range(3)])
    *own, last = decode(np.array(shares), FULL_RIG, free)["bending"]["slip_weight"]
    if sum(shares) <= 0.97:
        assert own == pytest.approx(shares, abs=5e-5)
    else:
        # all alike, and at least 0.03 for the last
        assert np.array(own) * sum(shares) == pytest.approx(0.97 * np.array(shares), abs=1e-3)
        assert last == pytest.approx(0.03, abs=1e-3)


@given(in_the_cube)
def test_rig_of_a_point_is_valid_unless_no_damping_suits_lag_and_step(point):
    found = decode(point, FULL_RIG, ALL)
    try:
        Rig.model_validate(found)
    except ValidationError:
        least = found["step_s"] * stiffest_squeeze(found) / 0.48
        lag = squeeze_lag(found) * least / found["reservoir"]["squeeze_damping_kpa_s_per_ml"]
        assert lag > 0.99 * LONGEST_LAG_S


def test_narrower_range_replaces_the_physical_one():
    free = free_parameters(
        ["drift.time_s", "bending.slip_distance_deg.0", "drift.sigma_kpa"],
        {"drift.time_s": [2, 3.5], "bending.slip_distance_deg.0": [0.5, 1.5]},
    )
    assert [(parameter.low, parameter.high) for parameter in free] == [
        (2.0, 3.5), (0.5, 1.5), (0.0, 15.0),
    ]  # fmt: skip


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
        assert f"calibration.{key} " in str(caught.value)
