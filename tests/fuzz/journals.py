"""Journals with changed bytes, lost or moved parts, or two runs in one file."""

import json
import tempfile
from functools import cache
from pathlib import Path
from typing import Any, NamedTuple

import damage
import numpy as np
import signals
from judging import SAID, SAME, SILENT, Case, Ended, Step, Verdict, differing
from raw_logs import content

from fprc.channels import RAW_CHANNELS
from fprc.logs import Journal


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
        "started": "2024-01-01T00:00:00.000000+00:00",  # the same bytes each time
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
    kept = [k for k, name in enumerate(names) if name != without]
    return Run(data, tuple(names[k] for k in kept), rows[:, kept], attributes)


def case(rng: np.random.Generator, folder: Path) -> Case:
    """Make a case with a damaged journal."""
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

    command = ("log", "repair", "run.journal", "--out", "run.h5")
    step = Step(
        command, "fprc log repair", ("run.journal",), repaired, ("run.h5",),
        lambda ended: ended.code in (0, 3),
    )  # fmt: skip
    return Case("journal", f"{name}: {change}", [step], sound=data == run.data)


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
