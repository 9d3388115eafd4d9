import errno
import os
import struct
import threading
import zlib

import numpy as np
import pytest
from bench import journal_at
from hypothesis import given
from hypothesis import strategies as st

from fprc.apparatus import journal as module
from fprc.apparatus.journal import Journal, read_journal
from fprc.channels import needed_by
from fprc.cli import main
from fprc.errors import LogError
from fprc.logs import read_raw

NAMES = (*needed_by("sim"), "theta_d_deg")
ATTRIBUTES = {
    "experiment": "sweep", "source": "rig", "sample_rate_hz": 200.0, "seed": 0,
    "software": "fprc test", "rig": {"boards": {"library": "θ"}}, "reference": "sine",
    "started": "now", "path": "mine", "channels": "mine",
}  # fmt: skip
# as data/raw/README.md documents it
MARK = b"\x89FPRCJ3\n"
SIZE = len(MARK) + 4 + 8 + 8 * len(NAMES)


def row(k):
    return (k / 200.0, *(k + j / 16.0 for j in range(1, len(NAMES))))


def write(path, ticks=range(20), started="now", **closing):
    journal = Journal(path, NAMES, ATTRIBUTES | {"started": started})
    for k in ticks:
        journal.append(k, row(k))
    journal.close(**closing)


@pytest.fixture
def path(tmp_path):
    return tmp_path / "run.journal"


@pytest.fixture(scope="module")
def closed(tmp_path_factory):
    """Header, samples and end mark of a closed journal of 20 samples, and samples of another."""
    files = []
    for started in ("now", "another time"):
        path = tmp_path_factory.mktemp("closed") / "run.journal"
        write(path, started=started, overruns=3)
        data = path.read_bytes()
        start = data.index(MARK, 1)
        end = start + 20 * SIZE
        files.append((data[:start], data[start:end], data[end:]))
    return *files[0], files[1][1]


def read_ticks(path):
    """Return the ticks of the samples read; each sample must be as written."""
    findings = journal_at(path)
    channels, attributes = findings.channels, findings.attributes
    ticks = np.rint(channels["time_s"] * 200.0).astype(int).tolist()
    rows = np.column_stack([channels[name] for name in NAMES])
    assert rows.tolist() == [list(row(k)) for k in ticks]
    assert ticks == sorted(set(ticks))
    assert findings.samples == len(ticks)
    assert {name: attributes[name] for name in ATTRIBUTES} == ATTRIBUTES
    return ticks, findings


def test_existing_file_is_not_overwritten_and_a_closed_journal_takes_no_sample(path):
    journal = Journal(path, NAMES, ATTRIBUTES)
    journal.close()
    before = path.read_bytes()
    with pytest.raises(LogError):
        journal.append(0, row(0))
    with pytest.raises(LogError, match=str(path)):
        Journal(path, NAMES, ATTRIBUTES)
    assert path.read_bytes() == before


def test_samples_are_brought_to_the_disk_while_the_run_goes_on(path, monkeypatch):
    synced, sizes = threading.Event(), []

    def noted(file):
        sizes.append(os.fstat(file).st_size)
        if len(sizes) > 2:  # the first two: header and folder
            synced.set()

    monkeypatch.setattr(os, "fsync", noted)
    monkeypatch.setattr(module, "_SYNC_S", 0.01)
    journal = Journal(path, NAMES, ATTRIBUTES)
    assert len(sizes) == 2
    journal.append(0, row(0))
    assert synced.wait(10.0)
    assert sizes[2] == sizes[0] + SIZE
    journal.close()


def test_sample_that_is_appended_during_a_check_is_no_loss(path, monkeypatch):
    journal, fstat = Journal(path, NAMES, ATTRIBUTES), os.fstat

    def fstat_then_append(file):
        found = fstat(file)
        journal.append(0, row(0))
        return found

    with monkeypatch.context() as patch:
        patch.setattr(os, "fstat", fstat_then_append)
        journal.close()
    assert read_ticks(path)[0] == [0]


def broken(file):
    raise OSError(errno.EIO, "Input/output error")


@pytest.mark.parametrize("one_more", [True, False])
def test_disk_that_fails_ends_the_run_and_keeps_the_samples_written(path, monkeypatch, one_more):
    monkeypatch.setattr(module, "_SYNC_S", 0.001)
    journal = Journal(path, NAMES, ATTRIBUTES)
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
    assert (ticks, findings.closed, "Input/output error" in findings.reason) == ([0], True, True)


def fill(patch, room):
    """Let the disk take some more bytes, and then none."""
    os_write, left = os.write, [room]

    def full(file, data):
        if not left[0]:
            raise OSError(errno.ENOSPC, "No space left on device")
        taken, left[0] = left[0], 0
        return os_write(file, bytes(data)[:taken])

    patch.setattr(os, "write", full)


@pytest.mark.parametrize("room", [0, 50])
@pytest.mark.parametrize("ended", [True, False])
def test_full_disk_is_reported_and_leaves_whole_samples(path, monkeypatch, room, ended):
    journal = Journal(path, NAMES, ATTRIBUTES)
    for k in range(3):
        journal.append(k, row(k))
    before = path.stat().st_size
    with monkeypatch.context() as patch:
        fill(patch, room)
        with pytest.raises(LogError, match="No space left"):
            journal.close() if ended else journal.append(3, row(3))
    assert path.stat().st_size == before + room
    if not ended:
        for more in (lambda: journal.append(3, row(3)), journal.close):
            with pytest.raises(LogError, match="No space left"):
                more()
    ticks, findings = read_ticks(path)
    assert (ticks, findings.closed) == ([0, 1, 2], not ended)
    assert ended or (findings.lost == 0 and "No space left" in findings.reason)


def test_journal_whose_header_does_not_fit_begins_no_run(path, monkeypatch):
    fill(monkeypatch, 40)
    with pytest.raises(LogError, match="No space left"):
        Journal(path, NAMES, ATTRIBUTES)


@given(
    cut=st.integers(0, 10_000),
    flips=st.lists(st.tuples(st.integers(0, 10_000), st.integers(1, 255)), max_size=8),
)
def test_any_damage_leaves_the_other_samples(closed, tmp_path_factory, cut, flips):
    data, start = b"".join(closed[:3]), len(closed[0])
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
        assert (findings.reason == "") is (ticks == list(range(20)))
    if not touched:
        assert findings.closed is (len(damaged) == len(data))


#: What a disk or another program makes of the samples ``s``, with those of another journal ``o``,
#: and which samples it costs.
CHANGES = {
    "5 and 9 exchanged": (lambda s, o: s[:5 * SIZE] + s[9 * SIZE:10 * SIZE] + s[6 * SIZE:9 * SIZE]
                          + s[5 * SIZE:6 * SIZE] + s[10 * SIZE:], []),
    "three twice": (lambda s, o: s[:8 * SIZE] + s[5 * SIZE:], []),
    "of another": (lambda s, o: s[:4 * SIZE] + o[4 * SIZE:8 * SIZE] + s[8 * SIZE:], [4, 5, 6, 7]),
    "5 bytes between": (lambda s, o: s[:6 * SIZE] + b"other" + s[6 * SIZE:], []),
    "5 bytes within": (lambda s, o: s[:6 * SIZE + 9] + b"other" + s[6 * SIZE + 9:], [6]),
    "5 bytes in front": (lambda s, o: b"other" + s, []),
    "50 MB between": (lambda s, o: s[:6 * SIZE] + bytes(5 * 10**7) + s[6 * SIZE:], []),
    "cut at their edges": (lambda s, o: s[:3 * SIZE] + s[6 * SIZE:], [3, 4, 5]),
    "zeros instead": (lambda s, o: s[:3 * SIZE] + bytes(2 * SIZE + 9) + s[5 * SIZE + 9:],
                      [3, 4, 5]),
    "bytes taken out": (lambda s, o: s[:6 * SIZE + 9] + s[8 * SIZE + 30:], [6, 7, 8]),
    "a mark of the end": (lambda s, o: s[:6 * SIZE] + MARK + b"1234{}\n" + s[6 * SIZE:], []),
}  # fmt: skip


@pytest.mark.parametrize(("change", "lost"), CHANGES.values(), ids=CHANGES)
@pytest.mark.parametrize("is_closed", [True, False])
def test_damage_costs_no_other_sample_and_is_counted(closed, path, change, lost, is_closed):
    header, samples, end, other = closed
    path.write_bytes(header + change(samples, other) + (end if is_closed else b""))
    ticks, findings = read_ticks(path)
    assert ticks == [k for k in range(20) if k not in lost]
    assert (findings.reason == "") is (is_closed and not lost)
    assert (findings.lost, findings.closed) == (len(lost) if is_closed else 0, is_closed)
    assert is_closed or (f"{len(lost)} of 20 ticks" in findings.reason) is bool(lost)


def test_marker_among_the_numbers_of_a_sample_costs_none(path):
    (number,) = struct.unpack("<d", MARK)
    journal = Journal(path, NAMES, ATTRIBUTES)
    for k in range(3):
        journal.append(k, [*row(k)[:3], number, *row(k)[4:]])
    journal.close()
    findings = journal_at(path)
    assert (findings.samples, findings.reason) == (3, "")
    assert findings.channels[NAMES[3]].tolist() == [number] * 3


FORGED = [
    b"[]", b"5", b"{", b"[" * 5000, b'{"started": "x"}', b'{"started": "x", "names": [5]}',
    b'{"started": "x", "names": []}', b'{"started": "x", "names": ["a", "b"]}', b"NaN", b"\xff",
    b'{"started": "x", "names": ["a", "a"], "experiment": [], "source": "rig"}',
    b'{"started": "x", "names": ["/", "a"], "experiment": "sweep", "source": "rig", "rig": {}, '
    b'"sample_rate_hz": 200, "seed": 1, "software": "x"}',
]  # fmt: skip


@pytest.mark.parametrize("text", FORGED)
def test_forged_header_is_refused_in_a_line(text, path, capsys):
    row, crc = struct.pack("<Qdd", 0, 1.0, 2.0), zlib.crc32(text + b"\n")
    parts = [(crc, text + b"\n"), (zlib.crc32(row, crc), row)]
    path.write_bytes(b"".join(MARK + struct.pack("<I", crc) + content for crc, content in parts))
    copy = path.with_name("copy.h5")
    assert main(["log", "repair", str(path), "--out", str(copy)]) == 1
    said = capsys.readouterr().err
    assert said.startswith("error: ")
    assert said.count("\n") == 1
    assert not copy.exists()


@pytest.mark.parametrize(("samples", "code"), [(20, 0), (12, 3), (0, 1)])
def test_repair_writes_a_raw_log_and_says_whether_it_is_whole(closed, path, samples, code):
    header, body, end, _ = closed
    # one is cut in the middle
    path.write_bytes(header + (body + end if samples == 20 else body[: samples * SIZE + 5]))
    before, copy = path.read_bytes(), path.with_name("copy.h5")
    assert main(["log", "repair", str(path), "--out", str(copy)]) == code
    assert path.read_bytes() == before
    if not samples:
        assert not copy.exists()
        return
    log = read_raw(copy, experiment="sweep", sample_rate_hz=200.0, rate_tolerance=0.01)
    for j, name in enumerate(needed_by("sim")):
        assert log.channels[name].tolist() == [row(k)[j] for k in range(samples)]
    assert ATTRIBUTES.items() <= log.attributes.items()
    state = (log.attributes["complete"], log.attributes["lost_samples"])
    assert state == (code == 0, int(code == 3))
    assert ("1 of 13" in log.attributes.get("incomplete_reason", "")) is (code == 3)
    assert log.attributes["statistics"] == ({} if code else {"overruns": 3})
