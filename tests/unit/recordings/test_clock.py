from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from fprc.errors import LogError
from fprc.recordings.clock import MOST_POINTS, SECONDS, likely_rate, oddities, refuse_length
from fprc.recordings.gather import gather
from fprc.recordings.resample import resample
from fprc.recordings.source import Source

T = np.arange(400) / 200.0
X = {"theta_deg": {"column": "x", "unit": "deg", "scale": 1.0, "offset": 0.0}}


def recorded(instants, unit="s", **cut):
    """Return a recording of x, which counts the samples, and the source it is from."""
    columns = {"t": np.asarray(instants, dtype=float), "x": np.arange(float(len(instants)))}
    source = Source(Path("log.csv"), "", columns, {}, np.arange(len(instants)) + 2)
    time = {"column": "t", "unit": unit}
    return gather(source, time=time, channels=X, **cut), source, time


def odd(instants, unit):
    recording, source, time = recorded(instants, unit)
    return oddities(source, time, recording)


def refusal(call, *arguments, **named):
    with pytest.raises(LogError) as caught:
        call(*arguments, **named)
    return str(caught.value)


def length_refused(instants, unit="s", rate_hz=200.0, **cut):
    recording, source, time = recorded(instants, unit, **cut)
    return refusal(refuse_length, source, time, recording, rate_hz)


# --- order ----------------------------------------------------------------------------------


def test_time_stamp_that_repeats_is_named_with_its_sample():
    message = refusal(recorded, np.repeat(T[:200], 2))
    assert "time: t: sample 1 (line 3) at 0 " in message
    assert "in all: 200;" in message


def test_clock_that_goes_back_is_named_with_its_sample():
    instants = T.copy()
    instants[10:12] = instants[[11, 10]]
    instants[20] = 0.0123
    message = refusal(recorded, instants)
    assert "time: t: sample 11 (line 13) at 0.05 does not come after 0.055" in message
    assert "in all: 2;" in message


def test_instant_that_is_none_is_named_with_its_sample():
    instants = T.copy()
    instants[[6, 9]] = np.nan, np.inf
    assert "time: t: sample 6 (line 8) is nan" in refusal(recorded, instants)


# --- length ---------------------------------------------------------------------------------


@pytest.mark.parametrize("jump_s", [1e6, 1e9, 1e300])
def test_last_stamp_that_jumps_is_named(jump_s):
    instants = T.copy()
    instants[-1] += jump_s
    message = length_refused(instants)
    assert "the clock jumps from 1.99 s at sample 398 (line 400) to " in message
    assert "s at sample 399 (line 401): repair it there" in message
    # the sample is named where it was in the file
    assert "at sample 399 (line 401): repair" in length_refused(instants, start_s=1.0)


@pytest.mark.parametrize(
    ("unit", "stated", "samples"),
    [("ns", "us", 40_000), ("ns", "s", 40_000), ("ms", "min", 40_000), ("s", "us", 400),
     ("ms", "ns", 400)],
)  # fmt: skip
def test_implausible_unit_is_answered_with_the_likely_one(unit, stated, samples):
    message = length_refused(np.arange(samples) / 200.0 / SECONDS[unit], unit=stated)
    assert f"in {unit} the rate would be 200 Hz: set time.unit: {unit}" in message


def test_likely_clock_is_not_doubted():
    assert odd(T, "s") == []
    assert "time.unit: ns" in "".join(odd(1e9 * T, "us"))
    assert odd(1e-9 * T, "s") == []
    assert likely_rate(5.0) == (pytest.approx(200.0), "ms")


def test_steps_far_finer_than_the_grid_are_refused():
    """Otherwise the low-pass alone would need 3 GB."""
    instants = np.append(np.arange(50) * 1e-9, 1.0)
    assert "need 2.4e+09 samples" in length_refused(instants)


def test_rate_that_is_too_low_is_reported_as_such():
    _, source, _ = recorded(T)
    time = {"rate_hz": 1e-3}
    recording = gather(source, time=time, channels=X)
    assert "time.rate_hz" in refusal(refuse_length, source, time, recording, 200.0)


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
    try:
        recording, source, time = recorded(np.unique(instants), unit)
        refuse_length(source, time, recording, rate_hz)
    except LogError:
        return
    assert recording.time_s[-1] * rate_hz <= MOST_POINTS
    if recording.time_s[-1] * rate_hz < 1e4:
        grid_s, channels = resample(recording.time_s, recording.channels, rate_hz)
        assert len(grid_s) <= MOST_POINTS
        assert np.isfinite(channels["theta_deg"]).all()
