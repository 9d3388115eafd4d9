import numpy as np
import pytest

from fprc.config import check
from fprc.errors import ConfigError, LogError
from fprc.experiments.reservoir import CHANNELS, commands_of, drive
from fprc.logs import read_raw, write_raw
from fprc.logs.columns import write_columns
from fprc.stages.reservoir import add_reservoir

RATE = {"experiment": "sweep", "sample_rate_hz": 200.0, "rate_tolerance": 0.01}


@pytest.fixture
def add(recorded, rig, control, tmp_path):
    """Import a sweep without a reservoir and give it one; return both paths."""

    def add(zero_deg=0.0, source="import", channels=("theta_deg", "p_exp_kpa"), **more):
        raw, driven = tmp_path / "raw.h5", tmp_path / "driven.h5"
        held = {name: recorded["sweep"][name] for name in ("time_s", *channels)}
        attributes = {"experiment": "sweep", "source": source, "sample_rate_hz": 200.0, "seed": 0}
        write_raw(raw, held | more, software="test", rig={}, **attributes)
        settings = {"zero_deg": zero_deg, "control": control, "rig": rig, "seed": 4}
        add_reservoir(str(raw), str(driven), **RATE, **settings)
        return raw, driven

    return add


def test_reservoir_answers_theta_as_it_did_in_the_experiment(recorded, rig, control):
    log = recorded["sweep"]
    commands = commands_of(log["theta_deg"], 0.0, control, "sweep.h5")
    assert commands == pytest.approx(log["p_i_command_kpa"], abs=1e-9)
    again = drive(commands, 200.0, control, rig, seed=1, number=0)
    assert again["p_i_command_kpa"].tolist() == commands.tolist()
    settled = log["time_s"] > 1.0
    for name, tolerance_kpa in (("p_i_kpa", 1.5), ("p_o_kpa", 1.0)):
        error = (again[name] - log[name])[settled]
        assert np.sqrt(np.mean(error**2)) < tolerance_kpa, name
        assert np.ptp(log[name]) > 50.0 * tolerance_kpa


def test_recording_begins_with_a_reservoir_at_rest(rig, control):
    held = drive(np.full(400, 200.0), 200.0, control, rig, seed=1, number=0)
    assert held["p_o_kpa"][:100].mean() == pytest.approx(held["p_o_kpa"][-100:].mean(), abs=0.5)
    assert len(held["p_o_kpa"]) == 400


def test_log_keeps_its_channels_and_says_what_is_simulated(add, recorded):
    raw, driven = add()
    before = raw.read_bytes()
    log = read_raw(driven, **RATE)
    assert raw.read_bytes() == before
    assert log.attributes["source"] == "import+sim"
    assert log.attributes["simulated"]
    assert log.attributes["seed"] == 4
    for name in ("theta_deg", "p_exp_kpa"):
        assert log.channels[name].tolist() == recorded["sweep"][name].tolist()
    assert log.attributes["notes"] == dict.fromkeys(
        CHANNELS, "simulated, driven by the recorded theta"
    )


def test_theta_that_asks_for_impossible_pressures_is_refused_with_a_remedy(add, recorded):
    lowest = recorded["sweep"]["theta_deg"].min()
    with pytest.raises(LogError, match=f"reservoir_zero_deg to the lowest theta, {lowest:.4g}"):
        add(zero_deg=30.0)
    with pytest.raises(LogError, match="lower control.k_in_kpa_per_deg"):
        add(zero_deg=-200.0)


@pytest.mark.parametrize("source", ["sim", "rig"])
def test_reservoir_is_simulated_for_recorded_logs_only(source):
    asked = {"evaluation": {"reservoir": "simulated"}}
    check(asked | {"source": "recorded"})
    with pytest.raises(ConfigError, match=f"for recorded logs, and source is {source}"):
        check(asked | {"source": source})


def test_theta_that_is_no_angle_asks_no_reservoir_for_pressures(add, tmp_path):
    raw, _ = add()
    log = read_raw(raw, **RATE)
    notes = {"theta_deg": "not in deg: displacement x [mm]"}
    write_columns(raw, log.channels, log.attributes | {"notes": notes})
    with pytest.raises(LogError, match=r"theta_deg: not in deg: displacement"):
        add_reservoir(
            str(raw), str(tmp_path / "other.h5"), **RATE, zero_deg=0.0, control={}, rig={}, seed=4
        )
