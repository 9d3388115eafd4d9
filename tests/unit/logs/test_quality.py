import copy
import json
from pathlib import Path

import numpy as np
import pytest

from fprc.config import Settings
from fprc.config.settings import Control, Quality, Signal
from fprc.experiments.hysteresis import acquire
from fprc.logs import Columns, assess
from fprc.logs.quality import noted_unit, warnings

CHECKS = {"complete", "gaps", "range", "stuck", "leak"}
ATMOSPHERE_KPA = 101.325


def log_of(channels, experiment="sweep"):
    writable = {name: np.array(values) for name, values in channels.items()}
    attributes = {"experiment": experiment, "source": "sim", "sample_rate_hz": 200.0}
    return Columns(Path("folder/log.h5"), writable, attributes)


@pytest.fixture
def log(recorded):
    return log_of(recorded["sweep"])


def judge(log, **limits):
    return assess(log, Quality().changed(**limits), 200.0)


def failed(log, **limits):
    record = judge(log, **limits)
    assert set(record["checks"]) == CHECKS
    return {name for name, check in record["checks"].items() if not check["passed"]}


@pytest.mark.parametrize("experiment", ["sweep", "complex"])
def test_clean_log_passes_every_check(recorded, experiment):
    log = log_of(recorded[experiment], experiment)
    assert failed(log) == set()
    assert warnings(judge(log)) == []


def test_record_holds_every_check_and_is_json(log):
    log.attributes["statistics"] = {"overruns": 3, "jitter_p99_s": 1e-4}
    record = judge(log)
    assert record["loop"] == {"overruns": 3, "jitter_p99_s": 1e-4}
    assert (record["log"], record["experiment"]) == ("log.h5", "sweep")
    assert (record["source"], record["samples"]) == ("sim", 4000)
    assert json.loads(json.dumps(record, allow_nan=False)) == record


@pytest.mark.parametrize("missing", [1, 10])
def test_gap_is_found_at_its_first_sample(log, missing):
    for name in log.channels:
        log.channels[name] = np.delete(log.channels[name], slice(1000, 1000 + missing))
    assert failed(log) == {"gaps"}
    gaps = judge(log)["checks"]["gaps"]
    assert (gaps["count"], gaps["first_sample"]) == (1, 1000)
    assert gaps["longest_s"] == pytest.approx((missing + 1) / 200)


def test_jitter_below_half_a_period_is_no_gap(log):
    rng = np.random.default_rng(0)
    log.channels["time_s"] += rng.uniform(0.0, 0.0024, size=4000)
    assert failed(log) == set()


PRESSURE, ANGLE, VOLTAGE, EFFORT = [-20.0, 995.0], [-45.0, 120.0], [0.0, 10.0], [-1000.0, 1000.0]


@pytest.mark.parametrize(
    ("channel", "value", "limits"),
    [
        ("p_exp_command_kpa", 1e6, PRESSURE), ("p_exp_kpa", 1000.0, PRESSURE),
        ("p_i_command_kpa", -30.0, PRESSURE), ("p_i_kpa", 999.0, PRESSURE),
        ("p_o_kpa", -60.0, PRESSURE), ("theta_deg", 300.0, ANGLE), ("theta_d_deg", 121.0, ANGLE),
        ("phi_deg", 121.0, [-120.0, 120.0]), ("valve_main_v", -0.1, VOLTAGE),
        ("valve_reservoir_v", 10.1, VOLTAGE), ("p_ff_kpa", 1001.0, EFFORT),
        ("p_fb_kpa", -2000.0, EFFORT),
    ],
)  # fmt: skip
def test_implausible_samples_of_every_channel_are_counted_and_the_first_is_named(
    log, channel, value, limits
):
    log.channels.setdefault(channel, np.zeros(4000))[200:203] = value
    assert "range" in failed(log)
    record = judge(log)
    counts = record["checks"]["range"]["samples"]
    assert counts[channel] == sum(counts.values()) == 3
    first = record["checks"]["range"]["first"]
    assert first == {channel: {"sample": 200, "value": value, "limits": limits}}
    json.dumps(record, allow_nan=False)


def test_channels_without_a_checksum_are_listed(log):
    assert "no_checksum" not in judge(log)
    assert judge(log._replace(unchecked=("p_o_kpa",)))["no_checksum"] == ["p_o_kpa"]


@pytest.mark.parametrize("channel", ["p_exp_kpa", "p_i_kpa", "p_o_kpa", "theta_deg"])
def test_stuck_channel_is_found_wherever_it_sticks(log, channel):
    for start in (0, 1000, 3500):
        log_copy = log_of(log.channels)
        log_copy.channels[channel][start : start + 450] = log.channels[channel][start]
        assert "stuck" in failed(log_copy)
        longest = judge(log_copy)["checks"]["stuck"]["longest_unchanged_samples"]
        assert longest[channel] >= 450
        assert max(n for name, n in longest.items() if name != channel) < 100


def test_channel_unchanged_for_less_than_the_limit_is_not_stuck(log):
    log.channels["theta_deg"][1000:1350] = log.channels["theta_deg"][1000]
    assert failed(log) == set()
    assert failed(log, stuck_s=1.0) == {"stuck"}


@pytest.mark.parametrize("experiment", ["sweep", "complex"])
def test_leak_of_twice_the_limit_is_found_in_a_log_of_full_length(experiment):
    settings = Settings().model_dump()
    rig, signal = copy.deepcopy(settings["rig"]), Signal(**settings["experiments"][experiment])
    limit = settings["quality"]["leak_kpa_per_min"]
    volume = rig["reservoir"]["passive_volume_ml"]
    # P_o is about 120 kPa on average
    leak = 2.0 * limit / 60.0 * volume / (ATMOSPHERE_KPA * 120.0)
    for leak_ml_per_s_kpa, expected in ((leak, {"leak"}), (0.0, set())):
        rig["reservoir"]["leak_ml_per_s_kpa"] = leak_ml_per_s_kpa
        log = log_of(acquire(experiment, signal, Control(**settings["control"]), rig, seed=1))
        assert failed(log) == expected


def test_leak_is_measured_by_the_clock_of_the_log_and_not_in_a_short_one(recorded):
    """A known slope of a chamber that follows P_i without hysteresis, for any start time."""
    rng = np.random.default_rng(0)
    repeats = {name: np.tile(values, 4) for name, values in recorded["sweep"].items()}
    repeats["time_s"] = np.arange(16_000) / 200.0
    fall = 100.0 + 0.2 * repeats["p_i_kpa"] - 12.0 * repeats["time_s"] / 60.0
    repeats["p_o_kpa"] = fall + 0.1 * rng.normal(size=16_000)
    for origin_s in (0.0, 1.7e9):
        log = log_of(repeats | {"time_s": repeats["time_s"] + origin_s})
        leak = judge(log)["checks"]["leak"]
        assert leak["kpa_per_min"] == pytest.approx(-12.0, abs=0.3)
        assert not leak["passed"]
    short = log_of({name: values[:11_000] for name, values in repeats.items()})
    assert judge(short)["checks"]["leak"]["kpa_per_min"] is None


def test_growing_squeeze_is_not_mistaken_for_a_leak_and_does_not_hide_one(recorded):
    """P_o by Boyle's law, for a P_i of growing amplitude: nonlinear, and correlated with time."""
    t = np.arange(16_000) / 200.0
    p_i = (t / 4.0) ** 2 * (0.5 - 0.5 * np.cos(2.0 * np.pi * t))
    noise = 0.1 * np.random.default_rng(0).normal(size=16_000)
    repeats = {name: np.tile(values, 4) for name, values in recorded["sweep"].items()}
    for leak_kpa_per_min in (0.0, 10.0):
        boyle = 201.3 * 30.0 / (30.0 - p_i / 40.0) - ATMOSPHERE_KPA
        p_o = boyle - leak_kpa_per_min * t / 60.0 + noise
        log = log_of(repeats | {"time_s": t, "p_i_kpa": p_i, "p_o_kpa": p_o})
        found = judge(log)["checks"]["leak"]
        assert found["kpa_per_min"] == pytest.approx(-leak_kpa_per_min, abs=0.5)
        assert found["passed"] is (leak_kpa_per_min == 0.0)


def test_reservoir_that_was_never_driven_and_one_sample_have_a_record(log, channels):
    log.channels["p_i_kpa"][:] = 0.0
    short = log_of({name: values[:1] for name, values in channels.items()})
    for checked in (log, short):
        record = judge(checked)
        assert record["checks"]["leak"]["passed"]
        json.dumps(record, allow_nan=False)


def test_each_failed_check_gives_one_warning_that_names_log_and_check(log):
    log.channels["p_exp_kpa"][10] = 1000.0
    log.channels["time_s"] *= 2.0
    lines = warnings(judge(log))
    assert [line.split(": ")[:2] for line in lines] == [["log.h5", "gaps"], ["log.h5", "range"]]


@pytest.mark.parametrize(
    ("attributes", "reason", "lost"),
    [({}, None, 0), ({"complete": True, "lost_samples": 0}, None, 0),
     ({"complete": False, "incomplete_reason": "cut", "lost_samples": 3}, "cut", 3),
     ({"complete": False}, "unknown", 0)],
)  # fmt: skip
def test_log_that_is_not_complete_fails_with_its_reason(log, attributes, reason, lost):
    log.attributes.update(attributes)
    expected = {"passed": reason is None, "reason": reason, "lost_samples": lost}
    found = judge(log)["checks"]["complete"]
    assert {name: found[name] for name in expected} == expected
    assert (reason or "") in found["finding"]
    assert failed(log) == ({"complete"} if reason else set())


@pytest.mark.parametrize(
    ("note", "unit"),
    [("not in kPa: motor force F [N]", "N"), ("not in kPa: force [left] of muscle [N m]", "N m"),
     ("not in kPa: scaled command", "1"), ("motor force F [N]", "kPa"), (None, "kPa")],
)  # fmt: skip
def test_unit_of_another_quantity_is_read_from_its_note(note, unit):
    attributes = {} if note is None else {"notes": {"p_exp_kpa": note}}
    assert noted_unit("p_exp_kpa", attributes) == unit
