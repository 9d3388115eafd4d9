"""Read the journal of a run, whatever ended it, and bring it into a raw log."""

import json
import zlib
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from fprc.errors import LogError
from fprc.logs.journal import END, MAGIC, UINT32, refuse_description, seed_of
from fprc.logs.raw import write_raw


class Stretch(NamedTuple):
    """Samples that cannot be read, one after the other, between two that can."""

    samples: int
    from_s: float | None
    to_s: float | None


class Findings(NamedTuple):
    """What became of a run's samples."""

    #: Samples that can be read.
    samples: int
    #: Samples that were written and cannot be read.
    lost: int
    stretches: tuple[Stretch, ...]
    #: Instant of the last sample that can be read; None if there is none.
    last_s: float | None
    #: Ticks between the first and the last sample for which none was written, if that is known.
    missed_ticks: int
    #: Samples that were not in their place, or twice; their ticks tell their order.
    misplaced: int
    #: Whether the end mark is there.
    closed: bool
    #: Whether the run came to its planned end and nothing is lost.
    complete: bool
    #: Why not.
    reason: str
    #: What the run said of itself when it was closed.
    statistics: dict[str, Any]


class _Block(NamedTuple):
    content: dict[str, Any]
    at: int
    raw: bytes


def read_journal(path: Path | str) -> tuple[dict[str, np.ndarray], dict[str, Any], Findings]:
    """Read a journal, whole or cut or damaged, or one that is being written.

    Returns
    -------
    channels : dict of ndarray
        Every sample whose checksum is right, in order.
    attributes : dict
        As given to ``Journal.create``.
    findings : Findings
        What is lost.

    Raises
    ------
    LogError
        The file cannot be opened, is no journal, or both copies of its header are damaged; the
        header lacks something, or something in it is not of its kind.
    """
    path = Path(path)
    try:
        data = path.read_bytes()
    except OSError as error:
        raise LogError(f"{path}: cannot be opened ({error.strerror}); check the path") from error
    header = _find(data, MAGIC, 0)
    if header is None:
        raise LogError(_no_header(path, data))
    attributes = header.content
    names = attributes.pop("names", None)
    refuse_description(path, names, attributes)
    # of two copies, the one that begins the file is the first
    start = header.at + (2 if header.at == 0 else 1) * len(header.raw)
    seed = seed_of(header.raw)
    record = np.dtype([("tick", "<u8"), ("row", "<f8", (len(names),)), ("crc", "<u4")])
    end = _find(data, END, start, seed)
    room = _room(data, start, record)
    begun = end.content["samples"] if end else room
    there = max(min((len(data) - start) // record.itemsize, room), 0)
    records = np.frombuffer(data, record, there, start) if there else np.empty(0, record)
    right = np.flatnonzero(_checksums(data, start, records, seed) == records["crc"])
    found = records["tick"][right].astype(np.int64)
    misplaced = int((found[1:] <= np.maximum.accumulate(found)[:-1]).sum())
    ticks, first = np.unique(found, return_index=True)
    if misplaced and not end:
        begun -= len(found) - len(ticks)
    rows = records["row"][right[first]]
    channels = {name: rows[:, j].copy() for j, name in enumerate(names)}
    findings = _findings(right[first], begun, ticks, channels["time_s"], misplaced, end)
    return channels, attributes, findings


def _find(data: bytes, marker: bytes, start: int, seed: int = 0) -> _Block | None:
    """Return the first block of this kind whose checksum is right."""
    at = data.find(marker, start)
    while at >= 0:
        text_at = at + len(marker) + UINT32.size
        if text_at <= len(data):
            crc_at = text_at + UINT32.unpack_from(data, text_at - UINT32.size)[0]
            if crc_at + UINT32.size <= len(data):
                (crc,) = UINT32.unpack_from(data, crc_at)
                if zlib.crc32(data[at:crc_at], seed) == crc:
                    try:
                        content = json.loads(data[text_at:crc_at])
                    except (ValueError, RecursionError):
                        content = None
                    if isinstance(content, dict):
                        return _Block(content, at, data[at : crc_at + UINT32.size])
        at = data.find(marker, at + 1)
    return None


def _no_header(path: Path, data: bytes) -> str:
    version = data[6:7]
    if data[:6] == MAGIC[:6] and version.isdigit() and version != MAGIC[6:7]:
        return f"{path}: a journal of version {version.decode()}; read it with a newer fprc"
    if MAGIC in data or MAGIC.startswith(data[: len(MAGIC)]):
        return (
            f"{path}: both copies of the header are damaged or cut, and without it nobody knows "
            "what the numbers are; restore the file, or run again"
        )
    return f"{path}: not a journal; journals are described in data/raw/README.md"


def _room(data: bytes, start: int, record: np.dtype) -> int:
    """Return how many samples the file has room for, the last one perhaps in part."""
    for at in range(start, len(data), record.itemsize):
        if data.startswith(END, at):
            return (at - start) // record.itemsize
    return max(-(-(len(data) - start) // record.itemsize), 0)


def _checksums(data: bytes, start: int, records: np.ndarray, seed: int) -> np.ndarray:
    size = records.dtype.itemsize
    view = memoryview(data)
    begins = range(start, start + len(records) * size, size)
    return np.array(
        [zlib.crc32(view[at : at + size - UINT32.size], seed) for at in begins], dtype=np.uint32
    )


def _findings(
    places: np.ndarray,
    begun: int,
    ticks: np.ndarray,
    times_s: np.ndarray,
    misplaced: int,
    end: _Block | None,
) -> Findings:
    lost = max(begun - len(places), 0)
    # of samples that are not in their place nobody knows between which of them others are lost
    known = lost and not misplaced
    edges = np.concatenate([[-1], places, [begun]])
    stretches = tuple(
        Stretch(
            int(edges[k + 1] - edges[k]) - 1,
            float(times_s[k - 1]) if k > 0 else None,
            float(times_s[k]) if k < len(times_s) else None,
        )
        for k in (np.flatnonzero(np.diff(edges) > 1) if known else ())
    )
    missed = int(np.ptp(ticks) - np.ptp(places)) if len(ticks) and not misplaced else 0
    reasons = []
    if end is None:
        reasons.append("not closed: the program was killed or the power failed")
    elif not end.content["complete"]:
        reasons.append(end.content["reason"] or "stopped before its end")
    if lost:
        reasons.append(f"{lost} of {begun} samples are lost")
    if misplaced:
        reasons.append(f"samples that were not in their place: {misplaced}")
    return Findings(
        samples=len(places),
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


# --- as a raw log ---------------------------------------------------------------------------


def recover(journal: Path | str, raw: Path | str) -> Findings:
    """Write what can be read of a journal as a raw log; the journal stays as it is.

    A channel without a single number, of a sensor that the rig does not have, is left out.

    Raises
    ------
    LogError
        See ``read_journal``; further there is no sample, or ``raw`` exists.
    """
    refuse_existing(raw)
    channels, attributes, findings = read_journal(journal)
    if not findings.samples:
        raise LogError(f"{journal}: no sample can be read; nothing was written")
    told = {name: value for name, value in attributes.items() if name != "simulated"}
    told |= {
        "statistics": findings.statistics,
        "complete": findings.complete,
        "lost_samples": findings.lost,
    }
    if not findings.complete:
        told["incomplete_reason"] = findings.reason
    measured = {name: values for name, values in channels.items() if not np.isnan(values).all()}
    write_raw(raw, measured, **told)
    return findings


def refuse_existing(raw: Path | str) -> None:
    """Check that a copy can be written under this name.

    Raises
    ------
    LogError
        Something is there, or the name is none of a raw log.
    """
    if Path(raw).suffix != ".h5":
        raise LogError(f"{raw}: a raw log's name ends in .h5; write --out {Path(raw).stem}.h5")
    if Path(raw).exists():
        raise LogError(f"{raw}: exists and is not overwritten; choose another name for --out")
