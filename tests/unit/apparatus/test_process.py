"""Samples of a run whose journal or folder is lost; the rig runs on its bench's clock."""

import os
import tempfile
from contextlib import nullcontext
from pathlib import Path

import numpy as np
import pytest

from fprc.apparatus import journal, process
from fprc.apparatus.journal import Journal
from fprc.errors import ControlError
from fprc.logs import read_raw

TICKS = 40
#: Tick before which the journal is lost.
LOST = 10


@pytest.fixture
def places(tmp_path, monkeypatch):
    """Folders of the log and of temporary files."""
    found = {name: tmp_path / name for name in ("raw", "temporary")}
    for folder in found.values():
        folder.mkdir()
    monkeypatch.setattr(tempfile, "tempdir", str(found["temporary"]))
    return found


@pytest.fixture
def record(bench, settings, live_by, places, monkeypatch):
    """Record some ticks of the sweep; lose the journal before one; return error and last tick.

    That tick waits until the journal's thread has noticed it, if it does before the end.
    """
    settings["experiments"]["sweep"]["duration_s"] = 2.0
    plan = process.plan

    def record(lose, at=LOST, notices=True, fails=True):
        journals = []

        def at_tick(tick):
            if tick == at:
                lose(journals[0].path)
                if notices:
                    journals[0]._syncing.join(10.0)

        def open_journal(*arguments):
            journals.append(Journal(*arguments))
            return journals[0]

        monkeypatch.setattr(process, "plan", lambda *given: plan(*given)._replace(samples=TICKS))
        monkeypatch.setattr(process, "Journal", open_journal)
        monkeypatch.setattr(journal, "_SYNC_S", 1e-3 if notices else 1e6)
        sessions, guardian = live_by(bench, at_tick)
        with pytest.raises(ControlError) if fails else nullcontext() as caught:
            raw = str(places["raw"] / "sweep.h5")
            process.record("sweep", raw, settings=settings, guardian=guardian)
        assert list(bench.shared.outputs[:2]) == [0.0, 0.0]
        return str(caught.value) if fails else "", sessions[-1].tick

    return record


def log_of(places):
    """Return the name of the place of the only log, its path, and the log."""
    ((place, path),) = [
        (name, path) for name, folder in places.items() for path in folder.rglob("*.h5")
    ]
    log = read_raw(path, experiment="sweep", sample_rate_hz=200.0, rate_tolerance=1e-6)
    return place, path, log


def cut(path):
    os.truncate(path, 1000)


def replace(path):
    content = path.read_bytes()
    path.unlink()
    path.write_bytes(content + bytes(10**6))


def delete_folder(path):
    path.unlink()
    path.parent.rmdir()


def move_folder(path):
    path.parent.rename(path.parent.with_name("moved"))


def zero(path):
    with path.open("r+b") as file:
        file.seek(-300, os.SEEK_END)
        file.write(bytes(200))


def append(path):
    with path.open("ab") as file:
        file.write(b"other")


#: What happens to the journal, and the place of the log that is then saved.
LOSSES = [
    (Path.unlink, "raw"), (cut, "raw"), (replace, "raw"), (delete_folder, "temporary"),
    (move_folder, "temporary"),
]  # fmt: skip


@pytest.mark.parametrize(("lose", "place"), LOSSES)
def test_run_whose_journal_is_lost_stops_and_saves_every_sample(record, places, lose, place):
    error, last = record(lose)
    assert last == LOST
    found, path, log = log_of(places)
    assert (found, path.name.endswith(".rescued.h5")) == (place, True)
    assert str(path) in error
    assert error.count(log.attributes["incomplete_reason"]) == 1
    assert log.channels["time_s"] == pytest.approx(np.arange(LOST + 1) / 200.0)
    assert np.ptp(log.channels["p_exp_kpa"]) > 0.0
    assert (log.attributes["complete"], log.attributes["source"]) == (False, "rig")
    assert {"started", "statistics"} <= log.attributes.keys()


@pytest.mark.parametrize(
    ("lose", "at", "place"),
    [(cut, TICKS - 1, "raw"), (move_folder, TICKS - 1, "temporary"),
     *[(change, at, "raw") for change in (zero, append) for at in (LOST, TICKS - 1)]],
)  # fmt: skip
def test_journal_whose_loss_is_noticed_at_the_end_costs_no_sample(record, places, lose, at, place):
    error, _ = record(lose, at, notices=False, fails=place == "temporary")
    found, path, log = log_of(places)
    assert (found, path.name == "sweep.h5") == (place, place == "raw")
    assert (str(path) in error) is (place == "temporary")
    assert (len(log.channels["time_s"]), log.attributes["complete"]) == (TICKS, True)


def test_log_that_appears_meanwhile_is_not_overwritten(record, places):
    mine = places["raw"] / "sweep.h5"
    error, _ = record(lambda path: mine.write_bytes(b"mine"), notices=False)
    assert mine.read_bytes() == b"mine"
    (rescued,) = places["raw"].glob("*.rescued.h5")
    assert str(rescued) in error


def test_samples_that_can_be_saved_nowhere_are_not_said_to_be_saved(record, monkeypatch):
    def refuse(*arguments, **attributes):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(process, "write_raw", refuse)
    error, _ = record(lambda path: None, notices=False)
    assert error.count("No space left on device") == 3
    assert f"what it can of the {TICKS} samples" in error
