"""Samples of a run whose journal is lost; the rig runs on its bench's clock."""

import os
import tempfile
from contextlib import nullcontext
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

from fprc.apparatus import process
from fprc.apparatus.journal import Journal
from fprc.apparatus.record_on_rig import record_on_rig
from fprc.control import RunAbortedError
from fprc.errors import LogError, OutputError
from fprc.logs import read_raw

TICKS = 40
#: Tick before which the journal is lost.
LOST = 10


@pytest.fixture
def places(tmp_path, monkeypatch):
    """Folders of the log, of the user and of temporary files."""
    found = {name: tmp_path / name for name in ("raw", "home", "temporary")}
    for folder in found.values():
        folder.mkdir()
    monkeypatch.chdir(found["home"])
    monkeypatch.setattr(tempfile, "tempdir", str(found["temporary"]))
    return found


@pytest.fixture
def record(bench, settings, live_by, asking, places, monkeypatch):
    """Record some ticks of the sweep; lose the journal before one; return error and last tick.

    That tick waits until the journal's thread has noticed it; at the last tick, ``close`` has to.
    """
    settings["experiments"]["sweep"]["duration_s"] = 2.0
    plan = process.plan

    def cut_short(*arguments):
        return plan(*arguments)._replace(samples=TICKS)

    def record(lose, at=LOST, fails=True):
        journals, last = [], at == TICKS - 1 or lose in (add_bytes, zero_bytes)

        def at_tick(tick):
            if tick == at:
                lose(journals[0].path)
                if not last:
                    journals[0]._syncing.join(10.0)

        def open_journal(*arguments):
            journals.append(Journal(*arguments, sync_s=1e6 if last else 1e-3))
            return journals[0]

        monkeypatch.setattr(process, "plan", cut_short)
        monkeypatch.setattr(process, "Journal", open_journal)
        sessions, _ = live_by(bench, at_tick)
        raw = str(places["raw"] / "sweep.h5")
        expected = pytest.raises((RunAbortedError, LogError)) if fails else nullcontext()
        with expected as caught:
            process.record("sweep", raw, settings=settings, stop=asking())
        assert list(bench.shared.outputs[:2]) == [0.0, 0.0]
        return fails and str(caught.value), sessions[-1].tick

    return record


def cut(path):
    os.truncate(path, 1000)


def replace(path):
    path.unlink()
    path.write_bytes(bytes(10_000))


def copy_and_replace(path):
    content = path.read_bytes()
    path.unlink()
    path.write_bytes(content + bytes(10**6))


def delete_folder(path):
    path.unlink()
    path.parent.rmdir()


def move_folder(path):
    path.parent.rename(path.parent.with_name("moved"))


def delete_both(path):
    delete_folder(path)
    Path.cwd().rmdir()


def rescued(places):
    """Return the name of the place of the log that was rescued, and the log."""
    ((place, path),) = [
        (name, path)
        for name, folder in places.items()
        if folder.is_dir()
        for path in folder.rglob("*.rescued.h5")
    ]
    log = read_raw(path, experiment="sweep", sample_rate_hz=200.0, rate_tolerance=1e-6)
    return place, path, log


LOSSES = [
    (Path.unlink, "raw"), (cut, "raw"), (delete_folder, "home"), (move_folder, "home"),
    (delete_both, "temporary"), (replace, "raw"), (copy_and_replace, "raw"),
]  # fmt: skip


@pytest.mark.parametrize(("lose", "place"), LOSSES)
def test_run_whose_journal_is_lost_stops_and_saves_every_sample(record, places, lose, place):
    error, last = record(lose)
    assert last == LOST
    found, path, log = rescued(places)
    assert (found, f"{path} has all of them" in error) == (place, True)
    reason = log.attributes["incomplete_reason"]
    assert error.count(reason) == 1
    assert f"{places['raw']}/sweep." in reason
    assert log.channels["time_s"] == pytest.approx(np.arange(LOST + 1) / 200.0)
    assert np.ptp(log.channels["p_exp_kpa"]) > 0.0
    assert (log.attributes["complete"], log.attributes["source"]) == (False, "rig")
    assert "started" in log.attributes
    assert log.attributes["statistics"]["overruns"] == 0


@pytest.mark.parametrize(("lose", "place"), LOSSES[1:4:2])
def test_journal_that_is_lost_at_the_last_sample_costs_none(record, places, lose, place):
    error, last = record(lose, TICKS - 1)
    assert last == TICKS - 1
    found, path, log = rescued(places)
    assert (found, f"{path} has all of them" in error) == (place, True)
    assert f"{places['raw']}/sweep." in error
    assert len(log.channels["time_s"]) == TICKS
    assert log.attributes["complete"]
    assert not (places["raw"] / "sweep.h5").exists()


def add_bytes(path):
    with path.open("ab") as file:
        file.write(b"other")


def zero_bytes(path):
    with path.open("r+b") as file:
        file.seek(-300, os.SEEK_END)
        file.write(bytes(200))


@pytest.mark.parametrize("at", [LOST, TICKS - 1])
def test_samples_that_the_journal_does_not_give_back_are_saved(record, places, at):
    error, last = record(zero_bytes, at)
    assert last == TICKS - 1
    _, path, log = rescued(places)
    assert f"{path} has all of them" in error
    assert (len(log.channels["time_s"]), log.attributes["complete"]) == (TICKS, True)
    assert not (places["raw"] / "sweep.h5").exists()


def test_foreign_bytes_between_samples_cost_nothing(record, places):
    record(add_bytes, fails=False)
    log = read_raw(
        places["raw"] / "sweep.h5", experiment="sweep", sample_rate_hz=200.0, rate_tolerance=1e-6
    )
    assert (len(log.channels["time_s"]), log.attributes["complete"]) == (TICKS, True)


def test_samples_that_can_be_saved_nowhere_are_said_to_be_lost(record, monkeypatch):
    def refuse(*arguments, **attributes):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr("fprc.apparatus.recovery.write_raw", refuse)
    error, _ = record(cut)
    assert f"of {LOST + 1} samples" in error
    assert error.count("No space left on device") == 3


def test_run_that_the_disk_cannot_hold_does_not_begin(settings, places, monkeypatch):
    """Its 36,000 samples of 11 numbers take 3.2 MB in the journal, and as much in the log."""
    stage = "fprc.apparatus.record_on_rig"
    monkeypatch.setattr(f"{stage}.disk_usage", lambda folder: SimpleNamespace(free=10**7))
    monkeypatch.setattr(f"{stage}.guard", None)
    settings["experiments"]["sweep"]["duration_s"] = 180.0
    raw = str(places["raw"] / "new/a.h5")
    with pytest.raises(OutputError, match="10,000,000 left"):
        record_on_rig(raw, name="sweep", settings=settings, armed=True)
    assert [*places["raw"].rglob("a.*")] == []
