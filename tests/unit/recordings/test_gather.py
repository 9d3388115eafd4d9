"""From a table and a map to channels on one clock, and on a uniform grid."""

from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from fprc.errors import LogError
from fprc.recordings.clock import pauses_of, rate_of
from fprc.recordings.importing import MOST_POINTS, ImportMap, Recording, gather, resample
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
        ({"force": T[:49]}, {}, ["unequal numbers of samples"]),
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
            ["p_exp_kpa: forces: no such column; time: clock: no such"],
        ),
        ({"angle": changed(T, 3, 2e9)}, {}, ["theta_deg: angle: sample 3"]),
    ],
)
def test_what_cannot_be_used_is_named(columns, mapping, lines):
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
    assert "interpolation: 2, longest from" in " ".join(recording.notes)


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


def test_all_channels_may_have_clocks_of_their_own():
    clocks = {name: {"time": "t"} for name in ("angle", "force")}
    recording = gather(table(), asked({"column": None, "rate_hz": 100.0}, **clocks))
    assert recording.time_s == pytest.approx(T)
    assert recording.channels["theta_deg"] == pytest.approx(np.sin(T))


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
    "time_s",
    [
        changed(T, 49, 1e6),
        changed(T, 49, 1e300),
        [0.0, 1e-3],  # 0.2 samples
        np.append(np.arange(50) * 1e-9, 1.0),  # otherwise the low-pass alone would need 3 GB
    ],
)
def test_recording_may_be_neither_too_short_nor_too_long_nor_too_fine(time_s):
    with pytest.raises(LogError, match=r"^log.csv: "):
        resample(Recording(np.asarray(time_s, float), {}, path=Path("log.csv")), 200.0)


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
        grid_s, channels = resample(recording, rate_hz)
    except LogError:
        return
    assert len(grid_s) <= MOST_POINTS
    assert np.isfinite(channels["theta_deg"]).all()


def sine(time_s, f_hz, phase=0.3):
    return np.sin(2.0 * np.pi * f_hz * time_s + phase)


def only(time_s, values, rate_hz):
    grid_s, channels = resample(Recording(time_s, {"x": values}), rate_hz)
    return grid_s, channels["x"]


@pytest.mark.parametrize("rate_hz", [200.0, 100.0, 1000.0])
def test_recording_at_the_right_rate_passes_bit_for_bit(rate_hz):
    time_s = np.arange(500) / rate_hz
    values = np.random.default_rng(0).standard_normal(500)
    grid_s, resampled = only(time_s, values, rate_hz)
    assert grid_s == pytest.approx(time_s, abs=1e-12)
    assert resampled.tolist() == values.tolist()


#: Rate and jitter of the recording, new rate, sines, their largest error inside, and at the ends.
SINES = [
    *((hz, 0.0, 200.0, (0.5, 10.0, 60.0, 79.0), 2e-3, 2.0) for hz in (400, 600, 1000, 2000)),
    *((1000.0, 0.0, hz, (3.0,), 2e-3, 2.0) for hz in (333.0, 128.0, 70.0)),
    (1000.0, 4e-4, 200.0, (5.0,), 2e-3, 2.0),  # a clock with jitter
    (1000.0, 0.0, 200.0, (0.5,), 2e-3, 2e-3),  # slow motion is kept near the ends
    (200.02, 0.0, 200.0, (1.0,), 2e-4, 2e-4),  # a clock that is a little off: no low-pass
    # to a higher rate no more is lost than documented
    *((hz, 0.0, 200.0, (1.0,), *2 * ((np.pi / hz) ** 2 / 2,)) for hz in (150.0, 100.0, 50.0, 30.0)),
]


@pytest.mark.parametrize(("source_hz", "jitter_s", "rate_hz", "sines_hz", "inside", "ends"), SINES)
def test_sine_below_the_edge_keeps_amplitude_and_phase(
    source_hz, jitter_s, rate_hz, sines_hz, inside, ends
):
    time_s = np.arange(int(10 * source_hz)) / source_hz
    time_s += np.random.default_rng(2).uniform(-jitter_s, jitter_s, len(time_s))
    for f_hz in sines_hz:
        grid_s, resampled = only(time_s, sine(time_s, f_hz), rate_hz)
        assert np.diff(grid_s) == pytest.approx(1.0 / rate_hz)
        error = np.abs(resampled - sine(grid_s, f_hz))
        assert error[60:-60].max() < inside + 1e-9
        assert error.max() < ends + 1e-9


@pytest.mark.parametrize("f_hz", [101.0, 170.0, 199.0, 201.0, 390.0, 499.0])
def test_sine_above_the_new_nyquist_frequency_leaves_no_alias(f_hz):
    time_s = np.arange(5000) / 1000.0
    _, resampled = only(time_s, sine(time_s, f_hz), 200.0)
    assert np.abs(resampled[60:-60]).max() < 10 ** (-65 / 20)


def test_pause_in_the_recording_does_not_switch_the_filter_off():
    stretch_s = np.arange(10_000) / 1000.0
    time_s = np.concatenate([stretch_s, stretch_s + 120.0])
    grid_s, resampled = only(time_s, sine(time_s, 210.0), 200.0)
    recorded = (grid_s < 9.0) | (grid_s > 121.0)
    # interpolation next to a pause reduces the attenuation
    assert np.abs(resampled[60:-60][recorded[60:-60]]).max() < 0.02


@given(
    samples=st.integers(70, 400),
    source_hz=st.floats(5.0, 3000.0),
    rate_hz=st.sampled_from([50.0, 200.0, 1000.0]),
)
def test_grid_begins_at_the_first_sample_and_ends_by_the_last(samples, source_hz, rate_hz):
    time_s = np.arange(samples) / source_hz
    grid_s, resampled = only(time_s, np.ones(samples), rate_hz)
    assert grid_s[0] == 0.0
    assert grid_s[-1] <= time_s[-1] + 1e-5 / rate_hz
    assert grid_s[-1] > time_s[-1] - (1.0 + 1e-5) / rate_hz
    assert len(resampled) == len(grid_s)
    assert resampled == pytest.approx(1.0, abs=2e-3)
