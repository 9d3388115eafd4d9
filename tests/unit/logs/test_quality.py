import copy
import json
import re
from pathlib import Path

import numpy as np
import pytest

from fprc.config import Settings
from fprc.config.settings import Control, Quality, Signal
from fprc.experiments.data import acquire
from fprc.logs import Columns, assess
from fprc.logs.quality import noted_unit, warnings

ATMOSPHERE_KPA = 101.325


def log_of(channels, experiment="sweep"):
    writable = {name: np.array(values) for name, values in channels.items()}
    attributes = {"experiment": experiment, "source": "sim", "sample_rate_hz": 200.0}
    return Columns(Path("folder/log.h5"), writable, attributes)


@pytest.fixture
def log(recorded):
    return log_of(recorded["sweep"])


def numbers(finding):
    """Return the numbers in a finding."""
    return [float(text) for text in re.findall(r"(?<![a-z])-?\d[\d.e+]*", finding)]


def judge(log, **limits):
    record = assess(log, Quality().changed(**limits), 200.0)
    assert json.loads(json.dumps(record, allow_nan=False)) == record
    return record


def failed(log, **limits):
    record = judge(log, **limits)
    found = {name for name, check in record["checks"].items() if not check["passed"]}
    lines = [line.split(": ")[:2] for line in warnings(record)]
    assert lines == [["log.h5", name] for name in record["checks"] if name in found]
    return found


@pytest.mark.parametrize("experiment", ["sweep", "complex"])
def test_clean_log_passes_every_check(recorded, experiment):
    log = log_of(recorded[experiment], experiment)
    log.channels["time_s"] += np.random.default_rng(0).uniform(0.0, 0.0024, size=4000)
    assert failed(log) == set()
    record = judge(log)
    assert [*record["checks"]] == ["complete", "gaps", "range", "stuck", "leak"]
    about = [record[key] for key in ("log", "experiment", "source", "samples")]
    assert about == ["log.h5", experiment, "sim", 4000]
    assert not {"loop", "notes"} & record.keys()
    log.attributes["statistics"] = {"overruns": 3}
    assert judge(log)["loop"] == {"overruns": 3}


@pytest.mark.parametrize("missing", [1, 10])
def test_gap_is_found_at_its_first_sample(log, missing):
    for name in log.channels:
        log.channels[name] = np.delete(log.channels[name], slice(1000, 1000 + missing))
    assert failed(log) == {"gaps"}
    finding = judge(log)["checks"]["gaps"]["finding"]
    assert numbers(finding) == pytest.approx([1, 1000, (missing + 1) / 200, 0.0075])


@pytest.mark.parametrize(
    ("channel", "value", "low", "high"),
    [
        ("p_exp_command_kpa", 1e6, -20, 995), ("p_exp_kpa", 1000.0, -20, 995),
        ("p_i_command_kpa", -30.0, -20, 995), ("p_i_kpa", 999.0, -20, 995),
        ("p_o_kpa", -60.0, -20, 995), ("theta_deg", 300.0, -45, 120),
        ("theta_d_deg", 121.0, -45, 120), ("phi_deg", 121.0, -120, 120),
        ("valve_main_v", -0.1, 0, 10), ("valve_reservoir_v", 10.1, 0, 10),
        ("p_ff_kpa", 1001.0, -1000, 1000), ("p_fb_kpa", -2000.0, -1000, 1000),
    ],
)  # fmt: skip
def test_implausible_samples_of_every_channel_are_counted_and_the_first_is_named(
    log, channel, value, low, high
):
    log.channels.setdefault(channel, np.zeros(4000))[200:203] = value
    assert "range" in failed(log)
    found = judge(log)["checks"]["range"]
    assert found["samples"][channel] == sum(found["samples"].values()) == 3
    assert found["finding"].startswith(f"channel {channel}: ")
    assert numbers(found["finding"]) == [200, value, low, high, 3]


@pytest.mark.parametrize("channel", ["p_exp_kpa", "p_i_kpa", "p_o_kpa", "theta_deg"])
@pytest.mark.parametrize("start", [0, 1000, 3500])
def test_stuck_channel_is_found_wherever_it_sticks(log, channel, start):
    log.channels[channel][start : start + 450] = log.channels[channel][start]
    assert "stuck" in failed(log)
    assert judge(log)["checks"]["stuck"]["finding"].startswith(f"channel {channel}: ")
    assert "stuck" not in failed(log, stuck_s=2.5)


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


@pytest.mark.parametrize("leak", [0.0, 12.0])
@pytest.mark.parametrize("origin_s", [0.0, 1.7e9])
def test_leak_is_measured_by_the_clock_and_apart_from_the_squeeze(recorded, leak, origin_s):
    """A known slope beside a squeeze by Boyle's law, which grows with time."""
    t = np.arange(16_000) / 200.0
    p_i = (t / 4.0) ** 2 * (0.5 - 0.5 * np.cos(2.0 * np.pi * t))
    noise = 0.1 * np.random.default_rng(0).normal(size=16_000)
    p_o = 201.3 * 30.0 / (30.0 - p_i / 40.0) - ATMOSPHERE_KPA - leak * t / 60.0 + noise
    repeats = {name: np.tile(values, 4) for name, values in recorded["sweep"].items()}
    repeats |= {"time_s": t + origin_s, "p_i_kpa": p_i, "p_o_kpa": p_o}
    found = judge(log_of(repeats))["checks"]["leak"]
    assert numbers(found["finding"]) == pytest.approx([-leak, -5.0], abs=0.5)
    assert found["passed"] is (leak == 0.0)
    for samples in (1, 11_000):
        short = log_of({name: values[:samples] for name, values in repeats.items()})
        assert "shorter than 60 s" in judge(short)["checks"]["leak"]["finding"]


def test_reservoir_that_was_never_driven_has_a_record(log):
    log.channels["p_i_kpa"][:] = 0.0
    assert judge(log)["checks"]["leak"]["passed"]


@pytest.mark.parametrize(
    ("attributes", "finding"),
    [({}, ""), ({"complete": True, "lost_samples": 0}, ""), ({"complete": False}, "unknown"),
     ({"complete": False, "incomplete_reason": "cut", "lost_samples": 3}, "cut; lost samples: 3")],
)  # fmt: skip
def test_log_that_is_not_complete_fails_with_its_reason(log, attributes, finding):
    log.attributes.update(attributes)
    assert failed(log) == ({"complete"} if finding else set())
    assert judge(log)["checks"]["complete"]["finding"] == finding


@pytest.mark.parametrize(
    ("note", "unit"),
    [("not in kPa: motor force F [N]", "N"), ("not in kPa: force [left] of muscle [N m]", "N m"),
     ("not in kPa: scaled command", "1"), ("motor force F [N]", "kPa"), (None, "kPa")],
)  # fmt: skip
def test_unit_of_another_quantity_is_read_from_its_note(note, unit):
    attributes = {} if note is None else {"notes": {"p_exp_kpa": note}}
    assert noted_unit("p_exp_kpa", attributes) == unit
