"""Read the journal of a run, however it ended, and convert it, or what it lost, to a raw log."""

import tempfile
import zlib
from collections.abc import Mapping
from functools import partial
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from fprc.apparatus.journal import END, MAGIC, UINT32, Journal, content_of
from fprc.artifacts import refuse_output
from fprc.errors import FprcError, LogError
from fprc.given import read_given
from fprc.logs.raw import write_raw

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
    path = Path(path)
    data = read_given(path, error=LogError, most_bytes=LARGEST_JOURNAL_BYTES)
    line, _, rest = data.removeprefix(MAGIC).partition(b"\n")
    header = content_of(line) if data.startswith(MAGIC) else None
    if header is None:
        raise LogError(
            f"{path}: not a journal of this version, or its header is damaged or cut; give the "
            "file *.journal beside the raw log, restore it, or run again"
        )
    attributes, seed = header
    names = attributes.pop("names")
    record = np.dtype([("tick", "<u8"), ("row", "<f8", (len(names),)), ("crc", "<u4")])
    # of an end mark that was not written whole, only its beginning may be there
    samples, _, last = rest.partition(END)
    end, _ = content_of(last, seed) or (None, 0)
    appended = end["samples"] if end else -(-len(samples) // record.itemsize)
    complete = len(samples) // record.itemsize
    records = np.frombuffer(samples, record, complete)
    checked = records.view(np.uint8).reshape(complete, record.itemsize)[:, : -UINT32.size]
    right = np.flatnonzero([zlib.crc32(row, seed) for row in checked] == records["crc"])
    # a disk that returns a page twice, or in another place, loses nothing
    ticks, first = np.unique(records["tick"][right].astype(np.int64), return_index=True)
    kept = right[first]
    rows = records["row"][kept]
    channels = {name: rows[:, j].copy() for j, name in enumerate(names)}
    missed = int(np.ptp(ticks) - np.ptp(kept)) if kept.size else 0
    return channels, attributes, _findings(kept.size, appended, missed, end)


def _findings(
    samples: int, appended: int, missed_ticks: int, end: dict[str, Any] | None
) -> Findings:
    lost = max(appended - samples, 0)
    reasons = []
    if end is None:
        reasons.append(
            "the end mark is missing: the program was killed, or the power failed and up to a "
            "second more is lost"
        )
    elif end["reason"]:
        reasons.append(end["reason"])
    if lost:
        reasons.append(f"{lost} of {appended} samples are lost")
    return Findings(
        samples=samples,
        lost=lost,
        missed_ticks=max(missed_ticks, 0),
        closed=end is not None,
        complete=not reasons,
        reason="; ".join(reasons),
        statistics=end["statistics"] if end else {},
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
