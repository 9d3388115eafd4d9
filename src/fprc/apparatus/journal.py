"""Journal of a run on a real rig: written sample by sample, readable however the run ends.

    header  samples  end mark

Header and end mark are a marker (8 bytes) and a line: CRC-32, blank, JSON. A sample is its tick
(uint64), one float64 per channel and a CRC-32 (uint32), all little-endian. The checksums of
samples and end mark start from the header's checksum, so that those of another journal are
rejected (after a power cut a disk may return an old page).
"""

import json
import os
import struct
import threading
import zlib
from collections.abc import Mapping, Sequence
from contextlib import suppress
from datetime import UTC, datetime
from pathlib import Path
from typing import Any, Self

from fprc.errors import LogError

#: Marker of the header; the digit is the version of the format.
MAGIC = b"\x89FPRCJ2\n"
#: Marker of the end mark, at the place where a sample has its tick.
END = b"\x89FPRCE2\n"

#: Encoding of a sample's CRC-32.
UINT32 = struct.Struct("<I")


class Journal:
    """Append-only file of samples.

    Each sample is passed to the operating system at once, so that none is lost if the process
    ends. A thread syncs the file every ``sync_s``: a power cut loses at most the samples since the
    last sync, and the loop does not wait for the disk. Before each sync the thread checks that the
    file was not deleted, moved, replaced, cut or unmounted; after that, ``append`` raises.

    As a context manager it closes itself; an exception marks it incomplete. Each method raises
    LogError. ``names`` and ``attributes`` are those of a raw log; ``started``, the present time
    (UTC), is added to the latter.
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
        self._start = len(MAGIC + line)
        self._record = struct.Struct(f"<Q{len(names)}d")
        self._problem = ""
        try:
            path.parent.mkdir(parents=True, exist_ok=True)
            self._file = os.open(path, os.O_WRONLY | os.O_CREAT | os.O_EXCL | os.O_APPEND, 0o644)
        except FileExistsError as error:
            raise LogError(
                f"{path}: exists and is not overwritten; move it away (`fprc log repair` reads it)"
            ) from error
        except OSError as error:
            raise LogError(f"{path}: cannot be created ({error.strerror})") from error
        try:
            _write(self._file, MAGIC + line)
            os.fsync(self._file)
            folder = os.open(path.parent, os.O_RDONLY)
            os.fsync(folder)
            os.close(folder)
        except OSError as error:
            os.close(self._file)
            path.unlink()
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
            _write(self._file, sample + UINT32.pack(zlib.crc32(sample, self._seed)))
        except OSError as error:
            self._problem = (
                f"{self.path}: sample {self.samples} could not be written ({error.strerror}); free "
                "the disk and run again"
            )
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
            _write(self._file, END + _line(content, self._seed))
            os.fsync(self._file)
        except OSError as error:
            problem = problem or (
                f"{self.path}: the end mark could not be written ({error.strerror})"
            )
        finally:
            os.close(self._file)
            self._problem = problem or f"{self.path}: is closed"
        if problem:
            raise LogError(problem)

    def __enter__(self) -> Self:
        """Return the journal itself."""
        return self

    def __exit__(self, kind: type | None, error: BaseException | None, trace: Any) -> None:
        """Close; an exception marks the journal incomplete, and is not replaced by another."""
        try:
            self.close("" if error is None else f"{type(error).__name__}: {error}")
        except LogError:
            if error is None:
                raise

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
                    self._problem = (
                        f"{self.path}: samples from {on_disk} on may not have reached the disk "
                        f"({error.strerror}); check the disk"
                    )

    def _loss(self) -> str:
        """Return an error text if the file was lost; empty if it is whole."""
        written = self._start + self.samples * (self._record.size + UINT32.size)
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
