"""Journals with changed bytes, lost or moved parts, or two runs in one file."""

import json
import tempfile
import zlib
from functools import cache
from pathlib import Path
from typing import Any, NamedTuple

import damage
import numpy as np
import signals
from judging import SAID, SAME, SILENT, Case, Ended, Step, Verdict, differing
from raw_logs import content

from fprc.logs import RAW_CHANNELS, Journal


class Run(NamedTuple):
    """A valid journal and its content."""

    data: bytes
    names: tuple[str, ...]
    rows: np.ndarray
    attributes: dict[str, Any]


@cache
def runs() -> dict[str, Run]:
    """Return journals of runs that were closed, killed or stopped."""
    return {
        "closed": _run(close={"complete": True, "overruns": 2}),
        "killed": _run(close=None),
        "stopped": _run(close={"complete": False, "reason": "stopped by SIGTERM"}),
        "without phi": _run(close={"complete": True}, without="phi_deg"),
        "another": _run(close={"complete": True}, seed=2),
    }


def _run(close: dict[str, Any] | None, without: str = "", seed: int = 1) -> Run:
    channels = signals.hysteresis(300)
    names = tuple(channels)
    rows = np.column_stack(list(channels.values()))
    rows[:, 1:] += seed
    if without:
        rows[:, names.index(without)] = np.nan
    ticks = np.arange(len(rows)) + (np.arange(len(rows)) > 100)  # one missed tick
    attributes = {
        "experiment": "sweep", "source": "rig", "sample_rate_hz": signals.RATE_HZ, "seed": seed,
        "software": "fprc fuzz", "rig": {"control": {"k_in_kpa_per_deg": 7.0}},
    }  # fmt: skip
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder, "run.journal")
        journal = Journal(path, names, attributes)
        for tick, row in zip(ticks.tolist(), rows.tolist(), strict=True):
            journal.append(tick, row)
        if close is not None:
            journal.close(**close)
        data = path.read_bytes()
        if close is None:
            journal.close()  # ends its thread; ``data`` has no end mark
    # a fixed start time gives the same bytes each time
    data = _with_header(
        _header(data) | {"started": "2024-01-01T00:00:00.000000+00:00"}, data, len(rows)
    )
    kept = [k for k, name in enumerate(names) if name != without]
    return Run(data, tuple(names[k] for k in kept), rows[:, kept], attributes)


def case(rng: np.random.Generator, folder: Path) -> Case:
    """Make a case with a damaged journal."""
    if rng.random() < 0.1:
        return other_header(rng, folder)
    name = str(rng.choice(list(runs())))
    run = runs()[name]
    way = rng.random()
    if way < 0.02:
        data, change = run.data, "unchanged"
    elif way < 0.4:
        data, change = damage.flip(rng, run.data)
    elif way < 0.8:
        data, change = damage.ROUGH[rng.integers(len(damage.ROUGH))](rng, run.data)
    else:
        data, change = _OWN[rng.integers(len(_OWN))](rng, run)
    (folder / "run.journal").write_bytes(data)

    def repaired(folder: Path, ended: Ended) -> Verdict:
        return _compare(folder / "run.h5", run, ended)

    return Case("journal", f"{name}: {change}", [_repair(repaired)], sound=data == run.data)


def _grid(data: bytes) -> tuple[int, int]:
    """Return the position of the first sample and the size of a sample, bytes."""
    size = 8 + 8 * len(RAW_CHANNELS) + 4
    header = int.from_bytes(data[8:12], "little") + 16
    return 2 * header, size


def _swap_samples(rng, run):
    begin, size = _grid(run.data)
    a, b = sorted(int(k) for k in rng.choice(len(run.rows), 2, replace=False))
    at, to = begin + a * size, begin + b * size
    data = bytearray(run.data)
    data[at : at + size], data[to : to + size] = data[to : to + size], data[at : at + size]
    return bytes(data), f"samples {a} and {b} exchanged"


def _repeat_samples(rng, run):
    begin, size = _grid(run.data)
    a, n = int(rng.integers(len(run.rows) - 20)), int(rng.integers(1, 20))
    at = begin + a * size
    return run.data[: at + n * size] + run.data[at:], f"samples {a} to {a + n} twice"


def _drop_samples(rng, run):
    begin, size = _grid(run.data)
    a, n = int(rng.integers(len(run.rows) - 20)), int(rng.integers(1, 20))
    at = begin + a * size
    return run.data[:at] + run.data[at + n * size :], f"samples {a} to {a + n} taken out"


def _another_run(rng, run):
    """Insert samples of another run, as if the disk returned an old page."""
    other = runs()["another" if run is not runs()["another"] else "closed"]
    begin, size = _grid(run.data)
    a, n = int(rng.integers(len(run.rows) - 60)), int(rng.integers(1, 60))
    at, to = begin + a * size, begin + (a + n) * size
    old = other.data[at : to if len(other.data) >= to else len(other.data)]
    return run.data[:at] + old + run.data[to:], f"samples {a} to {a + n} of another run"


def _header_alone(rng, run):
    begin, _ = _grid(run.data)
    at = int(rng.choice([0, 7, 8, 12, begin // 2, begin - 1, begin, begin + 5]))
    return run.data[:at], f"cut at byte {at}, in the header"


_OWN = (_swap_samples, _repeat_samples, _drop_samples, _another_run, _header_alone)

#: Invalid values in a header, and in an end mark.
_WRONG = {
    "experiment": [None, 5, [], {}],
    "source": [None, 5, "moon", [], "\ud800"],
    "sample_rate_hz": [None, -1, "x", [], 0],
    "seed": [None, "x", [], 1.5, 10**30, -(10**30)],
    "software": [None, 5, []],
    "rig": [None, 5, [], "x", {"a": "\ud800"}],
    "notes": [5, [1], {"theta_deg": 5}],
    "lost_samples": [-1, 10**30, "x"],
    "names": [None, 5, [], ["time_s"], [5, None], "x", ["\x1b[31m"], {"time_s": 1},
              [*RAW_CHANNELS, "a/b_kpa"], [*RAW_CHANNELS, "\ud800_v"]],
}  # fmt: skip
_WRONG_END = {
    "samples": [None, "x", -1, 1.5, 10**30, [], True],
    "complete": [None, 1, "yes"],
    "reason": [None, 5, "\ud800"],
    "statistics": [None, 5, [], {"a": "\ud800"}],
}


def other_header(rng: np.random.Generator, folder: Path) -> Case:
    """Make a case with an invalid header or end mark and correct checksums."""
    run = runs()["closed"]
    header, end = _header(run.data), _end(run.data, len(run.rows))
    at_end = rng.random() < 0.3
    part, wrong = (end, _WRONG_END) if at_end else (header, _WRONG)
    key = str(rng.choice(list(wrong)))
    if key in part and rng.random() < 0.2:
        del part[key]
        value = "nothing"
    else:
        value = part[key] = wrong[key][rng.integers(len(wrong[key]))]
    data = _with_header(header, run.data, len(run.rows), end)
    (folder / "run.journal").write_bytes(data)

    def repaired(folder: Path, ended: Ended) -> Verdict:
        named = key in ended.out or key in ended.err
        return (SAID, "") if named else (SILENT, f"{key} = {value!r}")

    where = "end mark" if at_end else "header"
    return Case("journal", f"{where}: {key} = {value!r}", [_repair(repaired)])


def _header(data: bytes) -> dict[str, Any]:
    return json.loads(data[12 : 12 + int.from_bytes(data[8:12], "little")])


def _end(data: bytes, samples: int) -> dict[str, Any]:
    begin, size = _grid(data)
    at = begin + size * samples
    return json.loads(data[at + 12 : at + 12 + int.from_bytes(data[at + 8 : at + 12], "little")])


def _with_header(
    content: dict[str, Any], data: bytes, samples: int, mark: dict[str, Any] | None = None
) -> bytes:
    """Return a journal with another header, or end mark, and correct checksums."""
    begin, size = _grid(data)
    header = _block(data[:8], json.dumps(content).encode(), 0)
    seed = zlib.crc32(header[:-4])
    end = begin + size * samples
    parts = [data[at : at + size - 4] for at in range(begin, end, size)]
    whole = 2 * header + b"".join(_sealed(part, seed) for part in parts)
    if len(data) > end:
        text = json.dumps(mark or _end(data, samples)).encode()
        whole += 2 * _block(data[end : end + 8], text, seed)
    return whole


def _block(marker: bytes, text: bytes, seed: int) -> bytes:
    return _sealed(marker + len(text).to_bytes(4, "little") + text, seed)


def _sealed(content: bytes, seed: int) -> bytes:
    return content + zlib.crc32(content, seed).to_bytes(4, "little")


def _repair(judge) -> Step:
    return Step(
        ("log", "repair", "run.journal", "--out", "run.h5"), "fprc log repair", ("run.journal",),
        judge, ("run.h5",), lambda ended: ended.code in (0, 3),
    )  # fmt: skip


def _compare(path: Path, run: Run, ended: Ended) -> Verdict:
    """Compare the log with its journal: only written samples, in the order of writing."""
    channels, attributes = content(path)
    other = []
    if set(channels) != set(run.names):
        other.append("channels")
    else:
        rows = np.column_stack([channels[name] for name in run.names])
        if not in_order(rows, run.rows):
            other.append("samples")
        elif len(rows) < len(run.rows) and ended.code == 0:
            other.append(f"{len(run.rows) - len(rows)} samples fewer")
    expected = {name: value for name, value in run.attributes.items() if name != "rig"}
    found = {name: attributes.get(name) for name in expected}
    other += differing(found, expected)
    if json.loads(attributes["rig"]) != run.attributes["rig"]:
        other.append("rig")
    if other:
        return SILENT, f"differ: {', '.join(other)}"
    return (SAME, "") if ended.code == 0 else (SAID, "")


def in_order(rows: np.ndarray, written: np.ndarray) -> bool:
    """Return whether all rows were written, and in this order."""
    place = {row.tobytes(): k for k, row in enumerate(written)}
    found = [place.get(row.tobytes(), -1) for row in np.ascontiguousarray(rows)]
    return -1 not in found and found == sorted(set(found))
