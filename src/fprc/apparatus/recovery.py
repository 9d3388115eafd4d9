"""Read the journal of a run, however it ended, and convert it to a raw log."""

import json
import re
import zlib
from collections.abc import Mapping
from contextlib import suppress
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from fprc.apparatus.journal import END, MAGIC, UINT32
from fprc.artifacts import refuse_output
from fprc.errors import LogError
from fprc.given import read_given
from fprc.logs import write_raw

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
    reason: str  #: why it is not complete; empty if it is
    statistics: dict[str, Any]  #: statistics from the end mark


def read_journal(path: Path | str) -> tuple[dict[str, np.ndarray], dict[str, Any], Findings]:
    """Read a journal, even if it is truncated, damaged, or still being written.

    Returns the channels, with every sample whose checksum is right, by tick; the attributes; and
    what was found. LogError: it cannot be opened, is no journal, or its header is damaged.
    """
    data = read_given(path, error=LogError, most_bytes=LARGEST_JOURNAL_BYTES)
    line = data[: data.find(b"\n", len(MAGIC)) + 1]
    header = _content(line.removeprefix(MAGIC), _HEADER) if data.startswith(MAGIC) else None
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
    reasons = [end["reason"]] if end else [
        "the end mark is missing: the program was killed, or the power failed and up to a second "
        "more is lost"
    ]  # fmt: skip
    if lost:
        reasons.append(f"{lost} of {kept.size + lost} samples are lost")
    reason, statistics = "; ".join(filter(None, reasons)), end["statistics"] if end else {}
    found = Findings(kept.size, lost, max(missed, 0), end is not None, reason, statistics)
    return channels, attributes, found


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
        if len(sample) == size and zlib.crc32(sample[:-4], seed) == UINT32.unpack(sample[-4:])[0]:
            tick = int.from_bytes(sample[:8], "little")
            if foreign:  # the ticks that are missing here were not missed by the loop
                lost += tick - last - 1 if tick > last else foreign // size
            last = tick
            starts.append(at)
            foreign, at = 0, at + size
        elif sample.startswith(END) and (end := _content(data[at + len(END) :], _END, seed)):
            return starts, end[0], lost, 0
        else:
            other = _NOT_ZERO.search(data, at)  # a disk may return a long hole as zeros
            step = max((other.start() if other else len(data)) - size + 1 - at, 1)
            foreign, at = foreign + step, at + step
    return starts, None, lost, -(-foreign // size)


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
