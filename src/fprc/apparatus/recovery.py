"""Read the journal of a run, however it ended, and convert it, or what it lost, to a raw log."""

import re
import tempfile
import zlib
from collections.abc import Mapping
from functools import partial
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from fprc.apparatus.journal import END, MAGIC, Journal, content_of
from fprc.apparatus.journal import UINT32 as _CRC
from fprc.artifacts import refuse_output
from fprc.errors import FprcError, LogError
from fprc.given import read_given
from fprc.logs.raw import write_raw

#: What header and end mark must hold.
_HEADER = {"names": list, "started": str}
_END = {"samples": int, "reason": str, "statistics": dict}

_NOT_ZERO = re.compile(rb"[^\0]")

#: Largest journal: 16 h of ten channels at 200 Hz.
LARGEST_JOURNAL_BYTES = 1 << 30


class Findings(NamedTuple):
    """Which samples of a run can be read, and how the run ended."""

    samples: int  #: number of readable samples
    lost: int  #: number of samples that were written but cannot be read
    missed_ticks: int  #: ticks without a sample between the first and the last one
    closed: bool  #: whether the end mark exists
    complete: bool  #: whether the run reached its planned end and no sample is lost
    reason: str  #: why it is not complete; empty if it is
    statistics: dict[str, Any]  #: statistics from the end mark


def read_journal(path: Path | str) -> tuple[dict[str, np.ndarray], dict[str, Any], Findings]:
    """Read a journal, even if it is truncated, damaged, or still being written.

    Returns
    -------
    channels : dict of ndarray
        Every sample whose checksum is right, by tick.
    attributes : dict
        As given to ``Journal``.
    findings : Findings

    Raises
    ------
    LogError
        The file cannot be opened, is not a journal, or its header is damaged.
    """
    data = read_given(path, error=LogError, most_bytes=LARGEST_JOURNAL_BYTES)
    line = data[: data.find(b"\n", len(MAGIC)) + 1]
    header = content_of(line.removeprefix(MAGIC), _HEADER) if data.startswith(MAGIC) else None
    names = header[0].pop("names") if header else []
    if header is None or not names or not all(isinstance(name, str) for name in names):
        raise LogError(
            f"{path}: not a journal of this version, or its header is damaged or cut; give the "
            "file *.journal beside the raw log, restore it, or run again"
        )
    attributes, seed = header
    record = np.dtype([("tick", "<u8"), ("row", "<f8", (len(names),)), ("crc", "<u4")])
    starts, end, inside, after = _find(data, len(line), record.itemsize, seed)
    records = np.array([data[at : at + record.itemsize] for at in starts], "V").view(record)
    # a disk that returns a page twice, or in another place, loses nothing
    ticks, kept = np.unique(records["tick"].astype(np.int64), return_index=True)
    channels = {name: records["row"][kept, j] for j, name in enumerate(names)}
    lost = max(end["samples"] - kept.size, 0) if end else inside + after
    missed = int(np.ptp(ticks)) + 1 - kept.size - (lost if end else inside) if kept.size else 0
    return channels, attributes, _findings(kept.size, lost, missed, end)


def _find(
    data: bytes, at: int, size: int, seed: int
) -> tuple[list[int], dict[str, Any] | None, int, int]:
    """Return where samples begin, the end mark, and the samples lost among them and after them.

    After bytes that are no sample, the next one is looked for at each byte: another program may
    have written to the file.
    """
    starts, foreign, lost, last = list[int](), 0, 0, -1
    while at < len(data):
        sample = data[at : at + size]
        if len(sample) == size and zlib.crc32(sample[:-4], seed) == _CRC.unpack(sample[-4:])[0]:
            tick = int.from_bytes(sample[:8], "little")
            if foreign:  # the ticks that are missing here were not missed by the loop
                lost += tick - last - 1 if tick > last else foreign // size
            last = tick
            starts.append(at)
            foreign, at = 0, at + size
        elif sample.startswith(END) and (end := content_of(data[at + len(END) :], _END, seed)):
            return starts, end[0], lost, 0
        else:
            other = _NOT_ZERO.search(data, at)  # a disk may return a long hole as zeros
            step = max((other.start() if other else len(data)) - size + 1 - at, 1)
            foreign, at = foreign + step, at + step
    return starts, None, lost, -(-foreign // size)


def _findings(samples: int, lost: int, missed_ticks: int, end: dict[str, Any] | None) -> Findings:
    reasons = []
    if end is None:
        reasons.append(
            "the end mark is missing: the program was killed, or the power failed and up to a "
            "second more is lost"
        )
    elif end["reason"]:
        reasons.append(end["reason"])
    if lost:
        reasons.append(f"{lost} of {samples + lost} samples are lost")
    return Findings(
        samples=samples,
        lost=lost,
        missed_ticks=max(missed_ticks, 0),
        closed=end is not None,
        complete=not reasons,
        reason="; ".join(reasons),
        statistics=end["statistics"] if end else {},
    )


def difference(path: Path, channels: Mapping[str, np.ndarray]) -> str:
    """Return how a closed journal differs from the samples in memory; empty if it has them all."""
    try:
        read, _, findings = read_journal(path)
    except LogError as error:
        return str(error)
    samples = len(channels["time_s"])
    # an interrupt may have come between the two
    same = [np.array_equal(read[name][:samples], channels[name], equal_nan=True) for name in read]
    if all(same):
        return ""
    return (
        f"{path}: holds {findings.samples} samples that are not the {samples} of the run; another "
        "program wrote to it, or its disk fails"
    )


def recover(journal: Path | str, raw: Path | str) -> Findings:
    """Write the readable samples of a journal as a raw log; the journal is not changed.

    Raises
    ------
    LogError
        See ``read_journal``; also, no sample can be read.
    OutputError
        See ``refuse_output``.
    """
    refuse_output(raw, ".h5")
    channels, attributes, findings = read_journal(journal)
    if not findings.samples:
        raise LogError(f"{journal}: no sample can be read; nothing was written")
    _write(raw, channels, attributes, findings.statistics, findings.reason, findings.lost)
    return findings


def rescue(
    journal: Journal,
    channels: Mapping[str, np.ndarray],
    *,
    reason: str = "",
    statistics: Mapping[str, Any],
) -> Path:
    """Write samples that are in memory, but not in their closed journal, as a raw log.

    The log is written into the journal's folder; if that is not possible, into the current one;
    if that is not possible either, into a new folder among the temporary files.

    Parameters
    ----------
    channels : Mapping of str to ndarray
        Every sample of the run.
    reason : str
        Why the run is not complete; empty if it is.
    statistics : Mapping
        Statistics of the run.

    Returns
    -------
    Path
        The log that was written.

    Raises
    ------
    LogError
        It could be written nowhere; lists the reasons.
    """
    problems = []
    beside = partial(journal.path.parent.resolve, strict=True)  # not made again once it is gone
    for folder in (beside, Path.cwd, lambda: Path(tempfile.mkdtemp(prefix="fprc-"))):
        try:
            raw = folder() / journal.path.with_suffix(".rescued.h5").name
            refuse_output(raw, ".h5")
            _write(raw, channels, journal.attributes, statistics, reason, 0)
        except (FprcError, OSError) as error:
            problems.append(str(error))
        else:
            return raw
    raise LogError("\n".join(problems))


def _write(
    raw: Path | str,
    channels: Mapping[str, np.ndarray],
    attributes: Mapping[str, Any],
    statistics: Mapping[str, Any],
    reason: str,
    lost: int,
) -> None:
    """Write a raw log, complete unless there is a reason why it is not."""
    state = {"statistics": statistics, "complete": not reason, "lost_samples": lost}
    why = {"incomplete_reason": reason} if reason else {}
    write_raw(raw, channels, **{**attributes, **state, **why})
