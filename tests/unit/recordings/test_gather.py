"""From a table and a map to channels on one clock."""

from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from fprc.errors import LogError
from fprc.recordings.clock import pauses_of, rate_of
from fprc.recordings.gather import MOST_POINTS, gather, resample
from fprc.recordings.importing import ImportMap
from fprc.recordings.names import SECONDS
from fprc.recordings.table import Column, Table

T = np.arange(50) / 100.0
COLUMNS = {"t": T, "angle": np.sin(T), "force": np.arange(50.0) ** 2}
NAN = np.nan


def table(unusable=(), **columns):
    found = {name: Column(np.asarray(v, float)) for name, v in (COLUMNS | columns).items()}
    return Table(Path("log.csv"), "", found, {}, (), np.arange(50) + 2, unusable)


def asked(time=None, angle=(), force=(), **more):
    """Return a map of angle and force, with the clock t."""
    channels = {
        "theta_deg": {"column": "angle", "unit": "deg", **dict(angle)},
        "p_exp_kpa": {"column": "force", "unit": "1", "note": "force [N]", **dict(force)},
    }
    return ImportMap.model_validate(
        {"time": {"column": "t"} | (time or {}), "channels": channels} | more
    )


def changed(values, at, to):
    """Return a copy with other values at some places."""
    values = np.array(values)
    values[at] = to
    return values


@pytest.mark.parametrize("unit", SECONDS)
def test_clock_of_any_unit_and_start_counts_from_zero(unit):
    source = table(t=(T + 3600.0) / SECONDS[unit])
    recording = gather(source, asked({"unit": unit}))
    assert recording.time_s == pytest.approx(T, abs=1e-9)
    assert recording.start_s == pytest.approx(3600.0)


def test_cut_is_counted_from_the_first_sample():
    # what the cut takes away may be missing
    force = changed(COLUMNS["force"], 1, NAN)
    recording = gather(table(t=T + 5.0, force=force), asked(start_s=0.1, end_s=0.2))
    assert recording.time_s == pytest.approx(np.arange(11) / 100.0)
    assert recording.channels["p_exp_kpa"].tolist() == COLUMNS["force"][10:21].tolist()
    assert recording.start_s == pytest.approx(5.1)


@pytest.mark.parametrize(
    ("columns", "mapping", "lines"),
    [
        ({"t": changed(T, [10, 11], T[[11, 10]])}, {}, ["sample 11 (line 13) at 0.1 does not"]),
        ({"t": np.repeat(T[:25], 2)}, {}, ["sample 1 (line 3) at 0 does not come after"]),
        ({"t": changed(T, [6, 9], [NAN, np.inf])}, {}, ["sample 6 (line 8); in all: 2"]),
        ({"force": T[:49]}, {}, ["unequal numbers of samples (force 49, angle 50, t 50)"]),
        ({"unusable": ("line 5: 'pump'",)}, {}, ["no samples: 1: line 5: 'pump'"]),
        ({}, {"start_s": 9.0}, ["0 samples lie"]),
        (
            {"force": changed(T, 30, NAN), "angle": changed(T, 7, np.inf)},
            {},
            ["p_exp_kpa: force: sample 30 (line 32) is nan"],
        ),
        (
            {},
            {"force": {"column": "forces"}, "time": {"column": "clock"}},
            ["p_exp_kpa: forces: no such column; did you mean force?", "time: clock: no such"],
        ),
        ({}, {"force": {"scale": 1e308, "offset": 1e308}}, ["p_exp_kpa: force: sample 0"]),
        ({}, {"force": {"unit": "MPa", "scale": 1e9}}, ["p_exp_kpa: force: sample 1"]),
        ({"angle": changed(T, 3, 2e9)}, {}, ["theta_deg: angle: sample 3"]),
    ],
)
def test_what_cannot_be_used_is_named_all_at_once(columns, mapping, lines):
    with pytest.raises(LogError) as caught:
        gather(table(**columns), asked(**mapping))
    found = str(caught.value).splitlines()
    assert all(line in text for line, text in zip(lines, found, strict=True))


def test_samples_that_cannot_be_used_are_left_out_if_the_map_says_so():
    force = changed(COLUMNS["force"], 30, NAN)
    source = table(t=changed(T, 6, NAN), force=force, unusable=("line 5: 'pump'",))
    recording = gather(source, asked(skip_unusable=True))
    kept = np.delete(np.arange(50), [6, 30])
    assert recording.time_s.tolist() == T[kept].tolist()
    assert recording.channels["p_exp_kpa"].tolist() == (kept**2.0).tolist()
    assert "line 5: 'pump'" in " ".join(recording.notes)
    assert "sample 6 (line 8); in all: 2" in " ".join(recording.notes)
    assert "about 2 samples missing" in " ".join(recording.notes)


@pytest.mark.parametrize(("how", "first"), [("first", 0.0), ("mean", 0.5)])
def test_samples_that_repeat_a_stamp_are_taken_once(how, first):
    source = table(t=np.repeat(T[:25], 2), force=np.arange(50.0))
    recording = gather(source, asked({"repeated": how}))
    assert recording.time_s.tolist() == T[:25].tolist()
    assert recording.channels["p_exp_kpa"].tolist() == (first + np.arange(0.0, 50.0, 2)).tolist()
    assert "25 samples repeat" in recording.notes[0]


def test_channel_with_its_own_clock_is_interpolated_where_it_has_samples():
    own = {"t2": 0.05 + np.arange(20) / 50.0, "force": 100.0 * np.arange(20) / 50.0}
    recording = gather(table(**own), asked(force={"time": "t2"}))
    assert recording.time_s == pytest.approx(np.arange(39) / 100.0)
    assert recording.start_s == pytest.approx(0.05)
    assert recording.channels["p_exp_kpa"] == pytest.approx(np.arange(39.0))


def test_scale_and_offset_come_before_the_unit():
    force = {"unit": "bar", "offset": -1.01325}
    recording = gather(table(), asked(angle={"unit": "rad", "scale": 2.0}, force=force))
    assert recording.channels["theta_deg"] == pytest.approx(np.rad2deg(2.0 * COLUMNS["angle"]))
    assert recording.channels["p_exp_kpa"] == pytest.approx(100 * COLUMNS["force"] - 101.325)


def test_rate_is_steps_over_span_without_pauses():
    rng = np.random.default_rng(1)
    scattered = np.cumsum(rng.exponential(0.005, 4000))
    assert pauses_of(scattered).size == 0
    assert rate_of(scattered) == pytest.approx(3999 / np.ptp(scattered), rel=1e-3)
    even = np.delete(np.arange(4000) / 200.0, slice(100, 900))
    assert pauses_of(even).tolist() == [99]
    assert rate_of(even) == 200.0
    assert rate_of(np.arange(400) / 142.857) == pytest.approx(142.857)


@pytest.mark.parametrize(
    ("time_s", "words"),
    [
        (changed(T, 49, 1e6), "longest step is from 0.48 to 1000000"),
        (changed(T, 49, 1e300), "longest step is from 0.48 to "),
        ([0.0, 1e-3], "0.2 samples"),
        # otherwise the low-pass alone would need 3 GB
        (np.append(np.arange(50) * 1e-9, 1.0), "2.4e+09 while resampled"),
    ],
)
def test_recording_may_be_neither_too_short_nor_too_long_nor_too_fine(time_s, words):
    with pytest.raises(LogError) as caught:
        resample(np.asarray(time_s, float), {}, 200.0, "log.csv")
    assert words in str(caught.value)


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
    stamps = np.unique(instants)
    source = table(t=stamps, angle=np.arange(len(stamps)), force=np.ones(len(stamps)))
    try:
        recording = gather(source, asked({"unit": unit}))
        grid_s, channels = resample(recording.time_s, recording.channels, rate_hz)
    except LogError:
        return
    assert len(grid_s) <= MOST_POINTS
    assert np.isfinite(channels["theta_deg"]).all()
