"""Read another program's file, and convert its columns to channels of a raw log."""

from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

import numpy as np

from fprc.channels import CONVERTED
from fprc.errors import LogError
from fprc.logs.columns import LARGEST
from fprc.recordings.arrays import read_arrays
from fprc.recordings.clock import Recording, read_clock
from fprc.recordings.delimited import read_text
from fprc.recordings.source import Source, pick

#: Formats by the ending of a file's name.
_SUFFIXES = {
    ".csv": "CSV", ".tsv": "CSV", ".txt": "CSV", ".dat": "CSV",
    ".h5": "HDF5", ".hdf5": "HDF5", ".hdf": "HDF5", ".mat": "MATLAB",
}  # fmt: skip
#: Factor from each unit to that of a raw log; ``1``: another quantity, not converted.
FACTORS = {"1": 1.0} | {name: by for units in CONVERTED.values() for name, by in units.items()}


def read_source(path: Path | str, **layout: Any) -> Source:
    """Read every variable of a CSV, HDF5 or MATLAB file that can be a channel.

    Parameters
    ----------
    **layout
        Layout of a text file, see ``read_text``.

    Raises
    ------
    LogError
        The file cannot be opened, is not in the format that its name's ending stands for, or is
        too large.
    """
    path = Path(path)
    kind = _SUFFIXES.get(path.suffix.lower())
    if kind is None:
        raise LogError(f"{path}: unknown file name ending; must be one of {', '.join(_SUFFIXES)}")
    if kind == "CSV":
        return read_text(path, **layout)
    return read_arrays(path, matlab=kind == "MATLAB")


def gather(
    source: Source,
    *,
    time: Mapping[str, Any],
    channels: Mapping[str, Mapping[str, Any]],
    start_s: float = 0.0,
    end_s: float | None = None,
) -> Recording:
    """Select, convert and cut the channels of a file.

    Parameters
    ----------
    time : Mapping
        ``column`` and ``unit``, or ``rate_hz``; see ``fprc.recordings.clock.read_clock``.
    channels : Mapping
        By channel: ``column``, ``unit``, ``scale``, ``offset``.
    start_s, end_s : float
        Interval to keep, s after the first sample; None: to the end.

    Raises
    ------
    LogError
        Lists every column that is missing; if none is, lengths differ, or time does not increase;
        if it does, lists every channel with a value in the interval that is not finite or,
        converted, too large (with its sample in the file, from 0).
    """
    wanted = {name: spec["column"] for name, spec in channels.items()}
    timed = {} if time.get("column") is None else {"time": time["column"]}
    columns = timed | wanted
    picked = _each(source, columns, lambda name: pick(source, columns[name]))
    lengths = {name: len(values) for name, values in picked.items()}
    if len(set(lengths.values())) > 1:
        unequal = ", ".join(f"{columns[name]} {length}" for name, length in lengths.items())
        raise LogError(
            f"{source.path}: columns have unequal numbers of samples ({unequal}); resample them to "
            "one clock first"
        )
    stamps = picked["time"] if timed else np.arange(min(lengths.values())) / time["rate_hz"]
    clock = _window(source, read_clock(source, time, stamps), start_s, end_s)
    converted = _each(
        source, wanted, lambda name: _convert(source, picked[name], channels[name], clock)
    )
    return clock._replace(
        time_s=clock.time_s - clock.time_s[0],
        channels=converted,
        start_s=float(clock.start_s + clock.time_s[0]),
    )


def _each(
    source: Source, columns: Mapping[str, str], work: Callable[[str], np.ndarray]
) -> dict[str, np.ndarray]:
    """Return what ``work`` returns for each name; report its errors together."""
    results, problems = {}, []
    for name, column in columns.items():
        try:
            results[name] = work(name)
        except LogError as error:
            problems.append(f"{source.path}: {name}: {column}: {error}")
    if problems:
        raise LogError("\n".join(problems))
    return results


def _window(source: Source, clock: Recording, start_s: float, end_s: float | None) -> Recording:
    last = np.inf if end_s is None else end_s
    # 1e-9: the time stamps are rounded
    kept = np.flatnonzero((clock.time_s >= start_s - 1e-9) & (clock.time_s <= last + 1e-9))
    if kept.size < 2:
        raise LogError(
            f"{source.path}: {kept.size} samples lie from {start_s:g} s to "
            f"{'the end' if end_s is None else f'{last:g} s'}; the file has {len(clock.time_s)} "
            f"samples, over {clock.time_s[-1]:g} s; correct start_s and end_s"
        )
    return clock._replace(time_s=clock.time_s[kept], first=int(kept[0]))


def _convert(
    source: Source, values: np.ndarray, spec: Mapping[str, Any], clock: Recording
) -> np.ndarray:
    """Return the clock's samples of a column, converted to the unit of a raw log."""
    kept = values[clock.first : clock.first + len(clock.time_s)]
    with np.errstate(over="ignore", invalid="ignore"):
        scaled = (kept * spec["scale"] + spec["offset"]) * FACTORS[spec["unit"]]
    bad = np.flatnonzero(~(np.abs(scaled) <= LARGEST))  # NaN is neither
    if bad.size:
        k = clock.first + int(bad[0])
        raise LogError(
            f"{source.sample(k)} is {values[k]:g}; not finite or beyond {LARGEST:g} after "
            f"scale, offset and unit in all: {bad.size}; correct these settings, cut the samples "
            "off with start_s and end_s, or fill them in"
        )
    return scaled
