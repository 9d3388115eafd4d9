"""`fprc readout` from a file to an answer."""

from unittest.mock import Mock

import numpy as np
import pandas as pd
import pytest
import yaml

from fprc.cli import main
from fprc.given import read_json
from fprc.logs import read_columns, write_columns
from fprc.recordings import answer

pytestmark = pytest.mark.slow

CHANNELS = {
    "theta_deg": {"column": "angle", "unit": "deg"},
    "p_exp_kpa": {"column": "force", "unit": 1, "note": "force $F [N]"},
    "p_o_kpa": {"column": "memory", "unit": "kPa"},
}
FEW = {"models": {"fprc": {"n_c": 2}, "esn": {"r": 20}, "n_y": 2}}


def write_recording(folder):
    """Write 60 s of a force that depends on P_o, and few settings; return what writes a map."""
    time_s = np.arange(3000) / 50.0
    rng = np.random.default_rng(5)
    angle = 20.0 + 10.0 * np.sin(2.0 * time_s) + 8.0 * np.sin(3.3 * time_s + 0.02 * time_s**2)
    past = 100.0 + np.cumsum(rng.standard_normal(len(time_s)))
    columns = {"t": time_s, "angle": angle, "memory": past, "force": 3.0 * angle + 2.0 * past}
    pd.DataFrame(columns).to_csv(folder / "log.csv", index=False)
    (folder / "few.yaml").write_text(yaml.safe_dump(FEW))

    def write(channels=CHANNELS, **more):
        mapping = {"time": {"column": "t"}, "channels": channels} | more
        (folder / "map.yaml").write_text(yaml.safe_dump(mapping))
        return str(folder / "map.yaml")

    return write


@pytest.fixture
def stopped(monkeypatch, undrawn):
    """Interrupt the command before it judges anything; knows what it was to judge."""
    stop = Mock(side_effect=KeyboardInterrupt)
    monkeypatch.setattr(answer, "answer_recordings", stop)
    return stop


@pytest.fixture
def recording(tmp_path):
    return write_recording(tmp_path)


def run(tmp_path, map_file, *more):
    return main([
        "readout", str(tmp_path / "log.csv"), "--map", map_file, "--out", str(tmp_path / "out"),
        "--config", str(tmp_path / "few.yaml"), *more,
    ])  # fmt: skip


def log_of(tmp_path, name):
    return read_columns(tmp_path / f"out/raw/{name}.h5", ("time_s", "theta_deg"))


def test_one_command_goes_from_a_recording_to_an_answer_and_does_so_again(tmp_path, capsys):
    map_file, out = write_recording(tmp_path)(test_from_s=35), tmp_path / "out"
    assert run(tmp_path, map_file) == 0
    printed = capsys.readouterr().out
    report = read_json(out / "readout/answer.json")
    found = report["answer"]
    # the force depends on P_o, which no other input reveals
    assert found["verdict"] == "Yes"
    assert printed.startswith(found["words"])
    assert found["with"]["error"] < 0.5 * min(found["shifts"])
    errors = [found[side]["families"] for side in ("with", "without")]
    assert all(errors[0][family] < errors[1][family] for family in errors[1])
    # 60 s but the first 5, in blocks of 6 s at least, of both parts
    assert found["block_s"] == pytest.approx([55.0 / 9] * 9, rel=1e-2)
    assert all(len(blocks) == 9 for blocks in report["models"].values())
    assert [claim["id"] for claim in report["claims"]] == ["B1", "B4", "R1"]
    assert report["unit"] == "N"
    page = (out / "report.md").read_text(encoding="utf-8")
    pictures = [line.split("(")[1].rstrip(")") for line in page.splitlines() if line[:1] == "!"]
    assert pictures == ["readout/memory.png", "raw/recording.png"]
    assert all((out / name).exists() for name in pictures)
    assert run(tmp_path, map_file) == 0
    assert (out / "report.md").read_text(encoding="utf-8") == page
    pd.read_csv(tmp_path / "log.csv")[:-1].to_csv(tmp_path / "log.csv", index=False)
    assert run(tmp_path, map_file) == 1  # the folder has the page of another recording
    assert (out / "report.md").read_text(encoding="utf-8") == page


@pytest.mark.parametrize("rate_hz", [50, 20])
@pytest.mark.parametrize(
    ("pause_s", "kept", "lengths"),
    [
        (0, {}, [2000, 1000]),
        (0, {"start_s": 50, "test_from_s": 1750}, [1700, 1250]),
        (0, {"start_s": 150, "end_s": 1650}, [1000, 501]),
        (0, {"start_s": 49.5, "test_from_s": 1999.7}, [1950, 1000]),
        (20_000, {}, [1999, 1000]),
    ],
)
def test_logs_of_the_workflow_meet_at_two_thirds_or_where_the_map_says(
    recording, stopped, tmp_path, rate_hz, pause_s, kept, lengths
):
    """Every sample is in one of them, also where the border is between two; times in samples."""
    table = pd.read_csv(tmp_path / "log.csv")
    table["t"] = (np.arange(3000) + rate_hz * pause_s * (np.arange(3000) > 0)) / rate_hz
    table.to_csv(tmp_path / "log.csv", index=False)
    kept = {name: number / rate_hz for name, number in kept.items()} | (
        {"start_s": pause_s} if pause_s else {}
    )
    assert run(tmp_path, recording(**kept)) == 130
    found = [len(log_of(tmp_path, name).channels["time_s"]) for name in ("sweep", "complex")]
    assert found == lengths
    assert stopped.call_args.args[0].lengths == [sum(found)]


@pytest.mark.parametrize(
    ("own_hz", "more", "used_hz"),
    [(50, {"sample_rate_hz": 200}, 200.0), (50.01, {}, 50.0), (1000 / 7, {}, 1000 / 7),
     (1000, {}, 200.0)],
)  # fmt: skip
def test_models_work_at_the_rate_of_the_recording(
    recording, stopped, tmp_path, own_hz, more, used_hz
):
    whole = pd.concat(20 * [pd.read_csv(tmp_path / "log.csv")])[: round(60 * own_hz)]
    whole.assign(t=np.arange(len(whole)) / own_hz).to_csv(tmp_path / "log.csv", index=False)
    (tmp_path / "few.yaml").write_text("{}")
    assert run(tmp_path, recording(**more)) == 130
    recordings, models = stopped.call_args.args[:2]
    assert recordings.rate_hz == pytest.approx(used_hz, rel=1e-12)
    # the answer scales settings itself, to the rate that it works at
    assert models["fprc"]["epsilon"] == pytest.approx(0.01)


@pytest.mark.usefixtures("stopped")
def test_files_of_others_are_refused_and_kept(recording, tmp_path):
    map_file, raw = recording(), tmp_path / "out/raw/sweep.h5"
    assert run(tmp_path, map_file) == 130
    write_columns(raw, {"theta_deg": np.zeros(3)}, {})
    assert run(tmp_path, map_file) == 1
    assert read_columns(raw, ()).attributes == {}
    raw.unlink()
    answered = tmp_path / "out/readout/answer.json"
    answered.parent.mkdir()
    answered.write_text('{"mine": 1}')
    assert run(tmp_path, map_file) == 1
    assert answered.read_text() == '{"mine": 1}'


@pytest.mark.usefixtures("stopped")
@pytest.mark.parametrize("wrong", ["copy", "noise", "short", "slow", "jump", "no P_o", "border"])
def test_what_cannot_be_right_stops_before_anything_is_written(recording, tmp_path, wrong):
    table, channels, more = pd.read_csv(tmp_path / "log.csv"), dict(CHANNELS), {}
    if wrong == "copy":
        table["memory"] = 2.0 * table["force"] + 1.0
    elif wrong == "noise":
        table["force"] = np.random.default_rng(0).standard_normal(3000)
    elif wrong == "short":
        table = table[:1000]
    elif wrong == "slow":  # too few samples for the memory
        table["t"] *= 50.0
        table = table[:200]
    elif wrong == "jump":  # a clock that takes too much memory
        table["t"] += 1e7 * (table["t"] > 30.0)
    elif wrong == "border":
        more = {"test_from_s": 61}
    else:
        del channels["p_o_kpa"]
    table.to_csv(tmp_path / "log.csv", index=False)
    assert run(tmp_path, recording(channels, **more)) == 1
    assert not (tmp_path / "out").exists()
