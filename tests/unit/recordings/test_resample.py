import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from fprc.recordings.gather import resample


def sine(time_s, f_hz, phase=0.3):
    return np.sin(2.0 * np.pi * f_hz * time_s + phase)


def only(time_s, values, rate_hz):
    grid_s, channels = resample(time_s, {"x": values}, rate_hz)
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
    start_s=st.floats(-10.0, 10.0),
)
def test_grid_begins_at_the_first_sample_and_ends_by_the_last(samples, source_hz, rate_hz, start_s):
    time_s = start_s + np.arange(samples) / source_hz
    grid_s, resampled = only(time_s, np.ones(samples), rate_hz)
    assert grid_s[0] == time_s[0]
    assert grid_s[-1] <= time_s[-1] + 1e-5 / rate_hz
    assert grid_s[-1] > time_s[-1] - (1.0 + 1e-5) / rate_hz
    assert len(resampled) == len(grid_s)
    assert resampled == pytest.approx(1.0, abs=2e-3)
