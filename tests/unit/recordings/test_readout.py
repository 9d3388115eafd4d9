import io
from contextlib import redirect_stderr, redirect_stdout
from unittest.mock import Mock

import numpy as np
import pandas as pd
import pytest
import yaml

from fprc.artifacts import read_json, write_json
from fprc.cli import main
from fprc.errors import ConfigError
from fprc.experiments.data import read_data
from fprc.logs import read_columns, write_columns
from fprc.recordings import readout as readout_command
from fprc.recordings.readout import report_readout
from fprc.recordings.readout_page import cautions

pytestmark = pytest.mark.slow

CHANNELS = {
    "theta_deg": {"column": "angle", "unit": "deg"},
    "p_exp_kpa": {"column": "force", "unit": 1, "note": "motor force F [N]"},
    "p_o_kpa": {"column": "memory", "unit": "kPa"},
}
FEW = {
    "models": {"fprc": {"n_c": 2}, "esn": {"r": 20}, "n_y": 2},
}


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
        mapping = {"test_from_s": 35, "time": {"column": "t"}, "channels": channels} | more
        (folder / "map.yaml").write_text(yaml.safe_dump(mapping))
        return str(folder / "map.yaml")

    return write


@pytest.fixture
def stopped(monkeypatch, undrawn):
    """Interrupt the command before it judges anything; knows what it was to judge."""
    stop = Mock(side_effect=KeyboardInterrupt)
    monkeypatch.setattr(readout_command, "answer_recordings", stop)
    return stop


@pytest.fixture
def recording(tmp_path):
    return write_recording(tmp_path)


def run(tmp_path, map_file, *more):
    return main([
        "readout", str(tmp_path / "log.csv"), "--map", map_file, "--out", str(tmp_path / "out"),
        "--config", str(tmp_path / "few.yaml"), *more,
    ])  # fmt: skip


def further(tmp_path, *lengths_s):
    """Write beginnings of the recording as recordings of their own."""
    table = pd.read_csv(tmp_path / "log.csv")
    paths = [tmp_path / f"more_{length_s}.csv" for length_s in lengths_s]
    for path, length_s in zip(paths, lengths_s, strict=True):
        table[table["t"] < length_s].to_csv(path, index=False)
    return list(map(str, paths))


@pytest.fixture(scope="module")
def finished(tmp_path_factory):
    """Folder of a run, what it printed, and its messages."""
    folder = tmp_path_factory.mktemp("finished")
    map_file = write_recording(folder)()
    out, err = io.StringIO(), io.StringIO()
    with redirect_stdout(out), redirect_stderr(err):
        assert run(folder, map_file) == 0
    return folder / "out", out.getvalue(), err.getvalue()


def test_one_command_goes_from_a_recording_to_an_answer(finished):
    out, printed, messages = finished
    report = read_json(out / "readout/answer.json")
    # the force depends on P_o, which no other input reveals
    assert report["answer"]["verdict"] == "Yes"
    assert printed.startswith(report["answer"]["words"])
    assert report["answer"]["words"].startswith("Yes: with P_o ")
    assert report["answer"]["with"]["error"] < 0.5 * min(report["answer"]["shifts"])
    # 60 s but the first 5, in blocks of 6 s at least, of both parts
    assert report["answer"]["block_s"] == pytest.approx([55.0 / 9] * 9, rel=1e-2)
    assert [claim["id"] for claim in report["claims"]] == ["B1", "B4", "R1"]
    assert all(printed.index("Yes: ") < printed.index(f"({claim}): ") for claim in ("B1", "R1"))
    assert messages.count("\r[") == 2 * 6 + 19 + 5 + 1
    assert f"[{'#' * 30}] 37 of 37" in messages
    assert [*out.glob(".*")] == []


def test_report_has_both_sides_and_the_papers_models(finished):
    out, _, _ = finished
    sides = pd.read_csv(out / "readout/sides.csv").set_index("family")
    assert (sides["with"] < sides["without"]).all()
    assert sides[["chosen_with", "chosen_without"]].sum().tolist() == [9, 9]
    paper = pd.read_csv(out / "readout/paper.csv").set_index("model")
    assert paper["rmse"].gt(0.0).all()
    assert set(paper["unit"]) == set(sides["unit"]) == {"N"}
    page = (out / "report.md").read_text(encoding="utf-8")
    assert "Table" not in page
    pictures = [line.split("(")[1].rstrip(")") for line in page.splitlines() if line[:1] == "!"]
    assert pictures == [
        "readout/memory.png",
        "raw/sweep.diagnosis.png",
        "raw/complex.diagnosis.png",
    ]
    assert all((out / name).exists() for name in pictures)


@pytest.mark.usefixtures("undrawn")
def test_further_recordings_train_too(recording, tmp_path):
    paths = further(tmp_path, 13, 14)
    assert run(tmp_path, recording(start_s=1), "--train", *paths) == 0
    out = tmp_path / "out"
    train, test = (
        read_columns(out / f"raw/{name}.h5", ("time_s", "theta_deg"))
        for name in ("sweep", "complex")
    )
    # the parts meet and do not overlap
    assert train.attributes["imported_start_s"] == pytest.approx(1.0)
    assert test.attributes["imported_start_s"] == pytest.approx(35.0)
    assert (len(train.channels["time_s"]), len(test.channels["time_s"])) == (1700, 1250)
    data = read_columns(out / "data/sweep.h5", ("time_s",))
    assert data.attributes["recordings"] == {"sweep.h5": 1700, "sweep_2.h5": 650, "sweep_3.h5": 700}
    quality = read_json(out / "quality/sweep.json")["recordings"]
    assert [log["log"] for log in quality] == ["sweep.h5", "sweep_2.h5", "sweep_3.h5"]
    # one block each of the further ones; the first recording is judged as one
    assert read_json(out / "readout/answer.json")["answer"]["duration_s"] == pytest.approx(86.0)


def test_whole_recording_is_the_workflows_test_if_others_train(
    stopped, recording, tmp_path, capsys
):
    map_file = recording(test_from_s=None, experiment="complex")
    assert run(tmp_path, map_file, "--train", *further(tmp_path, 11, 12)) == 130
    test, train = (
        read_columns(tmp_path / f"out/data/{name}.h5", ("time_s",)) for name in ("complex", "sweep")
    )
    assert len(test.channels["time_s"]) == 3000
    assert train.attributes["recordings"] == {"sweep.h5": 550, "sweep_2.h5": 600}
    recordings = stopped.call_args.args[0]
    assert recordings.lengths == [550, 3000, 600]
    # the workflow would also find the log that is left
    assert run(tmp_path, map_file, "--train", *further(tmp_path, 11)) == 1
    assert "sweep_2.h5: from an earlier run with other recordings" in capsys.readouterr().err


@pytest.mark.usefixtures("stopped")
@pytest.mark.parametrize(
    ("pause_s", "kept", "trained", "tested"),
    [
        (0, {}, 2000, 1000),
        (0, {"start_s": 3, "end_s": 33}, 1000, 500),
        (20_000, {"start_s": 20_000}, 2000, 1000),
    ],
)
def test_last_third_is_the_test_unless_the_map_says_where_it_begins(
    recording, tmp_path, pause_s, kept, trained, tested
):
    table = pd.read_csv(tmp_path / "log.csv")
    table.loc[1:, "t"] += pause_s
    table.to_csv(tmp_path / "log.csv", index=False)
    assert run(tmp_path, recording(test_from_s=None, experiment="sweep", **kept)) == 130
    lengths = [
        len(read_columns(tmp_path / f"out/data/{name}.h5", ("time_s",)).channels["time_s"])
        for name in ("sweep", "complex")
    ]
    assert lengths == pytest.approx([trained, tested], abs=2)


def test_map_of_a_whole_test_log_needs_training_logs(recording, tmp_path):
    map_file = recording(test_from_s=None, experiment="complex")
    with pytest.raises(ConfigError, match="test_from_s"):
        report_readout(str(tmp_path / "log.csv"), map_=map_file, out=str(tmp_path / "out"))


def test_map_without_the_readout_is_refused_with_every_other_problem(recording, tmp_path, capsys):
    channels = {name: CHANNELS[name] for name in ("theta_deg", "p_exp_kpa")}
    assert run(tmp_path, recording(channels, test_from_s=None, experiment="complex")) == 1
    message = capsys.readouterr().err
    assert "channels.p_o_kpa is missing: it is the readout to evaluate" in message
    assert "nothing is left to train on" in message
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize(
    ("own_hz", "given_hz", "used_hz"),
    [
        (100, None, 100.0),
        (100, 200, 200.0),
        (50, 200, 200.0),
        (50.01, None, 50.0),  # a quartz is that good
        (1000 / 7, None, 1000 / 7),
        (1000, None, 200.0),
    ],
)
def test_models_work_at_the_rate_of_the_recording(
    tmp_path, stopped, capsys, own_hz, given_hz, used_hz
):
    time_s = np.arange(round(41 * own_hz)) / own_hz
    noise = np.random.default_rng(0).standard_normal(len(time_s))
    columns = {"t": time_s, "angle": 20.0 * np.sin(2.0 * time_s), "memory": np.sin(time_s)}
    columns["force"] = columns["angle"] + 20.0 * columns["memory"] + noise
    pd.DataFrame(columns).to_csv(tmp_path / "log.csv", index=False)
    mapping = {"test_from_s": 30, "time": {"column": "t"}, "channels": CHANNELS}
    mapping |= {"sample_rate_hz": given_hz} if given_hz else {}
    (tmp_path / "map.yaml").write_text(yaml.safe_dump(mapping))
    (tmp_path / "few.yaml").write_text("{}")
    assert run(tmp_path, str(tmp_path / "map.yaml")) == 130
    recordings, models = stopped.call_args.args[:2]
    train = read_data(tmp_path / "out/data/sweep.h5")
    assert train.attributes["sample_rate_hz"] == pytest.approx(used_hz, rel=1e-12)
    assert recordings.rate_hz == pytest.approx(used_hz, rel=1e-12)
    assert recordings.lengths == [pytest.approx(41 * used_hz, abs=9)]
    # the answer scales settings itself, to the rate that it works at
    assert models["fprc"]["epsilon"] == pytest.approx(0.01)
    assert ("fprc.epsilon 0.01 to" in capsys.readouterr().err) == (used_hz != 200.0)


@pytest.mark.usefixtures("stopped")
def test_unlikely_rate_needs_the_map_to_give_it(recording, tmp_path, capsys):
    table = pd.read_csv(tmp_path / "log.csv")
    table.assign(t=1e3 * table["t"]).to_csv(tmp_path / "log.csv", index=False)
    assert run(tmp_path, recording(test_from_s=35000)) == 1
    assert "time.unit = s" in capsys.readouterr().err
    assert run(tmp_path, recording(test_from_s=35000, sample_rate_hz=1)) == 130


def test_test_that_begins_after_the_end_is_refused_before_anything_is_written(
    recording, tmp_path, capsys
):
    assert run(tmp_path, recording(test_from_s=100)) == 1
    assert "test_from_s = 100 lies beyond the end" in capsys.readouterr().err
    assert not (tmp_path / "out").exists()


@pytest.mark.usefixtures("stopped")
def test_folder_with_another_recording_is_refused_and_kept(recording, tmp_path, capsys):
    assert run(tmp_path, recording()) == 130
    kept = (tmp_path / "out/raw/sweep.h5").read_bytes()
    assert run(tmp_path, recording(start_s=1)) == 130  # another part of the same recording
    assert (tmp_path / "out/raw/sweep.h5").read_bytes() != kept
    kept = (tmp_path / "out/raw/sweep.h5").read_bytes()
    table = pd.read_csv(tmp_path / "log.csv")
    table[:-1].to_csv(tmp_path / "log.csv", index=False)
    assert run(tmp_path, recording()) == 1
    assert "sweep.h5: from an earlier run with other recordings" in capsys.readouterr().err
    assert (tmp_path / "out/raw/sweep.h5").read_bytes() == kept


@pytest.mark.usefixtures("stopped")
@pytest.mark.parametrize(
    ("name", "status"),
    [("sweep", 1), ("sweep_2", 1), ("complex", 1), ("track_sine_fprc", 130)],  # 130: it began
)
def test_logs_that_no_import_wrote_are_refused_if_they_train_or_test(
    recording, tmp_path, name, status
):
    write_columns(tmp_path / f"out/raw/{name}.h5", {"theta_deg": np.zeros(3)}, {})
    assert run(tmp_path, recording()) == status


@pytest.mark.usefixtures("stopped")
@pytest.mark.parametrize("wrong", ["unit", "copy", "stuck", "short"])
def test_what_cannot_be_right_stops_with_one_line(recording, tmp_path, capsys, wrong):
    table, channels, more = pd.read_csv(tmp_path / "log.csv"), dict(CHANNELS), {}
    if wrong == "unit":
        table = table.rename(columns={"angle": "angle [rad]"})
        channels["theta_deg"] = {"column": "angle [rad]", "unit": "deg"}
    elif wrong == "copy":
        table["memory"] = 2.0 * table["force"] + 1.0
    elif wrong == "stuck":
        table["memory"] = 3.0
    else:
        table, more = table[:1000], {"test_from_s": 10}
    table.to_csv(tmp_path / "log.csv", index=False)
    assert run(tmp_path, recording(channels, **more)) == 1
    assert capsys.readouterr().out == ""
    assert not (tmp_path / "out/report.md").exists()


def test_answer_is_doubtful_if_a_check_failed(tmp_path):
    good = {"log": "sweep.h5", "checks": {"range": {"passed": True}}}
    bad = {"range": {"passed": False, "finding": "channel p_o_kpa: sample 7 is 1e5 kPa"}}
    for part, checks in (("sweep", good["checks"]), ("complex", bad)):
        write_json(tmp_path / f"quality/{part}.json", good | {"checks": checks})
    (found,) = cautions(tmp_path)
    assert "p_o_kpa" in found


@pytest.mark.usefixtures("stopped")
def test_slowest_of_several_recordings_sets_the_rate(recording, tmp_path):
    (more,) = further(tmp_path, 13)
    pd.read_csv(more)[::2].to_csv(more, index=False)
    assert run(tmp_path, recording(), "--train", more) == 130
    train = read_data(tmp_path / "out/data/sweep.h5")
    assert train.attributes["recordings"] == {"sweep.h5": 875, "sweep_2.h5": 325}
