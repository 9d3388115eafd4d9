import errno
import os
import struct
import threading
import time
import zlib

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from fprc.apparatus import journal as module
from fprc.apparatus.journal import END, MAGIC, Journal
from fprc.apparatus.recovery import read_journal, recover
from fprc.channels import needed_by
from fprc.cli import main
from fprc.config import Settings
from fprc.config.settings import Quality
from fprc.errors import LogError
from fprc.logs import assess, read_columns, read_raw

NAMES = (*needed_by("sim"), "theta_d_deg")
ATTRIBUTES = {
    "experiment": "sweep", "source": "rig", "sample_rate_hz": 200.0, "seed": 0,
    "software": "fprc test", "rig": {"boards": {"library": "θ"}}, "reference": "sine",
}  # fmt: skip
SIZE = 8 + 8 * len(NAMES) + 4


def row(k):
    return (k / 200.0, *(k + j / 16.0 for j in range(1, len(NAMES))))


def write(path, ticks=range(20), **closing):
    journal = Journal(path, NAMES, ATTRIBUTES)
    for k in ticks:
        journal.append(k, row(k))
    journal.close(**closing)


@pytest.fixture
def path(tmp_path):
    return tmp_path / "run.journal"


@pytest.fixture(scope="module")
def closed(tmp_path_factory):
    """Bytes of a closed journal of 20 samples, and where its samples begin."""
    path = tmp_path_factory.mktemp("closed") / "run.journal"
    write(path, overruns=3)
    data = path.read_bytes()
    return data, data.index(struct.pack("<Qd", 1, 1 / 200.0)) - SIZE


def read_ticks(path):
    """Return the ticks of the samples read; each sample must be as written."""
    channels, attributes, findings = read_journal(path)
    ticks = np.rint(channels["time_s"] * 200.0).astype(int).tolist()
    rows = np.column_stack([channels[name] for name in NAMES])
    assert rows.tolist() == [list(row(k)) for k in ticks]
    assert ticks == sorted(set(ticks))
    assert findings.samples == len(ticks)
    assert {name: attributes[name] for name in ATTRIBUTES} == ATTRIBUTES
    return ticks, findings


def test_closed_journal_comes_back_whole(path):
    write(path, overruns=np.int64(3), jitter_s=1e-4)
    ticks, findings = read_ticks(path)
    assert ticks == list(range(20))
    assert (findings.complete, findings.closed, findings.lost) == (True, True, 0)
    assert (findings.reason, findings.missed_ticks) == ("", 0)
    assert findings.statistics == {"overruns": 3, "jitter_s": 1e-4}
    assert read_journal(path)[1]["started"].endswith("+00:00")


@given(st.lists(st.floats(width=64), min_size=len(NAMES), max_size=len(NAMES)))
def test_any_numbers_come_back_bit_for_bit(tmp_path_factory, values):
    path = tmp_path_factory.mktemp("any") / "run.journal"
    with Journal(path, NAMES, ATTRIBUTES) as journal:
        journal.append(0, values)
    channels, _, _ = read_journal(path)
    back = np.array([channels[name][0] for name in NAMES])
    assert back.tobytes() == np.array(values, dtype=np.float64).tobytes()


def test_missed_ticks_are_distinguished_from_lost_samples(path):
    write(path, ticks=[0, 1, 2, 6, 7, 9])
    ticks, findings = read_ticks(path)
    assert ticks == [0, 1, 2, 6, 7, 9]
    assert (findings.missed_ticks, findings.lost, findings.complete) == (4, 0, True)


def test_exception_leaves_a_closed_journal_that_names_it(path):
    def run():
        with Journal(path, NAMES, ATTRIBUTES) as journal:
            journal.append(0, row(0))
            raise ZeroDivisionError("by zero")

    with pytest.raises(ZeroDivisionError):
        run()
    ticks, findings = read_ticks(path)
    assert (ticks, findings.closed, findings.complete) == ([0], True, False)
    assert findings.reason == "ZeroDivisionError: by zero"


def test_interrupt_between_write_and_count_costs_no_sample(path, monkeypatch):
    journal = Journal(path, NAMES, ATTRIBUTES)
    journal.append(0, row(0))
    write_all = module._write

    def interrupted(file, data):
        write_all(file, data)
        raise KeyboardInterrupt

    with monkeypatch.context() as patch:
        patch.setattr(module, "_write", interrupted)
        with pytest.raises(KeyboardInterrupt):
            journal.append(1, row(1))
    journal.close(reason="interrupted")
    ticks, findings = read_ticks(path)
    assert (ticks, findings.lost) == ([0, 1], 0)


def test_existing_file_is_not_overwritten(path):
    write(path)
    before = path.read_bytes()
    with pytest.raises(LogError, match=str(path)):
        Journal(path, NAMES, ATTRIBUTES)
    assert path.read_bytes() == before


def test_closed_journal_takes_no_sample_and_no_second_end(path):
    write(path)
    journal = Journal(path.with_name("other.journal"), NAMES, ATTRIBUTES)
    journal.close()
    size = journal.path.stat().st_size
    journal.close(reason="twice")
    with pytest.raises(LogError):
        journal.append(0, row(0))
    assert journal.path.stat().st_size == size


def test_file_is_not_closed_under_a_thread_that_writes_it_to_the_disk(path, monkeypatch):
    syncing = threading.Event()
    fsync = os.fsync

    def slow(file):
        if threading.current_thread() is not threading.main_thread():
            syncing.set()
            time.sleep(0.2)
        fsync(file)

    monkeypatch.setattr(os, "fsync", slow)
    journal = Journal(path, NAMES, ATTRIBUTES, sync_s=0.01)
    journal.append(0, row(0))
    assert syncing.wait(10.0)
    journal.close()
    assert not journal._syncing.is_alive()  # nor in any other test
    assert read_ticks(path)[1].complete


def test_samples_are_brought_to_the_disk_while_the_run_goes_on(path, monkeypatch):
    synced = threading.Event()
    sizes = []
    fsync = os.fsync

    def noted(file):
        fsync(file)
        sizes.append(os.fstat(file).st_size)
        if len(sizes) > 2:  # the first two: header and folder
            synced.set()

    monkeypatch.setattr(os, "fsync", noted)
    with Journal(path, NAMES, ATTRIBUTES, sync_s=0.01) as journal:
        assert len(sizes) == 2
        journal.append(0, row(0))
        assert synced.wait(10.0)
        assert sizes[2] == sizes[0] + SIZE


def disk_full(file, data):
    raise OSError(errno.ENOSPC, "No space left on device")


def broken(file):
    raise OSError(errno.EIO, "Input/output error")


@pytest.mark.parametrize("one_more", [True, False])
def test_disk_that_fails_ends_the_run_and_keeps_the_samples_written(path, monkeypatch, one_more):
    journal = Journal(path, NAMES, ATTRIBUTES, sync_s=0.001)
    with monkeypatch.context() as patch:
        patch.setattr(os, "fsync", broken)
        journal.append(0, row(0))
        journal._syncing.join(10.0)
        if one_more:
            with pytest.raises(LogError, match="Input/output error"):
                journal.append(1, row(1))
    with pytest.raises(LogError, match="Input/output error"):
        journal.close()
    ticks, findings = read_ticks(path)
    assert (ticks, findings.closed, findings.complete) == ([0], True, False)
    assert "Input/output error" in findings.reason


@pytest.mark.parametrize("part", [0, 1, 50])
def test_full_disk_is_reported_and_leaves_whole_samples(path, monkeypatch, part):
    os_write = os.write
    journal = Journal(path, NAMES, ATTRIBUTES)
    for k in range(3):
        journal.append(k, row(k))
    before, left = path.stat().st_size, [part]

    def full(file, data):
        if not left[0]:
            disk_full(file, data)
        taken, left[0] = left[0], 0
        return os_write(file, bytes(data)[:taken])

    with monkeypatch.context() as patch:
        patch.setattr(os, "write", full)
        with pytest.raises(LogError, match="No space left"):
            journal.append(3, row(3))
    assert path.stat().st_size == before + part
    for more in (lambda: journal.append(3, row(3)), journal.close):
        with pytest.raises(LogError, match="No space left"):
            more()
    ticks, findings = read_ticks(path)
    assert (ticks, findings.closed, findings.complete, findings.lost) == ([0, 1, 2], True, False, 0)
    assert "No space left" in findings.reason


def test_end_mark_that_cannot_be_written_is_reported_and_loses_no_sample(path, monkeypatch):
    journal = Journal(path, NAMES, ATTRIBUTES)
    journal.append(0, row(0))
    with monkeypatch.context() as patch:
        patch.setattr(os, "write", disk_full)
        with pytest.raises(LogError, match="No space left"):
            journal.close()
    ticks, findings = read_ticks(path)
    assert (ticks, findings.closed) == ([0], False)


def test_journal_whose_header_does_not_fit_is_not_left_behind(path, monkeypatch):
    monkeypatch.setattr(os, "write", disk_full)
    with pytest.raises(LogError, match="No space left"):
        Journal(path, NAMES, ATTRIBUTES)
    assert not path.exists()


@given(
    cut=st.integers(0, 10_000),
    flips=st.lists(st.tuples(st.integers(0, 10_000), st.integers(1, 255)), max_size=8),
)
def test_any_damage_leaves_the_other_samples(closed, tmp_path_factory, cut, flips):
    data, start = closed
    damaged = bytearray(data[: cut % (len(data) + 1)])
    for at, mask in flips:
        if at % len(data) < len(damaged):
            damaged[at % len(data)] ^= mask
    touched = {at for at in range(len(damaged)) if damaged[at] != data[at]}
    path = tmp_path_factory.getbasetemp() / "run.journal"
    path.write_bytes(damaged)
    if len(damaged) < start or touched & set(range(start)):
        with pytest.raises(LogError, match="run.journal"):
            read_journal(path)
        return
    ticks, findings = read_ticks(path)
    begins = [start + k * SIZE for k in range(20)]
    assert ticks == [
        k
        for k, at in enumerate(begins)
        if at + SIZE <= len(damaged) and not touched & set(range(at, at + SIZE))
    ]
    if findings.closed:
        assert findings.lost == 20 - len(ticks)
        assert findings.complete is (ticks == list(range(20)))
    if not touched:  # of the end mark the line end is not needed
        assert findings.closed is (len(damaged) >= len(data) - 1)


def in_order(*order):
    return lambda samples, other: [samples[k] for k in order]


#: What a disk makes of the samples, given those of another journal too, and which are lost.
DAMAGES = {
    "5 and 9 exchanged": (in_order(*range(5), 9, *range(6, 9), 5, *range(10, 20)), []),
    "three twice": (in_order(*range(8), 5, 6, 7, *range(8, 20)), []),
    "of another": (lambda samples, other: samples[:4] + other[4:8] + samples[8:], [4, 5, 6, 7]),
}


@pytest.mark.parametrize("damage", DAMAGES)
@pytest.mark.parametrize("is_closed", [True, False])
def test_samples_that_a_disk_lost_are_counted_and_the_others_sorted(
    closed, path, damage, is_closed
):
    data, start = closed
    write(path, overruns=3)
    another = path.read_bytes()
    make, lost = DAMAGES[damage]
    ends = [start + k * SIZE for k in range(21)]
    pairs = list(zip(ends, ends[1:], strict=False))
    samples = make(*([file[at:to] for at, to in pairs] for file in (data, another)))
    path.write_bytes(data[:start] + b"".join(samples) + (data[ends[-1] :] if is_closed else b""))
    ticks, findings = read_ticks(path)
    assert ticks == [k for k in range(20) if k not in lost]
    assert findings.missed_ticks == 0
    assert (findings.closed, findings.complete) == (is_closed, is_closed and not lost)
    assert findings.lost == len(lost)


#: What another program does to the bytes of the samples, and which it costs.
FOREIGN = {
    "5 bytes between": (lambda rest: rest[: 6 * SIZE] + b"other" + rest[6 * SIZE :], []),
    "5 bytes within": (lambda rest: rest[: 6 * SIZE + 9] + b"other" + rest[6 * SIZE + 9 :], [6]),
    "1 MB between": (lambda rest: rest[: 6 * SIZE] + bytes(10**6) + rest[6 * SIZE :], []),
    "zeros instead": (lambda rest: rest[: 3 * SIZE] + bytes(2 * SIZE + 9) + rest[5 * SIZE + 9 :],
                      [3, 4, 5]),
    "bytes taken out": (lambda rest: rest[: 6 * SIZE + 9] + rest[8 * SIZE + 30 :], [6, 7, 8]),
    "a mark of the end": (lambda rest: rest[: 6 * SIZE] + END + b"0 {}\n" + rest[6 * SIZE :], []),
    "5 bytes in front": (lambda rest: b"other" + rest, []),
}  # fmt: skip


@pytest.mark.parametrize(("change", "lost"), FOREIGN.values(), ids=FOREIGN)
@pytest.mark.parametrize("is_closed", [True, False])
def test_bytes_of_another_program_cost_no_other_sample(closed, path, change, lost, is_closed):
    data, start = closed
    end = len(data) if is_closed else start + 20 * SIZE
    path.write_bytes(data[:start] + change(data[start:end]))
    ticks, findings = read_ticks(path)
    assert ticks == [k for k in range(20) if k not in lost]
    assert findings.complete is (is_closed and not lost)
    assert (findings.lost, findings.missed_ticks) == (len(lost), 0)


FORGED = [
    b"[]", b"5", b"{", b"[" * 5000, b'{"started": "x"}', b'{"started": "x", "names": [5]}',
    b'{"started": "x", "names": []}', b'{"started": "x", "names": ["a", "b"]}', b"NaN", b"\xff",
    b'{"started": "x", "names": ["a", "a"], "experiment": [], "source": "rig"}',
]  # fmt: skip


@pytest.mark.parametrize("text", FORGED)
def test_forged_header_is_refused_in_a_line(text, path, capsys):
    row = struct.pack("<Qdd", 0, 1.0, 2.0)
    line = b"%08x %b\n" % (zlib.crc32(text), text)
    crc = struct.pack("<I", zlib.crc32(row, zlib.crc32(text)))
    path.write_bytes(MAGIC + line + row + crc)
    copy = path.with_name("copy.h5")
    assert main(["log", "repair", str(path), "--out", str(copy)]) == 1
    said = capsys.readouterr().err
    assert said.startswith("error: ")
    assert said.count("\n") == 1
    assert not copy.exists()


def raw_of(path):
    return read_raw(path, experiment="sweep", sample_rate_hz=200.0, rate_tolerance=0.01)


def test_recovered_log_is_a_raw_log_with_everything_in_it(path, tmp_path):
    write(path, overruns=2)
    before = path.read_bytes()
    recover(path, tmp_path / "run.h5")
    log = raw_of(tmp_path / "run.h5")
    for j, name in enumerate(needed_by("sim")):
        assert log.channels[name].tolist() == [row(k)[j] for k in range(20)]
    attributes = log.attributes
    assert (attributes["complete"], attributes["lost_samples"]) == (True, 0)
    assert "incomplete_reason" not in attributes
    assert attributes["statistics"] == {"overruns": 2}
    assert attributes["rig"] == ATTRIBUTES["rig"]
    assert (attributes["source"], attributes["reference"]) == ("rig", "sine")
    assert path.read_bytes() == before


def test_recovered_log_says_that_it_is_incomplete_and_its_quality_too(closed, path, tmp_path):
    data, start = closed
    path.write_bytes(data[: start + 12 * SIZE + 5])
    recover(path, tmp_path / "run.h5")
    log = raw_of(tmp_path / "run.h5")
    assert log.attributes["complete"] is False
    assert log.attributes["lost_samples"] == 1
    reason = log.attributes["incomplete_reason"]
    assert "1 of 13" in reason
    limits = Settings().quality.model_dump()
    check = assess(log, Quality(**limits), 200.0)["checks"]["complete"]
    assert (check["passed"], check["reason"], check["lost_samples"]) == (False, reason, 1)


@pytest.mark.parametrize(
    ("killed", "code", "said"), [(False, 0, "  nothing is lost\n"), (True, 3, "  incomplete: ")]
)
def test_repair_says_whether_it_copied_the_whole_journal(closed, path, capsys, killed, code, said):
    data, start = closed
    path.write_bytes(data[: start + 20 * SIZE] if killed else data)
    copy = path.with_name("copy.h5")
    assert main(["log", "repair", str(path), "--out", str(copy)]) == code
    printed = capsys.readouterr()
    assert printed.out.startswith(f"{copy}: 20 samples from {path}\n{said}")
    assert ("nothing is lost" in printed.out, printed.err) == (not killed, "")
    assert raw_of(copy).attributes["complete"] is not killed


def test_journal_without_a_sample_gives_no_log(path, tmp_path):
    write(path, ticks=[])
    with pytest.raises(LogError, match=str(path)):
        recover(path, tmp_path / "run.h5")
    assert not (tmp_path / "run.h5").exists()


def test_attributes_of_any_name_are_kept(path, tmp_path):
    more = dict.fromkeys(["path", "channels", "operator"], "mine")
    with Journal(path, NAMES, ATTRIBUTES | more) as journal:
        journal.append(0, row(0))
    recover(path, tmp_path / "run.h5")
    assert more.items() <= read_columns(tmp_path / "run.h5", ()).attributes.items()
