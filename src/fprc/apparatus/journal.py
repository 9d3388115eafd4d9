"""Journal of a run on a real rig: written sample by sample, readable however the run ends.

    header  samples  end mark

Header and end mark are a marker (8 bytes) and a line: CRC-32, blank, JSON. A sample is its tick
(uint64), one float64 per channel and a CRC-32 (uint32), all little-endian. The checksums of
samples and end mark start from the header's checksum, so that those of another journal are
rejected (after a power cut a disk may return an old page).
"""

import json
import os
import re
import struct
import threading
import zlib
from collections.abc import Mapping, Sequence
from contextlib import suppress
from datetime import UTC, datetime
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from fprc.artifacts import refuse_output
from fprc.errors import LogError
from fprc.given import read_given
from fprc.logs import write_raw

#: Marker of the header; the digit is the version of the format.
_MAGIC = b"\x89FPRCJ2\n"
#: Marker of the end mark, at the place where a sample has its tick.
_END = b"\x89FPRCE2\n"
_NOT_ZERO = re.compile(rb"[^\0]")
#: Encoding of a sample's CRC-32.
_UINT32 = struct.Struct("<I")
#: What header and end mark must hold.
_IN_HEADER = {"names": list, "started": str}
_IN_END = {"samples": int, "reason": str, "statistics": dict}
#: Largest journal: 16 h of ten channels at 200 Hz.
_LARGEST_BYTES = 1 << 30


class Journal:
    """Append-only file of samples.

    Each sample is passed to the operating system at once, so that none is lost if the process
    ends. A thread syncs the file every ``sync_s``: a power cut loses at most the samples since the
    last sync, and the loop does not wait for the disk. Before each sync the thread checks that the
    file was not deleted, moved, replaced, cut or unmounted; after that, ``append`` raises.

    Each method raises LogError. ``names`` and ``attributes`` are those of a raw log; ``started``,
    the present time (UTC), is added to the latter.
    """

    def __init__(
        self,
        path: Path,
        names: Sequence[str],
        attributes: Mapping[str, Any],
        *,
        sync_s: float = 0.5,
    ):
        self.path, self.samples = path, 0
        started = {"started": datetime.now(UTC).isoformat(timespec="microseconds")}
        self.attributes = started | dict(attributes)
        line = _line(self.attributes | {"names": list(names)})
        self._seed = int(line[:8], 16)
        self._start = len(_MAGIC + line)
        self._record = struct.Struct(f"<Q{len(names)}d")
        self._problem = ""
        try:
            path.parent.mkdir(parents=True, exist_ok=True)
            self._file = os.open(path, os.O_WRONLY | os.O_CREAT | os.O_EXCL | os.O_APPEND, 0o644)
            _write(self._file, _MAGIC + line)
            os.fsync(self._file)
            folder = os.open(path.parent, os.O_RDONLY)
            os.fsync(folder)
            os.close(folder)
        except OSError as error:
            raise LogError(
                f"{path}: cannot be written ({error.strerror}); no run was started, free the disk "
                "or choose another folder"
            ) from error
        self._closing = threading.Event()
        self._syncing = threading.Thread(target=self._sync, args=(sync_s,), daemon=True)
        self._syncing.start()

    def append(self, tick: int, row: Sequence[float]) -> None:
        """Append a sample: its tick, which must increase, and one number per channel.

        LogError: it cannot be written, earlier samples could not be synced, or the file was lost.
        """
        if self._problem:
            raise LogError(self._problem)
        sample = self._record.pack(tick, *row)
        try:
            _write(self._file, sample + _UINT32.pack(zlib.crc32(sample, self._seed)))
        except OSError as error:
            self._problem = self._unwritten("sample", error)
            raise LogError(self._problem) from error
        self.samples += 1

    def close(self, reason: str = "", **statistics: Any) -> None:
        """Write the end mark and close the file; a second call does nothing.

        ``reason`` tells why the run did not reach its planned end; empty if it did. LogError: as
        for ``append``, or the end mark cannot be written. The mark, if there is one, says so.
        """
        if self._closing.is_set():
            return
        self._closing.set()
        self._syncing.join()
        problem = self._problem or self._loss()
        content = {"reason": problem or reason, "statistics": statistics, "samples": self.samples}
        try:
            _write(self._file, _END + _line(content, self._seed))
            os.fsync(self._file)
        except OSError as error:
            problem = problem or self._unwritten("end mark after sample", error)
        finally:
            os.close(self._file)
            self._problem = problem or f"{self.path}: is closed"
        if problem:
            raise LogError(problem)

    def _sync(self, period_s: float) -> None:
        on_disk = 0
        while not self._closing.wait(period_s) and not self._problem:
            samples = self.samples
            if loss := self._loss():
                self._problem = loss
            elif samples != on_disk:
                try:
                    os.fsync(self._file)
                    on_disk = samples
                except OSError as error:
                    self._problem = self._unwritten("what follows sample", error)

    def _unwritten(self, what: str, error: OSError) -> str:
        return (
            f"{self.path}: {what} {self.samples} may not have reached the disk ({error.strerror}); "
            "check it, or free some space, and run again"
        )

    def _loss(self) -> str:
        """Return an error text if the file was lost; empty if it is whole."""
        written = self._start + self.samples * (self._record.size + _UINT32.size)
        with suppress(OSError):  # if it was moved or unmounted
            kept = os.fstat(self._file)
            if os.path.samestat(self.path.stat(), kept) and kept.st_size >= written:
                return ""
        return (
            f"{self.path} was deleted, moved, replaced, cut or unmounted during the run; leave it "
            "alone, and check its disk"
        )


def _write(file: int, data: bytes) -> None:
    # on a disk that fills up, a write can end early without an error
    while data:
        data = data[os.write(file, data) :]


def _line(content: Mapping[str, Any], seed: int = 0) -> bytes:
    text = json.dumps(content).encode("ascii")
    return b"%08x %b\n" % (zlib.crc32(text, seed), text)


class Findings(NamedTuple):
    """Which samples of a run can be read, and how the run ended."""

    samples: int  #: number of readable samples
    lost: int  #: known number of samples that were written but cannot be read
    closed: bool  #: whether the end mark exists
    reason: str  #: why it is not complete; empty if it is
    statistics: dict[str, Any]  #: statistics from the end mark


def read_journal(path: Path | str) -> tuple[dict[str, np.ndarray], dict[str, Any], Findings]:
    """Read a journal, even if it is truncated, damaged, or still being written.

    Returns the channels, with every sample whose checksum is right, by tick; the attributes; and
    what was found. LogError: it cannot be opened, is no journal, or its header is damaged.
    """
    data = read_given(path, error=LogError, most_bytes=_LARGEST_BYTES)
    line = data[: data.find(b"\n", len(_MAGIC)) + 1]
    header = _content(line.removeprefix(_MAGIC), _IN_HEADER) if data.startswith(_MAGIC) else None
    names = header[0].pop("names") if header else []
    if header is None or not names or not all(isinstance(name, str) for name in names):
        raise LogError(
            f"{path}: not a journal of this version, or its header is damaged or cut; give the "
            "file *.journal beside the raw log, restore it, or run again"
        )
    attributes, seed = header
    record = np.dtype([("tick", "<u8"), ("row", "<f8", (len(names),)), ("crc", "<u4")])
    starts, end, cut = _find(data, len(line), record.itemsize, seed)
    records = np.array([data[at : at + record.itemsize] for at in starts], "V").view(record)
    # a disk that returns a page twice, or in another place, loses nothing
    ticks, kept = np.unique(records["tick"].astype(np.int64), return_index=True)
    channels = {name: records["row"][kept, j] for j, name in enumerate(names)}
    if end:
        lost, reasons = max(end["samples"] - kept.size, 0), [end["reason"]]
    else:
        lost, ran = int(cut), int(ticks.max(initial=-1)) + 1
        reasons = [
            "the end mark is missing: the program was killed, or the power failed and up to a "
            "second more is lost"
        ]
        if kept.size < ran:  # the loop missed them, or the disk lost them
            reasons.append(f"{ran - kept.size} of {ran} ticks have no sample")
    if lost:
        reasons.append(f"{lost} of {kept.size + lost} samples are lost")
    reason, statistics = "; ".join(filter(None, reasons)), end["statistics"] if end else {}
    return channels, attributes, Findings(kept.size, lost, end is not None, reason, statistics)


def _find(
    data: bytes, at: int, size: int, seed: int
) -> tuple[list[int], dict[str, Any] | None, bool]:
    """Return where samples begin, the end mark, and whether other bytes follow the last of these.

    After bytes that are no sample, the next one is looked for at each byte: another program may
    have written to the file.
    """
    starts, foreign = list[int](), False
    while at < len(data):
        sample = data[at : at + size]
        if len(sample) == size and zlib.crc32(sample[:-4], seed) == _UINT32.unpack(sample[-4:])[0]:
            starts.append(at)
            foreign, at = False, at + size
        elif sample.startswith(_END) and (end := _content(data[at + len(_END) :], _IN_END, seed)):
            return starts, end[0], False
        else:
            other = _NOT_ZERO.search(data, at)  # a disk may return a long hole as zeros
            foreign, at = True, max((other.start() if other else len(data)) - size + 1, at + 1)
    return starts, None, foreign


def _content(line: bytes, types: Mapping[str, type], seed: int = 0) -> tuple[Any, int] | None:
    """Return the content of a line and its checksum; None if it was cut, damaged or forged."""
    crc, _, text = line.rstrip(b"\n").partition(b" ")
    right = zlib.crc32(text, seed)
    with suppress(ValueError, RecursionError):
        content = json.loads(text) if crc == b"%08x" % right else None
        if isinstance(content, dict) and all(type(content.get(k)) is types[k] for k in types):
            return content, right
    return None


def recover(journal: Path | str, raw: Path | str) -> Findings:
    """Write the readable samples of a journal as a raw log; the journal is not changed.

    Errors are those of ``read_journal`` and ``refuse_output``; LogError also if there is no sample.
    """
    refuse_output(raw, ".h5")
    channels, attributes, findings = read_journal(journal)
    if not findings.samples:
        raise LogError(f"{journal}: no sample can be read; nothing was written")
    state = state_of(findings.reason, findings.statistics, findings.lost)
    write_raw(raw, channels, **attributes | state)
    return findings


def state_of(reason: str, statistics: Mapping[str, Any], lost: int = 0) -> dict[str, Any]:
    """Return the attributes of a log that tell how its run ended, complete without a reason."""
    state = {"statistics": statistics, "complete": not reason, "lost_samples": lost}
    return state | ({"incomplete_reason": reason} if reason else {})
