"""`fprc import` from a file to a raw log."""

from pathlib import Path

import numpy as np
import pandas as pd
import pytest
import yaml
from hypothesis import given
from hypothesis import strategies as st

from fprc.channels import RAW_CHANNELS, unit_of
from fprc.cli import main
from fprc.config import Settings
from fprc.errors import ConfigError, FprcError
from fprc.experiments.data import select_channels
from fprc.logs import assess, read_raw
from fprc.recordings.import_recording import draft_map, import_or_draft
from fprc.recordings.table import Column, Table

pytestmark = pytest.mark.slow

RATE = {"experiment": "sweep", "sample_rate_hz": 200.0, "rate_tolerance": 0.01}
LIMITS = Settings().quality
ANGLE = {"column": "theta_deg", "unit": "deg"}
COMMAND = {"column": "p_exp_command_kpa", "unit": "kPa"}
BOTH = {"theta_deg": ANGLE, "p_exp_command_kpa": COMMAND}


@pytest.fixture
def bring(recorded, tmp_path):
    """Import a simulated sweep, written as CSV, with the given channels."""

    def bring(channels=BOTH, **more):
        pd.DataFrame(recorded["sweep"]).to_csv(tmp_path / "log.csv", index=False)
        mapping = {"experiment": "sweep", "time": {"column": "time_s"}, "channels": channels} | more
        (tmp_path / "map.yaml").write_text(yaml.safe_dump(mapping))
        raw = tmp_path / "sweep.h5"
        import_or_draft(str(tmp_path / "log.csv"), map_=str(tmp_path / "map.yaml"), out=str(raw))
        return raw

    return bring


def test_log_goes_out_as_csv_and_comes_back_the_same(bring, recorded):
    names = [name for name in RAW_CHANNELS if name != "time_s"]
    raw = bring({name: {"column": name, "unit": unit_of(name)} for name in names})
    log = read_raw(raw, **RATE)
    assert set(log.channels) == set(RAW_CHANNELS)
    for name in names:
        assert log.channels[name].tolist() == recorded["sweep"][name].tolist()
    assert log.attributes["source"] == "import"


@pytest.mark.parametrize("name", ["sweep.h5", "sweep.png"])
def test_file_that_no_import_wrote_is_kept(bring, tmp_path, name):
    (tmp_path / name).write_text("mine")
    with pytest.raises(FprcError, match=f"{name}: exists and was not made by this command"):
        bring()
    assert [(path.name, path.read_text()) for path in tmp_path.glob("sweep*")] == [(name, "mine")]


def test_import_needs_to_know_which_log_it_writes(bring):
    with pytest.raises(ConfigError, match="experiment is missing"):
        bring(experiment=None, test_from_s=5)


@pytest.mark.parametrize("name", [r"$\frac{$", "=1, a\x1b[2J", "日本"])
def test_column_of_any_name_is_imported_and_drawn(tmp_path, name):
    table = pd.DataFrame({"t": np.arange(20) / 200.0, name: np.arange(20.0), "p": np.ones(20)})
    table.to_csv(tmp_path / "log.csv", index=False)
    theta = {"column": name, "unit": "deg", "note": f"from {name}"}
    raw = imported(tmp_path, {"theta_deg": theta, "p_exp_kpa": {"column": "p", "unit": "kPa"}})
    assert read_raw(raw, **RATE).channels["theta_deg"].tolist() == list(range(20))
    assert sorted(path.name for path in tmp_path.glob("sweep*")) == ["sweep.h5", "sweep.png"]


def imported(folder, channels, **more):
    """Import a CSV of a folder by the command line, and return the log."""
    mapping = {"experiment": "sweep", "time": {"column": "t"}, "channels": channels} | more
    (folder / "map.yaml").write_text(yaml.safe_dump(mapping))
    names = [str(folder / name) for name in ("log.csv", "map.yaml", "sweep.h5")]
    assert main(["import", names[0], "--map", names[1], "--out", names[2]]) == 0
    return folder / "sweep.h5"


def test_newtons_are_not_taken_for_kilopascals(bring):
    force = {"column": "p_i_kpa", "unit": 1, "scale": 10, "note": "motor force F [N]"}
    log = read_raw(bring({"theta_deg": ANGLE, "p_exp_kpa": force}), **RATE)
    record = assess(log, LIMITS, 200.0)
    assert log.channels["p_exp_kpa"].max() > LIMITS.pressure_range_kpa[1]
    assert record["notes"] == {"p_exp_kpa": "not in kPa: motor force F [N]"}
    assert record["checks"]["range"]["passed"]
    assert select_channels(log, "command").unit == "N"


def test_import_repeats_what_it_took_and_what_it_left_out(tmp_path, capsys):
    lines = [f"{k / 200:g},{k},{k / 20:g}\n" for k in range(40)]
    text = "t,a [deg],p [bar]\n" + "".join([*lines[:9], "pump\n", *lines[9:]])
    (tmp_path / "log.csv").write_text(text)
    channels = {"theta_deg": {"column": "a [deg]", "unit": "deg"},
                "p_exp_kpa": {"column": "p [bar]", "unit": "kPa"}}  # fmt: skip
    raw = imported(tmp_path, channels, skip_unusable=True)
    said = capsys.readouterr().out
    assert "p_exp_kpa from p [bar]: 0 to 1.95 kPa" in said
    assert "doubtful: channels.p_exp_kpa: the file says bar of p [bar], the map kPa" in said
    assert "line 11: 'pump'" in said
    assert "line 11: 'pump'" in read_raw(raw, **RATE).attributes["notes"]["time_s"]


@given(name=st.text().map("{} [s]".format))
def test_draft_quotes_any_name_as_yaml(name):
    columns = {name: Column(np.arange(9) / 8.0), "p [bar]": Column(np.arange(9.0))}
    (*lines,) = draft_map(Table(Path("log.csv"), "", columns, {})).splitlines()
    assert all(map(str.isprintable, lines))
    assert yaml.safe_load("\n".join(lines))["time"]["column"] == name
