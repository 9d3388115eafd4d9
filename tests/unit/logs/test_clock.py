from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from fprc.errors import LogError
from fprc.logs.clock import (
    LONGEST_S,
    MOST_POINTS,
    SECONDS,
    even,
    likely_rate,
    other_unit,
    read_clock,
    refuse_length,
)
from fprc.logs.resample import resample
from fprc.logs.variables import Source

T = np.arange(400) / 200.0
MENDING = {"repeated": "mean", "unordered": "sort"}


def source(count=400, first_line=None):
    lines = None if first_line is None else np.arange(count) + first_line
    return Source(Path("log.csv"), "", {}, {}, lines)


def clock_of(instants, unit="s", **more):
    return read_clock(source(), {"column": "t", "unit": unit, **more}, np.asarray(instants))


def refusal(call, *arguments, **named):
    with pytest.raises(LogError) as caught:
        call(*arguments, **named)
    return str(caught.value)


def length_refused(instants, unit="s", rate_hz=200.0, **more):
    time = {"column": "t", "unit": unit, **more}
    clock = read_clock(source(len(instants), 2), time, np.asarray(instants, dtype=float))
    return refusal(refuse_length, source(len(instants), 2), time, clock, rate_hz)


# --- order ----------------------------------------------------------------------------------


@given(
    instants=arrays(np.int64, st.integers(1, 30), elements=st.integers(-5, 5)),
    repeated=st.sampled_from(["first", "mean"]),
)
def test_mended_clock_agrees_with_one_instant_after_the_other(instants, repeated):
    values = np.arange(len(instants), dtype=float)
    clock = clock_of(instants.astype(float), repeated=repeated, unordered="sort")
    groups = [values[instants == instant] for instant in np.unique(instants)]
    expected = [group[0] if repeated == "first" else group.mean() for group in groups]
    assert clock.mean(values[clock.samples]).tolist() == pytest.approx(expected)
    assert clock.since_s.tolist() == [i - instants.min() for i in np.unique(instants)]
    assert clock.corrections["repeated_samples"] == len(instants) - len(groups)
    late = sum(instants[k] < instants[:k].max() for k in range(1, len(instants)))
    assert clock.corrections["unordered_samples"] == late


@given(count=st.integers(2, 20), data=st.data())
def test_part_of_a_clock_is_that_of_its_instants(count, data):
    instants = np.sort(data.draw(arrays(np.int64, count, elements=st.integers(0, 9)))).astype(float)
    clock = clock_of(instants, repeated="mean")
    begin = data.draw(st.integers(0, len(clock.since_s) - 1))
    end = data.draw(st.integers(begin + 1, len(clock.since_s)))
    part = clock.part(begin, end)
    values = np.random.default_rng(count).standard_normal(count)
    whole = clock.mean(values[clock.samples])
    assert part.mean(values[part.samples]) == pytest.approx(whole[begin:end])
    assert part.since_s.tolist() == clock.since_s[begin:end].tolist()


def test_repeated_time_stamps_are_counted_and_the_remedy_is_named():
    instants = np.repeat(T[:200], 2)
    said = refusal(read_clock, source(400, 2), {"column": "t", "unit": "s"}, instants)
    assert "time: t: 200 of 400 samples repeat an earlier time stamp" in said
    assert "sample 1 (line 3) at 0;" in said
    assert "time.repeated: first" in said


def test_unordered_samples_are_counted_and_the_remedy_is_named():
    instants = T.copy()
    instants[10:12] = instants[[11, 10]]
    instants[20] = 0.0123
    said = refusal(read_clock, source(400, 2), {"column": "t", "unit": "s"}, instants)
    assert "2 of 400 samples are out of order" in said
    assert "sample 11 (line 13) at 0.05, after sample 10 (line 12) at 0.055" in said
    assert "time.unordered: sort" in said


def test_instant_that_is_none_is_named_with_its_sample():
    instants = T.copy()
    instants[[6, 9]] = np.nan, np.inf
    assert "time: t: sample 6 is nan, and 1 more" in refusal(clock_of, instants)


# --- length ---------------------------------------------------------------------------------


@pytest.mark.parametrize("jump_s", [1e6, 1e9, 1e300])
def test_last_stamp_that_jumps_is_named(jump_s):
    instants = T.copy()
    instants[-1] += jump_s
    said = length_refused(instants)
    assert "the clock jumps from 1.99 s at sample 398 (line 400) to " in said
    assert "s at sample 399 (line 401): repair it there" in said
    instants[[50, 399]] = instants[[399, 50]]  # the sample is named where it was
    assert "at sample 50 (line 52): repair" in length_refused(instants, **MENDING)


@pytest.mark.parametrize(
    ("unit", "told", "samples"),
    [("ns", "us", 40_000), ("ns", "s", 40_000), ("ms", "min", 40_000), ("s", "us", 400),
     ("ms", "ns", 400)],
)  # fmt: skip
def test_implausible_unit_is_answered_with_the_likely_one(unit, told, samples):
    said = length_refused(np.arange(samples) / 200.0 / SECONDS[unit], unit=told)
    assert f"in {unit} the rate would be 200 Hz: set time.unit: {unit}" in said


def test_likely_clock_is_not_doubted():
    assert other_unit(clock_of(T), "s") is None
    assert other_unit(clock_of(1e9 * T, unit="us"), "us").endswith("time.unit: ns if that is right")
    assert other_unit(clock_of(1e-9 * T), "s") is None
    assert likely_rate(5.0) == (pytest.approx(200.0), "ms")


def test_steps_far_finer_than_the_grid_are_refused():
    """Otherwise the low-pass alone would need 3 GB."""
    instants = np.append(np.arange(50) * 1e-9, 1.0)
    assert "need 2.4e+09 samples" in length_refused(instants)


def test_rate_that_is_too_low_is_reported_as_such():
    with pytest.raises(LogError, match=r"time: rate_hz: .*correct time\.rate_hz"):
        refuse_length(source(), {"rate_hz": 1e-3}, even(400, 1e-3), 200.0)


@given(
    instants=st.one_of(
        arrays(np.float64, st.integers(2, 40), elements=st.floats(-1e308, 1e308)),
        arrays(np.float64, st.integers(2, 40), elements=st.floats(0.0, 1e5)),
        st.floats(1e-9, 1e6).map(lambda step: step * np.arange(30.0)),
    ),
    unit=st.sampled_from(sorted(SECONDS)),
    rate_hz=st.sampled_from([1.0, 200.0, 1e5]),
)
def test_any_instants_are_refused_or_resampled_in_bounds(instants, unit, rate_hz):
    time = {"column": "t", "unit": unit, **MENDING}
    clock = read_clock(source(), time, instants)
    if len(clock.since_s) < 2:
        return
    try:
        refuse_length(source(), time, clock, rate_hz)
    except LogError:
        return
    assert clock.since_s[-1] <= LONGEST_S
    assert clock.since_s[-1] * rate_hz <= MOST_POINTS
    if clock.since_s[-1] * rate_hz < 1e4:
        grid_s, channels = resample(clock.since_s, {"x": clock.since_s}, rate_hz)
        assert len(grid_s) <= MOST_POINTS
        assert np.isfinite(channels["x"]).all()
