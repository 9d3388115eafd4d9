"""Journal of a run on a real rig: written sample by sample, readable however the run ends.

data/raw/README.md describes the format. The checksums of samples and end mark start from the
header's checksum, so that those of another journal are rejected: after a power cut a disk may
return an old page.
"""

import json
import os
import struct
import threading
import zlib
from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from pathlib import Path
from typing import Any

import numpy as np

from fprc.errors import LogError
from fprc.given import parse_object, read_given

#: Marker of a part; the digit is the version of the format.
_MARK = b"\x89FPRCJ3\n"
#: What header and end mark must hold.
_IN_HEADER = {"names": list, "started": str}
_IN_END = {"samples": int, "reason": str, "statistics": dict}
#: Time between two syncs to the disk, s.
_SYNC_S = 0.5
#: Largest journal: 15 h of ten channels at 200 Hz.
_LARGEST_BYTES = 1 << 30


class Journal:
    """Append-only file of samples.

    Each sample is passed to the operating system at once, so that none is lost if the process
    ends. A thread syncs it to the disk now and then: a power cut loses at most the samples since
    the last sync, and the loop does not wait for the disk. Before each sync the thread checks that
    the file was not deleted, moved, replaced, cut or unmounted; after that, ``append`` raises.

    Each method raises LogError. ``names`` and ``attributes`` are those of a raw log; by ``started``
    among them its checksums differ from those of another journal.
    """

    def __init__(self, path: Path, names: Sequence[str], attributes: Mapping[str, Any]):
        self.path, self._samples, self._problem = path, 0, ""
        content = json.dumps({**attributes, "names": list(names)}).encode("ascii") + b"\n"
        header, self._seed = _part(content, 0), zlib.crc32(content)
        self._bytes = len(header)
        self._record = struct.Struct(f"<Q{len(names)}d")
        try:
            path.parent.mkdir(parents=True, exist_ok=True)
            self._file = os.open(path, os.O_WRONLY | os.O_CREAT | os.O_EXCL | os.O_APPEND, 0o644)
            _write(self._file, header)
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
        self._syncing = threading.Thread(target=self._sync, daemon=True)
        self._syncing.start()

    def append(self, tick: int, row: Sequence[float]) -> None:
        """Append a sample: its tick, which must increase, and one number per channel.

        LogError: it cannot be written, earlier samples could not be synced, or the file was lost.
        """
        part = _part(self._record.pack(tick, *row), self._seed)
        if self._problem or not self._done(_write, part):
            raise LogError(self._problem)
        self._samples += 1
        self._bytes += len(part)

    def close(self, reason: str = "", **statistics: Any) -> None:
        """Write the end mark and close the file, once.

        ``reason`` tells why the run did not reach its planned end; empty if it did. LogError: as
        for ``append``, or the end mark cannot be written. The mark, if there is one, says so.
        """
        self._closing.set()
        self._syncing.join()
        self._problem = self._problem or self._loss()
        content = {"reason": self._problem or reason, "statistics": statistics}
        mark = json.dumps(content | {"samples": self._samples}).encode("ascii") + b"\n"
        self._done(_write, _part(mark, self._seed))
        self._done(os.fsync)
        os.close(self._file)
        problem, self._problem = self._problem, self._problem or f"{self.path}: is closed"
        if problem:
            raise LogError(problem)

    def _sync(self) -> None:
        on_disk = 0
        while not self._closing.wait(_SYNC_S) and not self._problem:
            samples = self._samples
            if loss := self._loss():
                self._problem = loss
            elif samples != on_disk and self._done(os.fsync):
                on_disk = samples

    def _done(self, action: Callable[..., Any], *arguments: Any) -> bool:
        """Do something with the file; return whether it succeeded, and remember why it did not."""
        try:
            action(self._file, *arguments)
        except OSError as error:
            self._problem = self._problem or (
                f"{self.path}: what follows sample {self._samples} may not have reached the disk "
                f"({error.strerror}); check it, or free some space, and run again"
            )
            return False
        return True

    def _loss(self) -> str:
        """Return an error text if the file was lost; empty if it is whole."""
        written = self._bytes  # before its size is asked for: the loop goes on to append
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


def _part(content: bytes, seed: int) -> bytes:
    return _MARK + zlib.crc32(content, seed).to_bytes(4, "little") + content


def _intact(part: bytes, end: int, seed: int) -> bytes:
    """Return the content of a part up to an end; empty if it was cut, damaged or forged."""
    crc = int.from_bytes(part[:4], "little")
    return part[4:end] if zlib.crc32(part[4:end], seed) == crc else b""


def _object(part: bytes, types: Mapping[str, type], seed: int = 0) -> dict[str, Any]:
    """Return the JSON object of a part; empty if it has none with values of these types."""
    with suppress(ValueError, RecursionError):
        content = parse_object(_intact(part, part.find(b"\n", 4) + 1, seed).decode())
        if all(type(content.get(name)) is kind for name, kind in types.items()):
            return content
    return {}


def read_journal(path: Path | str) -> tuple[dict[str, np.ndarray], dict[str, Any], bool]:
    """Read a journal, even if it is truncated, damaged, or still being written.

    Returns the channels, with every sample whose checksum is right, by tick; the attributes of a
    log; and whether there is an end mark. LogError: it cannot be opened, is no journal, or its
    header is damaged.
    """
    data = read_given(path, error=LogError, most_bytes=_LARGEST_BYTES)
    _, header, *parts = data.split(_MARK) if data.startswith(_MARK) else (b"", b"")
    attributes = _object(header, _IN_HEADER)
    names = attributes.pop("names", [])
    if not names or not all(isinstance(name, str) for name in names):
        raise LogError(
            f"{path}: not a journal of this version, or its header is damaged or cut; give the "
            "file *.journal beside the raw log, restore it, or run again"
        )
    seed = int.from_bytes(header[:4], "little")
    record = np.dtype([("tick", "<u8"), ("row", "<f8", (len(names),))])
    samples, end, cut = list[bytes](), dict[str, Any](), False
    for n, part in enumerate(parts):
        whole = _MARK.join(parts[n : n + 2])  # the marker may be among the bytes of a sample
        sample = _intact(whole, 4 + record.itemsize, seed)
        if len(sample) == record.itemsize:
            samples.append(sample)
        elif end := _object(part, _IN_END, seed):
            break
        cut = len(part) != 4 + record.itemsize or not sample
    records = np.frombuffer(b"".join(samples), record)
    # a disk that returns a page twice, or in another place, loses nothing
    ticks, kept = np.unique(records["tick"], return_index=True)
    channels = {name: records["row"][kept, j] for j, name in enumerate(names)}
    if end:
        lost, reasons = max(end["samples"] - kept.size, 0), [end["reason"]]
    else:
        lost, ran = int(cut), int(ticks[-1]) + 1 if ticks.size else 0
        reasons = [
            "the end mark is missing: the program was killed, or the power failed and up to a "
            "second more is lost"
        ]
        if kept.size < ran:  # the loop missed them, or the disk lost them
            reasons.append(f"{ran - kept.size} of {ran} ticks have no sample")
    if lost:
        reasons.append(f"{lost} of {kept.size + lost} samples are lost")
    reason = "; ".join(filter(None, reasons))
    return channels, attributes | state_of(reason, end.get("statistics", {}), lost), bool(end)


def state_of(reason: str, statistics: Mapping[str, Any], lost: int = 0) -> dict[str, Any]:
    """Return the attributes of a log that tell how its run ended, complete without a reason."""
    state = {"statistics": statistics, "complete": not reason, "lost_samples": lost}
    return state | ({"incomplete_reason": reason} if reason else {})
