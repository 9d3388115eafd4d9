"""Journal of a run on a real rig: written sample by sample, readable however the run ends.

    header  samples  end mark

Header and end mark are a marker (8 bytes) and a line: CRC-32, blank, JSON. A sample is its tick
(uint64), one float64 per channel and a CRC-32 (uint32), all little-endian. The checksums of
samples and end mark start from the header's checksum, so that those of another journal are
rejected (after a power cut a disk may return an old page).
"""

import errno
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

import numpy as np

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

    As a context manager it closes itself; an exception marks it incomplete.

    Parameters
    ----------
    path : Path or str
        Its name ends in ``.journal``; an existing file is never overwritten.
    names : sequence of str
        Channels, as a raw log has them.
    attributes : Mapping
        Those that ``write_raw`` requires, and any others; ``started``, the present time (UTC),
        is added.
    sync_s : float, default=0.5
        Time between two syncs to the disk, above 0.

    Attributes
    ----------
    samples : int
        Samples appended.
    attributes : dict
        As given, with ``started``.

    Raises
    ------
    LogError
        The file exists or cannot be written.
    """

    def __init__(
        self,
        path: Path | str,
        names: Sequence[str],
        attributes: Mapping[str, Any],
        *,
        sync_s: float = 0.5,
    ):
        self.path = Path(path)
        started = {"started": datetime.now(UTC).isoformat(timespec="microseconds")}
        self.attributes = started | dict(attributes)
        line = _line(self.attributes | {"names": list(names)})
        self._seed = int(line[:8], 16)
        self._start = len(MAGIC + line)
        self._file = _open_new(self.path)
        try:
            _write(self._file, MAGIC + line)
            os.fsync(self._file)
            _sync_folder(self.path.parent)
        except OSError as error:
            os.close(self._file)
            self.path.unlink()
            raise LogError(
                f"{self.path}: cannot be written ({error.strerror}); no run was started, free the "
                "disk or choose another folder"
            ) from error
        self.samples = 0
        self._record = struct.Struct(f"<Q{len(names)}d")
        self._buffer = bytearray(self._record.size + UINT32.size)
        self._checked = memoryview(self._buffer)[: self._record.size]
        self._problem = ""
        self._closing = threading.Event()
        self._syncing = threading.Thread(target=self._sync, args=(sync_s,), daemon=True)
        self._syncing.start()

    def append(self, tick: int, row: Sequence[float]) -> None:
        """Append one sample.

        Parameters
        ----------
        tick : int
            Tick of the sample; must increase.
        row : sequence of float
            One number per channel, in the order of ``names``.

        Raises
        ------
        LogError
            It cannot be written, earlier samples could not be synced, or the file was lost.
            Samples already written stay readable unless it was.
        """
        if self._problem:
            raise LogError(self._problem)
        self._record.pack_into(self._buffer, 0, tick, *row)
        UINT32.pack_into(self._buffer, self._record.size, zlib.crc32(self._checked, self._seed))
        try:
            _write(self._file, self._buffer)
        except OSError as error:
            self._problem = (
                f"{self.path}: sample {self.samples} could not be written ({error.strerror}); the "
                "samples before it are kept, copy them with `fprc log repair`, free the disk and "
                "run again"
            )
            raise LogError(self._problem) from error
        self.samples += 1

    def close(self, reason: str = "", **statistics: Any) -> None:
        """Write the end mark and close the file; a second call does nothing.

        Parameters
        ----------
        reason : str
            Why the run did not reach its planned end; empty if it did.
        **statistics
            Statistics of the run, for its raw log.

        Raises
        ------
        LogError
            A sample or the end mark could not be written, samples could not be synced, or the
            file was lost. The end mark, if there is one, says so.
        """
        if self._closing.is_set():
            return
        self._closing.set()
        self._syncing.join()
        self._problem = self._problem or self._loss()
        content: dict[str, Any] = {"reason": self._problem or reason, "statistics": statistics}
        content["samples"] = self.samples
        try:
            _write(self._file, END + _line(content, self._seed))
            os.fsync(self._file)
        except OSError as error:
            self._problem = self._problem or (
                f"{self.path}: the end mark could not be written ({error.strerror}); all "
                "samples are kept, copy them with `fprc log repair`"
            )
        finally:
            os.close(self._file)
            problem, self._problem = self._problem, self._problem or f"{self.path}: is closed"
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
        while not self._closing.wait(period_s):
            samples = self.samples
            if loss := self._loss():
                self._problem = loss
                return
            try:
                if samples != on_disk:
                    os.fsync(self._file)
            except OSError as error:
                self._problem = (
                    f"{self.path}: samples from {on_disk} on may not have reached the disk "
                    f"({error.strerror}); check the disk, copy the others with `fprc log repair`"
                )
                return
            on_disk = samples

    def _loss(self) -> str:
        """Return an error text if the file was lost; empty if it is whole."""
        written = self._start + self.samples * len(self._buffer)
        with suppress(OSError):  # if it was moved or unmounted
            kept = os.fstat(self._file)
            if os.path.samestat(self.path.stat(), kept) and kept.st_size >= written:
                return ""
        return (
            f"{self.path} was deleted, moved, replaced, cut or unmounted during the run; leave it "
            "alone, and check its disk"
        )


def _open_new(path: Path) -> int:
    flags = os.O_WRONLY | os.O_CREAT | os.O_EXCL | os.O_APPEND
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        return os.open(path, flags, 0o644)
    except OSError as error:
        if error.errno == errno.EEXIST and path.exists():
            raise LogError(
                f"{path}: exists and is not overwritten; move it away (`fprc log repair` reads it)"
            ) from error
        raise LogError(f"{path}: cannot be created ({error.strerror}); check the path") from error


def _sync_folder(folder: Path) -> None:
    file = os.open(folder, os.O_RDONLY)
    try:
        os.fsync(file)
    finally:
        os.close(file)


def _write(file: int, data: bytes | bytearray) -> None:
    # on a disk that fills up, a write can end early without an error
    written = os.write(file, data)
    while written < len(data):
        written += os.write(file, memoryview(data)[written:])


def _line(content: Mapping[str, Any], seed: int = 0) -> bytes:
    def as_plain(value: Any) -> Any:  # no statistic may prevent the writing of the end mark
        return value.item() if isinstance(value, np.generic) else str(value)

    text = json.dumps(content, default=as_plain).encode("ascii")
    return b"%08x %b\n" % (zlib.crc32(text, seed), text)


def content_of(line: bytes, types: Mapping[str, type], seed: int = 0) -> tuple[Any, int] | None:
    """Return the content of a line and its checksum; None if it was cut, damaged or forged.

    Parameters
    ----------
    types : Mapping of str to type
        Keys that it must have, and what they hold.
    """
    crc, _, text = line.rstrip(b"\n").partition(b" ")
    right = zlib.crc32(text, seed)
    with suppress(ValueError, RecursionError):
        content = json.loads(text) if crc == b"%08x" % right else None
        if isinstance(content, dict) and all(type(content.get(k)) is types[k] for k in types):
            return content, right
    return None
