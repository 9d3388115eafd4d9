"""Read the journal of a run, however it ended, and convert it, or what it lost, to a raw log."""

import json
import re
import struct
import tempfile
import zlib
from collections.abc import Mapping
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from fprc.artifacts import refuse_output
from fprc.errors import FprcError, LogError
from fprc.given import read_given
from fprc.logs.attributes import wrong_kinds
from fprc.logs.journal import END, MAGIC, UINT32, Journal, check_header, seed_of
from fprc.logs.raw import write_raw

#: Largest journal: 16 h of ten channels at 200 Hz.
LARGEST_JOURNAL_BYTES = 1 << 30


class Stretch(NamedTuple):
    """Consecutive unreadable samples, and the times of the readable ones before and after."""

    samples: int
    from_s: float | None
    to_s: float | None


class Findings(NamedTuple):
    """Which samples of a run can be read, and how the run ended."""

    samples: int  #: number of readable samples
    lost: int  #: number of samples that were written but cannot be read
    stretches: tuple[Stretch, ...]
    last_s: float | None  #: time of the last readable sample; None if there is none
    missed_ticks: int  #: ticks without a sample between the first and the last one; 0 if unknown
    misplaced: int  #: samples out of order or repeated; sorted by tick
    closed: bool  #: whether the end mark exists
    complete: bool  #: whether the run reached its planned end and no sample is lost
    reason: str  #: why it is not complete; empty if it is
    statistics: dict[str, Any]  #: statistics from the end mark


class _Block(NamedTuple):
    content: dict[str, Any]
    at: int
    raw: bytes


def read_journal(path: Path | str) -> tuple[dict[str, np.ndarray], dict[str, Any], Findings]:
    """Read a journal, even if it is truncated, damaged, or still being written.

    Returns
    -------
    channels : dict of ndarray
        Every sample whose checksum is right, in order.
    attributes : dict
        As given to ``Journal``.
    findings : Findings

    Raises
    ------
    LogError
        The file cannot be opened, is not a journal, or both copies of its header are damaged;
        an entry of the header or of the end mark is missing or of the wrong type.
    """
    path = Path(path)
    data = read_given(path, error=LogError, most_bytes=LARGEST_JOURNAL_BYTES)
    header = _find_block(data, MAGIC, 0)
    if header is None:
        raise LogError(_no_header(path, data))
    attributes = header.content
    names = attributes.pop("names", None)
    check_header(path, names, attributes)
    # a header at byte 0 is the first copy, so the second one follows
    start = header.at + (2 if header.at == 0 else 1) * len(header.raw)
    seed = seed_of(header.raw)
    record = np.dtype([("tick", "<u8"), ("row", "<f8", (len(names),)), ("crc", "<u4")])
    end = _find_block(data, END, start, seed)
    if end:
        _refuse_wrong_end(path, end.content)
    room = _room(data, start, record)
    appended = end.content["samples"] if end else room
    whole = max(min((len(data) - start) // record.itemsize, room), 0)
    records = np.frombuffer(data, record, whole, start) if whole else np.empty(0, record)
    right = np.flatnonzero(_checksums(records, seed) == records["crc"])
    stored = records["tick"][right].astype(np.int64)
    misplaced = int((stored[1:] <= np.maximum.accumulate(stored)[:-1]).sum())
    ticks, first = np.unique(stored, return_index=True)
    if misplaced and not end:
        appended -= len(stored) - len(ticks)
    rows = records["row"][right[first]]
    channels = {name: rows[:, j].copy() for j, name in enumerate(names)}
    findings = _findings(right[first], appended, ticks, channels["time_s"], misplaced, end)
    return channels, attributes, findings


def _find_block(data: bytes, marker: bytes, start: int, seed: int = 0) -> _Block | None:
    """Return the first block with this marker and a correct checksum."""
    for found in re.compile(re.escape(marker)).finditer(data, start):
        at, text_at = found.start(), found.end() + UINT32.size
        try:
            crc_at = text_at + UINT32.unpack_from(data, found.end())[0]
            if UINT32.unpack_from(data, crc_at)[0] != zlib.crc32(data[at:crc_at], seed):
                continue
            content = json.loads(data[text_at:crc_at])
        except (struct.error, ValueError, RecursionError):  # cut short, or not JSON
            continue
        if isinstance(content, dict):
            return _Block(content, at, data[at : crc_at + UINT32.size])
    return None


#: Entries of the end mark.
_END_KINDS = {"samples": int, "complete": bool, "reason": str, "statistics": dict}


def _refuse_wrong_end(path: Path, content: Mapping[str, Any]) -> None:
    problems = [f"{name} is missing" for name in _END_KINDS if name not in content]
    problems += wrong_kinds(content, _END_KINDS)
    if not problems and content["samples"] < 0:
        problems.append(f"samples = {content['samples']}: must not be below 0")
    if problems:
        raise LogError("\n".join(f"{path}: end mark: {problem}" for problem in problems))


def _no_header(path: Path, data: bytes) -> str:
    version = data[6:7]
    if data[:6] == MAGIC[:6] and version.isdigit() and version != MAGIC[6:7]:
        return f"{path}: a journal of version {version.decode()}; read it with a newer fprc"
    if MAGIC in data or MAGIC.startswith(data[: len(MAGIC)]):
        return (
            f"{path}: both copies of the header are damaged or cut, and without it the samples "
            "have no meaning; restore the file, or run again"
        )
    return f"{path}: not a journal; journals are described in data/raw/README.md"


def _room(data: bytes, start: int, record: np.dtype) -> int:
    """Return how many samples fit before the end mark or the end of the file, rounded up."""
    for at in range(start, len(data), record.itemsize):
        if data.startswith(END, at):
            return (at - start) // record.itemsize
    return max(-(-(len(data) - start) // record.itemsize), 0)


def _checksums(records: np.ndarray, seed: int) -> np.ndarray:
    rows = records.view(np.uint8).reshape(len(records), records.dtype.itemsize)[:, : -UINT32.size]
    return np.array([zlib.crc32(row, seed) for row in rows], dtype=np.uint32)


def _findings(
    positions: np.ndarray,
    appended: int,
    ticks: np.ndarray,
    times_s: np.ndarray,
    misplaced: int,
    end: _Block | None,
) -> Findings:
    lost = max(appended - len(positions), 0)
    # with misplaced samples, the positions of the lost ones are unknown
    known = lost and not misplaced
    edges = np.concatenate([[-1], positions, [appended]])
    stretches = tuple(
        Stretch(
            int(edges[k + 1] - edges[k]) - 1,
            float(times_s[k - 1]) if k > 0 else None,
            float(times_s[k]) if k < len(times_s) else None,
        )
        for k in (np.flatnonzero(np.diff(edges) > 1) if known else ())
    )
    missed = int(np.ptp(ticks) - np.ptp(positions)) if len(ticks) and not misplaced else 0
    reasons = []
    if end is None:
        reasons.append("not closed: the program was killed or the power failed")
    elif not end.content["complete"]:
        reasons.append(end.content["reason"] or "stopped early")
    if lost:
        reasons.append(f"{lost} of {appended} samples are lost")
    if misplaced:
        reasons.append(f"samples out of order or repeated: {misplaced}")
    return Findings(
        samples=len(positions),
        lost=lost,
        stretches=stretches,
        last_s=float(times_s[-1]) if len(times_s) else None,
        missed_ticks=max(missed, 0),
        misplaced=misplaced,
        closed=end is not None,
        complete=not reasons,
        reason="; ".join(reasons),
        statistics=end.content["statistics"] if end else {},
    )


def recover(journal: Path | str, raw: Path | str) -> Findings:
    """Write the readable samples of a journal as a raw log; the journal is not changed.

    A channel that is NaN throughout belongs to a sensor that the rig lacks, and is left out.

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
    for folder in (journal.folder, Path.cwd, lambda: Path(tempfile.mkdtemp(prefix="fprc-"))):
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
    described = {name: value for name, value in attributes.items() if name != "simulated"}
    described |= {"statistics": statistics, "complete": not reason, "lost_samples": lost}
    if reason:
        described["incomplete_reason"] = reason
    measured = {name: values for name, values in channels.items() if not np.isnan(values).all()}
    write_raw(raw, measured, **described)
