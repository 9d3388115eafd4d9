import io
import logging
from contextlib import redirect_stderr, redirect_stdout
from unittest.mock import Mock

import numpy as np
import pandas as pd
import pytest
import yaml

from fprc.artifacts import read_json, write_json
from fprc.cli import main
from fprc.errors import ConfigError
from fprc.evaluation import cells
from fprc.experiments.data import read_data
from fprc.experiments.settings import Judgement
from fprc.logs import read_columns, write_columns
from fprc.plan.arguments import judgement, paper_models
from fprc.recordings import readout as readout_command
from fprc.recordings.competitors import recording_blocks
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
    "evaluation": {"folds": 3, "purge_s": 0.2},
}


def write_recording(folder):
    """Write 12 s of a force that depends on P_o, and few settings; return what writes a map."""
    time_s = np.arange(2400) / 200.0
    rng = np.random.default_rng(5)
    angle = 20.0 + 10.0 * np.sin(2.0 * time_s) + 8.0 * np.sin(3.3 * time_s)
    past = np.cumsum(rng.standard_normal(len(time_s)))
    columns = {"t": time_s, "angle": angle, "memory": past, "force": 3.0 * angle + 5.0 * past}
    pd.DataFrame(columns).to_csv(folder / "log.csv", index=False)
    (folder / "few.yaml").write_text(yaml.safe_dump(FEW))

    def write(channels=CHANNELS, **more):
        mapping = {"test_from_s": 7, "time": {"column": "t"}, "channels": channels} | more
        (folder / "map.yaml").write_text(yaml.safe_dump(mapping))
        return str(folder / "map.yaml")

    return write


@pytest.fixture
def stopped(monkeypatch, undrawn):
    """Interrupt the command before it judges anything; knows what it was to judge."""
    stop = Mock(side_effect=KeyboardInterrupt)
    monkeypatch.setattr(readout_command, "_compete", stop)
    return stop


@pytest.fixture
def recording(tmp_path):
    return write_recording(tmp_path)


def run(tmp_path, map_file, *more):
    return main([
        "readout", str(tmp_path / "log.csv"), "--map", map_file, "--out", str(tmp_path / "out"),
        "--config", str(tmp_path / "few.yaml"), "--workers", "1", *more,
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
    """Folder of a run that was stopped after five cells and went on; what it printed; its cells."""
    folder, seen, logged = tmp_path_factory.mktemp("finished"), [], cells.log_progress
    map_file = write_recording(folder)()

    def stop(done, total):
        logged(done, total)
        seen.append((done, total))
        if seen[-1] == (5, 10):
            raise KeyboardInterrupt

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(cells, "log_progress", stop)
        assert run(folder, map_file) == 130
        assert not (folder / "out/readout/competitors.json").exists()
        out, err = io.StringIO(), io.StringIO()
        with redirect_stdout(out), redirect_stderr(err):
            assert run(folder, map_file) == 0
    return folder / "out", out.getvalue(), err.getvalue(), seen


def test_stopped_run_goes_on_where_it_was(finished):
    out, _, _, seen = finished
    assert seen == [(done, 10) for done in range(1, 11)]
    assert len(read_json(out / "readout/competitors.json")["cells"]) == 10


def test_one_command_goes_from_a_recording_to_a_report(finished):
    out, printed, messages, _ = finished
    assert not [*(out / "readout").glob("*.partial*"), *out.glob(".*")]
    table = pd.read_csv(out / "readout/competitors.csv").set_index("model")
    assert len(table) == 10
    assert set(table["unit"]) == {"N"}
    # the force depends on P_o, which no other input reveals
    assert table.loc["fprc", "test_rmse"] < 0.7 * table.loc["fprc_shifted", "test_rmse"]
    assert table[["block_rmse", "block_std", "test_rmse"]].gt(0.0).all(axis=None)
    # of 7 s that train; 1.5 s are three time constants of the low-pass
    assert set(table["blocks"]) == {4}
    report = read_json(out / "readout/competitors.json")
    assert report["block_s"] == pytest.approx([1.75] * 4, rel=1e-3)
    # 40 samples are purged on both sides of two blocks, and on one side of two
    assert report["overlap"] == pytest.approx(np.mean([350 / 970, 350 / 1010]))
    page = (out / "readout/competitors.md").read_text(encoding="utf-8")
    assert "4 blocks of 1.75 s of the training data" in page
    assert "cells" not in printed
    assert "] 10 of 10 cells" in messages
    assert all(f" ({claim}): undecided. " in printed for claim in ("B1", "B4", "R1"))
    assert printed.index("Not decided: ") < printed.index("(B1): ")
    # the next run in this process logs to the standard error of its own time
    assert not logging.getLogger("fprc").handlers


@pytest.mark.usefixtures("undrawn")
def test_further_recordings_train_too(recording, tmp_path):
    paths = further(tmp_path, 3, 4)
    assert run(tmp_path, recording(start_s=1), "--train", *paths) == 0
    out = tmp_path / "out"
    train, test = (
        read_columns(out / f"raw/{name}.h5", ("time_s", "theta_deg"))
        for name in ("sweep", "complex")
    )
    # the parts meet and do not overlap
    assert train.attributes["imported_start_s"] == pytest.approx(1.0)
    assert test.attributes["imported_start_s"] == pytest.approx(7.0)
    assert (len(train.channels["time_s"]), len(test.channels["time_s"])) == (1200, 1000)
    data = read_columns(out / "data/sweep.h5", ("time_s",))
    assert data.attributes["recordings"] == {"sweep.h5": 1200, "sweep_2.h5": 600, "sweep_3.h5": 800}
    quality = read_json(out / "quality/sweep.json")["recordings"]
    assert [log["log"] for log in quality] == ["sweep.h5", "sweep_2.h5", "sweep_3.h5"]
    text = (out / "report.md").read_text(encoding="utf-8")
    assert "Trained before 7 s and on 2 training logs, tested after" in text
    pictures = [line.split("(")[1].rstrip(")") for line in text.splitlines() if line[:1] == "!"]
    assert pictures == [
        f"raw/{name}.diagnosis.png" for name in ("sweep", "sweep_2", "sweep_3", "complex")
    ]
    assert all((out / name).exists() for name in pictures)


@pytest.mark.usefixtures("stopped")
def test_whole_recording_tests_if_others_train(recording, tmp_path, capsys):
    map_file = recording(test_from_s=None, experiment="complex")
    assert run(tmp_path, map_file, "--train", *further(tmp_path, 1, 2)) == 130
    test, train = (
        read_columns(tmp_path / f"out/data/{name}.h5", ("time_s",)) for name in ("complex", "sweep")
    )
    assert len(test.channels["time_s"]) == 2400
    assert train.attributes["recordings"] == {"sweep.h5": 200, "sweep_2.h5": 400}
    # the workflow would also find the log that is left
    assert run(tmp_path, map_file, "--train", *further(tmp_path, 1)) == 1
    assert "sweep_2.h5: from an earlier run with other recordings" in capsys.readouterr().err


@pytest.mark.usefixtures("stopped")
@pytest.mark.parametrize(
    ("pause_s", "kept", "trained", "tested"),
    [
        (0, {}, 1600, 800),
        (0, {"start_s": 3, "end_s": 9}, 800, 400),
        (20_000, {"start_s": 20_000}, 1600, 800),
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
    """Of 40 s come ten blocks at every rate, and all settings in samples are for it."""
    time_s = np.arange(round(41 * own_hz)) / own_hz
    columns = {"t": time_s, "angle": 20.0 * np.sin(2.0 * time_s), "memory": np.sin(time_s)}
    pd.DataFrame(columns | {"force": np.cos(time_s)}).to_csv(tmp_path / "log.csv", index=False)
    mapping = {"test_from_s": 40, "time": {"column": "t"}, "channels": CHANNELS}
    mapping |= {"sample_rate_hz": given_hz} if given_hz else {}
    (tmp_path / "map.yaml").write_text(yaml.safe_dump(mapping))
    (tmp_path / "few.yaml").write_text("{}")
    assert run(tmp_path, str(tmp_path / "map.yaml")) == 130
    data, _, settings, _ = stopped.call_args.args
    train = read_data(data["sweep"])
    assert train.attributes["sample_rate_hz"] == pytest.approx(used_hz, rel=1e-12)
    assert train.period_s == pytest.approx(1.0 / used_hz, rel=1e-6)
    how = Judgement(**judgement({**settings, "models": paper_models(settings)}))
    assert len(recording_blocks(train, how)) == 10
    epsilon = settings["models"]["fprc"]["epsilon"]
    assert (1.0 - epsilon) ** (used_hz / 200.0) == pytest.approx(0.99)
    assert ("fprc.epsilon 0.01 to" in capsys.readouterr().err) == (used_hz != 200.0)


@pytest.mark.usefixtures("stopped")
def test_unlikely_rate_needs_the_map_to_give_it(recording, tmp_path, capsys):
    table = pd.read_csv(tmp_path / "log.csv")
    table.assign(t=1e3 * table["t"]).to_csv(tmp_path / "log.csv", index=False)
    assert run(tmp_path, recording(test_from_s=7000)) == 1
    assert "set time.unit: ms" in capsys.readouterr().err
    assert run(tmp_path, recording(test_from_s=7000, sample_rate_hz=1)) == 130


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


def test_answer_is_doubtful_if_a_check_failed_or_theta_is_narrow(tmp_path):
    record = {"log": "sweep.h5", "checks": {"range": {"passed": True}}}
    bad = {"range": {"passed": False, "finding": "channel p_o_kpa: sample 7 is 1e5 kPa"}}
    for part, checks in (("sweep", record["checks"]), ("complex", bad)):
        write_json(tmp_path / f"quality/{part}.json", record | {"checks": checks})
    settings = {"models": {"fprc": {"sigma": 2.0}}}
    for factor, count in ((1.0, 1), (np.pi / 180.0, 2)):
        theta = factor * 30.0 * np.sin(np.arange(100.0))
        channels = {"theta_deg": theta, "p_target_kpa": np.cos(np.arange(100.0))}
        write_columns(tmp_path / "data/sweep.h5", channels, {})
        found = cautions(tmp_path, settings)
        assert len(found) == count
        assert "p_o_kpa" in found[0]
    assert "theta_deg" in found[1]
    # a pressure that follows its command, as the actuator's own, and a chamber of its own
    noise = np.random.default_rng(1).normal(size=100)
    for off, count in ((0.02, 3), (0.3, 2)):
        p_o = {"p_o_kpa": 5.0 - 2.0 * channels["p_target_kpa"] + off * noise}
        write_columns(tmp_path / "data/sweep.h5", channels | p_o, {})
        assert len(cautions(tmp_path, settings)) == count


@pytest.mark.usefixtures("stopped")
def test_slowest_of_several_recordings_sets_the_rate(recording, tmp_path):
    (more,) = further(tmp_path, 3)
    pd.read_csv(more)[::2].to_csv(more, index=False)
    assert run(tmp_path, recording(), "--train", more) == 130
    train = read_data(tmp_path / "out/data/sweep.h5")
    assert train.attributes["recordings"] == {"sweep.h5": 700, "sweep_2.h5": 300}
