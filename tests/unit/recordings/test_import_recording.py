import logging
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
import yaml
from hypothesis import given
from hypothesis import strategies as st
from sklearn.model_selection import LeaveOneGroupOut

from fprc.channels import RAW_CHANNELS
from fprc.cli import main
from fprc.config import Settings
from fprc.config.settings import Quality
from fprc.errors import ConfigError, LogError, OutputError
from fprc.experiments.data import Data, read_data, refuse_mixture
from fprc.logs import assess, read_raw
from fprc.models import FPRC
from fprc.recordings.draft import _line
from fprc.recordings.import_recording import import_or_draft
from fprc.stages.preprocess import preprocess

pytestmark = pytest.mark.slow

RATE = {"experiment": "sweep", "sample_rate_hz": 200.0, "rate_tolerance": 0.01}
LIMITS = Settings().quality.model_dump()
ANGLE = {"column": "theta_deg", "unit": "deg"}
COMMAND = {"column": "p_exp_command_kpa", "unit": "kPa"}


@pytest.fixture
def bring(recorded, tmp_path, undrawn):
    """Import a simulated sweep, written as CSV, with the given channels."""

    def bring(channels, lost=slice(0), **more):
        table = pd.DataFrame(recorded["sweep"])
        table.drop(index=table.index[lost]).to_csv(tmp_path / "log.csv", index=False)
        mapping = {"experiment": "sweep", "time": {"column": "time_s"}, "channels": channels} | more
        (tmp_path / "map.yaml").write_text(yaml.safe_dump(mapping))
        raw = tmp_path / "sweep.h5"
        import_or_draft(str(tmp_path / "log.csv"), map_=str(tmp_path / "map.yaml"), out=str(raw))
        return raw

    return bring


def prepared(raw):
    data, quality = raw.with_name("data.h5"), raw.with_name("quality.json")
    preprocess(
        str(raw), str(data), str(quality),
        experiment="sweep", target="command", sample_rate_hz=200.0, limits=LIMITS,
    )  # fmt: skip
    return data


def test_log_goes_out_as_csv_and_comes_back_the_same(bring, recorded):
    names = [name for name in RAW_CHANNELS if name != "time_s"]
    units = {"kpa": "kPa", "deg": "deg", "_v": "V"}
    unit = {name: next(u for end, u in units.items() if name.endswith(end)) for name in names}
    raw = bring({name: {"column": name, "unit": unit[name]} for name in names})
    log = read_raw(raw, **RATE)
    assert set(log.channels) == set(RAW_CHANNELS)
    for name in names:
        assert log.channels[name].tolist() == recorded["sweep"][name].tolist()
    assert log.attributes["source"] == "import"


@pytest.mark.parametrize(
    ("name", "content"),
    [
        ("sweep.diagnosis.json", '{"source": "a", "log": "other.h5", "words": []}'),
        ("sweep.diagnosis.png", "mine"),
        ("sweep.diagnosis.png", None),
    ],
)
def test_file_that_no_import_wrote_is_kept_and_nothing_written(bring, tmp_path, name, content):
    if content is None:
        (tmp_path / name).mkdir()
    else:
        (tmp_path / name).write_text(content)
    with pytest.raises(OutputError, match=f"{name}: exists and was not made by this command"):
        bring({"theta_deg": ANGLE, "p_exp_command_kpa": COMMAND})
    assert [path.name for path in tmp_path.glob("sweep*")] == [name]
    assert content is None or (tmp_path / name).read_text() == content


def test_map_of_two_parts_is_for_another_command(bring):
    channels = {"theta_deg": ANGLE, "p_exp_command_kpa": COMMAND}
    with pytest.raises(ConfigError, match="test_from_s is for `fprc readout`"):
        bring(channels, experiment=None, test_from_s=5)


# --- all or nothing -------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("fails", "old"),
    [("write_json", False), ("write_raw", True), ("resample", True)],
)
def test_import_that_fails_leaves_everything_as_it_was(bring, monkeypatch, old, fails):
    channels = {"theta_deg": ANGLE, "p_exp_command_kpa": COMMAND}
    folder = bring(channels).parent
    if not old:
        for path in folder.glob("sweep.*"):
            path.unlink()
    before = {path: path.read_bytes() for path in folder.iterdir()}

    def fail(*arguments, **named):
        raise ZeroDivisionError

    monkeypatch.setattr(f"fprc.recordings.import_recording.{fails}", fail)
    with pytest.raises(ZeroDivisionError):
        bring(channels)
    assert {path: path.read_bytes() for path in folder.iterdir()} == before


def test_picture_that_cannot_be_drawn_costs_no_log(bring, monkeypatch, capsys):
    channels = {"theta_deg": ANGLE, "p_exp_command_kpa": COMMAND}
    before = bring(channels).read_bytes()

    def fail(*arguments, **named):
        raise ZeroDivisionError

    monkeypatch.setattr("fprc.recordings.import_recording.draw_diagnosis", fail)
    raw = bring(channels)
    assert raw.read_bytes() == before
    assert "no picture" in capsys.readouterr().out
    assert not raw.with_name("sweep.diagnosis.png").exists()


@pytest.mark.parametrize("name", [r"$\frac{$", "$x$ `b` | <i>", "=1, a\x1b[2J", "日本"])
def test_column_of_any_name_is_imported_and_drawn(tmp_path, name):
    table = pd.DataFrame({"t": np.arange(20) / 200.0, name: np.arange(20.0), "p": np.ones(20)})
    table.to_csv(tmp_path / "log.csv", index=False)
    theta = {"column": name, "unit": "deg", "note": f"from {name}"}
    raw = imported(tmp_path, {"theta_deg": theta, "p_exp_kpa": {"column": "p", "unit": "kPa"}})
    assert read_raw(raw, **RATE).channels["theta_deg"].tolist() == list(range(20))
    assert sorted(path.name for path in tmp_path.glob("sweep*")) == [
        "sweep.diagnosis.json", "sweep.diagnosis.png", "sweep.h5",
    ]  # fmt: skip


def imported(folder, channels, **more):
    """Import a CSV of a folder by the command line, and return the log."""
    mapping = {"experiment": "sweep", "time": {"column": "t"}, "channels": channels} | more
    (folder / "map.yaml").write_text(yaml.safe_dump(mapping))
    names = [str(folder / name) for name in ("log.csv", "map.yaml", "sweep.h5")]
    assert main(["import", names[0], "--map", names[1], "--out", names[2]]) == 0
    return folder / "sweep.h5"


# --- what may be absent ---------------------------------------------------------------------


def test_gap_that_is_filled_is_noted_in_the_log(bring):
    raw = bring({"theta_deg": ANGLE, "p_exp_command_kpa": COMMAND}, lost=slice(1000, 1300))
    log = read_raw(raw, **RATE)
    assert len(log.channels["time_s"]) == 4000
    noted = assess(log, Quality(**LIMITS), 200.0)["notes"]["time_s"]
    assert "gaps, filled by linear interpolation: 1, about 300 samples" in noted


def test_newtons_are_not_taken_for_kilopascals_and_not_mixed_with_them(bring, caplog):
    force = {"column": "p_i_kpa", "unit": 1, "scale": 10, "note": "motor force F [N]"}
    raw = bring({"theta_deg": ANGLE, "p_exp_kpa": force})
    note = "not in kPa: motor force F [N]"
    log = read_raw(raw, **RATE)
    record = assess(log, Quality(**LIMITS), 200.0)
    assert log.channels["p_exp_kpa"].max() > LIMITS["pressure_range_kpa"][1]
    assert record["notes"] == {"p_exp_kpa": note}
    assert record["checks"]["range"]["passed"]
    with caplog.at_level(logging.WARNING):
        data = read_data(str(prepared(raw)))
    assert f"p_exp_kpa: {note}" in caplog.text
    assert data.attributes["notes"] == {"p_exp_kpa": note}
    assert (data.unit, data.attributes["theta_unit"]) == ("N", "deg")
    refuse_mixture(data, data)
    plain = Data(data.channels, data.attributes | {"p_target_unit": "kPa"})
    with pytest.raises(LogError, match="training log is in N, that of the test log in kPa"):
        refuse_mixture(data, plain)


# --- what the import says -------------------------------------------------------------------


@pytest.mark.usefixtures("undrawn")
@pytest.mark.parametrize(
    ("header", "spec", "doubt"),
    [
        ("p [bar]", {"unit": "kPa"}, "p_exp_kpa: the file says bar of p [bar], the map kPa"),
        ("p [A]", {"unit": "kPa"}, "p_exp_kpa: the file says A of p [A], the map kPa"),
        ("p", {"unit": "kPa"}, "p_exp_kpa: 0.2 to 2.2 kPa are unusual; is p in bar or psi?"),
        ("p", {"unit": "bar"}, None),
        ("p [bar]", {"unit": "kPa", "scale": 100.0}, None),
        ("p [A]", {"unit": "1", "note": "current [A]"}, None),
    ],
)
def test_import_repeats_what_it_took_and_doubts_what_the_file_denies(
    tmp_path, capsys, header, spec, doubt
):
    table = pd.DataFrame({"t": np.arange(40) / 200.0, "a [deg]": np.arange(40.0)})
    table.assign(**{header: np.linspace(0.2, 2.2, 40)}).to_csv(tmp_path / "log.csv", index=False)
    theta = {"column": "a [deg]", "unit": "deg"}
    imported(tmp_path, {"theta_deg": theta, "p_exp_kpa": {"column": header, **spec}})
    said = capsys.readouterr().out
    assert f"taken: time from t (s); p_exp_kpa from {header} ({spec['unit']}); " in said
    assert [line.strip()[10:] for line in said.splitlines() if "doubtful: " in line] == (
        [doubt] if doubt else []
    )


@pytest.mark.usefixtures("undrawn")
def test_samples_that_were_left_out_are_noted_in_the_log(tmp_path):
    lines = [f"{k / 200:g},{k},5\n" for k in range(40)]
    (tmp_path / "log.csv").write_text("t,a,p\n" + "".join([*lines[:9], "pump\n", *lines[9:]]))
    channels = {name: {"column": column, "unit": unit} for name, column, unit in (
        ("theta_deg", "a", "deg"), ("p_exp_kpa", "p", "kPa"))}  # fmt: skip
    raw = imported(tmp_path, channels, skip_unusable=True)
    assert "line 11: 'pump'" in read_raw(raw, **RATE).attributes["notes"]["time_s"]


# --- the page that explains it --------------------------------------------------------------

DOCS = Path(__file__).parents[3] / "docs"


def test_several_recordings_of_the_page_are_fitted_both_ways():
    page = (DOCS / "chamber.md").read_text(encoding="utf-8")
    snippet = page.split("```python\n")[1].split("```")[0]
    rng = np.random.default_rng(0)
    names = {"np": np, "FPRC": FPRC, "LeaveOneGroupOut": LeaveOneGroupOut}
    for i in range(1, 5):
        names |= {f"X{i}": rng.uniform(0.0, 60.0, (300, 2)), f"y{i}": rng.uniform(0.0, 350.0, 300)}
    exec(compile(snippet, "docs/chamber.md", "exec"), names)
    X, y, lengths = names["X"], names["y"], names["lengths"]
    rows = [
        names["prepared"].features.transform(part) for part in np.split(X, np.cumsum(lengths)[:-1])
    ]
    again = FPRC(random_state=1).make_readout().fit(np.vstack(rows), y)
    np.testing.assert_allclose(names["model"].readout_.predict(rows[2]), again.predict(rows[2]))
    assert len(names["errors"]) == 3


@given(name=st.text())
def test_draft_quotes_any_name_as_yaml(name):
    line = _line("time", {"column": name, "unit": "s"}, name)
    assert line.isprintable()
    assert yaml.safe_load(line) == {"time": {"column": name, "unit": "s"}}
