import json

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from fprc.logs import sealed_chamber as sealed
from fprc.recordings import diagnosis
from fprc.recordings.diagnosis import describe
from fprc.recordings.gather import Recording

QUALITY = {"gap_periods": 1.5, "stuck_s": 2.0}


def diagnose(time_s, channels):
    recording = Recording(time_s, channels)
    return diagnosis.diagnose(recording, quality=QUALITY)


RATE_HZ = 200.0
TIME_S = np.arange(8000) / RATE_HZ


def wave(time_s=TIME_S, f_hz=0.31, amplitude=30.0, noise=0.01):
    rng = np.random.default_rng(0)
    return amplitude * np.sin(2 * np.pi * f_hz * time_s) + noise * rng.standard_normal(len(time_s))


def of(values, time_s=TIME_S):
    return diagnose(time_s, {"theta_deg": values})["channels"]["theta_deg"]


# --- clock ----------------------------------------------------------------------------------


def test_clean_recording_has_an_even_clock_and_nothing_else():
    found = diagnose(TIME_S, {"theta_deg": wave(), "p_exp_kpa": wave(f_hz=0.2)})
    assert found["clock"]["mean_hz"] == pytest.approx(RATE_HZ)
    assert found["clock"]["gaps"] == []
    assert found["identical"] == []
    assert found["sealed"] is None
    for channel in found["channels"].values():
        assert channel["new_values_hz"] == pytest.approx(RATE_HZ)
        assert (channel["frozen"], channel["clipped"]) == ([], [])


def test_gap_has_its_place_and_its_missing_samples():
    time_s = np.delete(TIME_S, slice(1000, 1030))
    (gap,) = diagnose(time_s, {"theta_deg": wave(time_s)})["clock"]["gaps"]
    assert (gap["from_s"], gap["to_s"]) == pytest.approx((999 / 200, 1030 / 200))
    assert gap["missing_samples"] == 30


def test_jitter_is_given_by_its_percentiles():
    rng = np.random.default_rng(3)
    time_s = TIME_S + rng.normal(0.0, 2e-4, len(TIME_S))
    clock = diagnose(time_s, {"theta_deg": wave()})["clock"]
    # the difference of two normal errors; 2.326 is the 99th percentile of a normal one
    assert clock["jitter_s"] == pytest.approx(2.326 * np.sqrt(2) * 2e-4, rel=0.1)
    assert clock["gaps"] == []


# --- channels -------------------------------------------------------------------------------


@pytest.mark.parametrize("factor", [2, 4, 7, 20])
def test_rate_of_new_values_is_that_of_a_slower_sensor(factor):
    held = np.repeat(wave()[::factor], factor)[: len(TIME_S)]
    assert of(held)["new_values_hz"] == pytest.approx(RATE_HZ / factor, rel=0.01)


@pytest.mark.parametrize("samples", [300, 900])
def test_frozen_stretch_has_its_place_unless_it_is_short(samples):
    values = wave()
    values[2000 : 2000 + samples] = values[2000]
    expected = [{"from_s": 10.0, "to_s": 2899 / 200}]
    assert of(values)["frozen"] == ([] if samples == 300 else expected)


@pytest.mark.parametrize(("low", "high"), [(-40.0, 25.0), (-25.0, 40.0), (-20.0, 20.0)])
def test_clipping_is_found_at_the_side_where_it_is(low, high):
    clipped = of(np.clip(wave(), low, high))["clipped"]
    assert clipped
    at = np.clip(wave(), low, high)[[round(stretch["from_s"] * RATE_HZ) for stretch in clipped]]
    assert set(at) == {limit for limit in (low, high) if abs(limit) < 30.0}


@given(
    f_hz=st.floats(0.05, 2.0),
    step=st.sampled_from([0.0, 0.01, 0.1, 1.0]),
    factor=st.sampled_from([1, 2, 5]),
    phase=st.floats(0.0, 6.2),
)
def test_sine_is_never_clipped_or_frozen(f_hz, step, factor, phase):
    values = 30.0 * np.sin(2 * np.pi * f_hz * TIME_S + phase)
    values = np.round(values / step) * step if step else values
    channel = of(np.repeat(values[::factor], factor)[: len(TIME_S)])
    assert (channel["clipped"], channel["frozen"]) == ([], [])


def test_identical_channels_are_paired():
    same = wave()
    channels = {"theta_deg": wave(f_hz=1.0), "p_exp_kpa": same, "p_i_kpa": same.copy()}
    assert diagnose(TIME_S, channels)["identical"] == [["p_exp_kpa", "p_i_kpa"]]


# --- sealed chamber -------------------------------------------------------------------------


@pytest.fixture
def squeezed(recorded):
    """Return a simulated sweep with an artificial leak."""

    def make(leak_kpa_per_min=0.0):
        log = recorded["sweep"]
        time_s = log["time_s"]
        p_o = log["p_o_kpa"] - leak_kpa_per_min * time_s / 60.0
        return time_s, {"theta_deg": log["theta_deg"], "p_i_kpa": log["p_i_kpa"], "p_o_kpa": p_o}

    return make


def test_tight_chamber_follows_p_i(squeezed):
    found = diagnose(*squeezed())["sealed"]
    assert found["relative_to"] == "p_i_kpa"
    assert found["explained"] > 0.95


def test_leak_is_measured_against_the_same_log_without_it(squeezed):
    tight, leaky = (diagnose(*squeezed(leak))["sealed"] for leak in (0.0, 20.0))
    fall = tight["slope_kpa_per_min"] - leaky["slope_kpa_per_min"]
    assert fall == pytest.approx(20.0, rel=1e-6)


def test_without_p_i_the_angle_drives_the_squeezing(squeezed):
    time_s, channels = squeezed()
    del channels["p_i_kpa"]
    assert diagnose(time_s, channels)["sealed"]["relative_to"] == "theta_deg"


def test_pressure_that_nothing_squeezes_is_not_evaluated():
    rng = np.random.default_rng(4)
    channels = {"theta_deg": wave(), "p_o_kpa": np.cumsum(rng.standard_normal(8000))}
    assert diagnose(TIME_S, channels)["sealed"]["slope_kpa_per_min"] is None


def test_pressure_that_only_falls_and_short_recordings_are_not_judged():
    found = diagnose(TIME_S, {"theta_deg": wave(), "p_o_kpa": 200.0 - TIME_S})["sealed"]
    assert found["slope_kpa_per_min"] is None
    assert 0.0 <= found["explained"] < 0.5
    channels = {"theta_deg": wave()[:1000], "p_o_kpa": wave()[:1000]}
    assert diagnose(TIME_S[:1000], channels)["sealed"] is None


@pytest.mark.parametrize("most", [1500, 3000, 200_000])
def test_leak_of_a_long_recording_is_found_by_fewer_samples_and_beside_a_gap(monkeypatch, most):
    monkeypatch.setattr(sealed, "_MOST", most)
    time_s = np.delete(np.arange(0.0, 600.0, 0.1), slice(2000, 2500))
    wave = np.sin(2.0 * np.pi * time_s / 60.0)
    p_o = 150.0 + 30.0 * wave**3 - 3.0 * time_s / 60.0
    found = diagnose(time_s, {"theta_deg": 20.0 * wave, "p_o_kpa": p_o})["sealed"]
    assert found["slope_kpa_per_min"] == pytest.approx(-3.0, abs=0.1)


def test_last_time_of_the_grid_may_be_that_of_the_last_sample():
    time_s = 464622950.57106197 + np.arange(18371) / 200.0  # seconds since 1970 are rounded
    angle = 30.0 * np.sin(np.arange(18371) / 100.0)
    found = diagnose(time_s, {"theta_deg": angle, "p_o_kpa": 200.0 + angle})["sealed"]
    assert found["explained"] > 0.95


# --- words ----------------------------------------------------------------------------------


@pytest.mark.parametrize("unit", ["kPa", ""])
def test_every_finding_is_described_with_its_channel(squeezed, unit):
    time_s, channels = squeezed(20.0)
    channels["phi_deg"] = channels["theta_deg"]
    channels["theta_deg"] = np.clip(channels["theta_deg"], 5.0, 20.0)
    kept = np.delete(np.arange(len(time_s)), slice(3400, 3500))
    time_s, channels = time_s[kept], {name: values[kept] for name, values in channels.items()}
    channels["same_deg"] = channels["phi_deg"]
    found = diagnose(time_s, channels)
    assert json.loads(json.dumps(found, allow_nan=False)) == found
    lines = describe(found, dict.fromkeys(channels, unit))
    for begin, finding in (
        ("clock", "gaps"), ("theta_deg", "clipped"), ("theta_deg", "frozen"),
        ("phi_deg and same_deg", "identical"), ("p_o_kpa", "leaks"),
    ):  # fmt: skip
        assert any(line.startswith(f"{begin}: ") and finding in line for line in lines), finding
    assert len(lines) == len(set(lines))
