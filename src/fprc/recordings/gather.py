"""Select the channels of a recording from a table, and bring them to one clock."""

import math
from collections.abc import Callable, Mapping
from typing import Any, NamedTuple

import numpy as np

from fprc.errors import LogError
from fprc.logs.columns import LARGEST
from fprc.recordings.names import SECONDS, factor_of
from fprc.recordings.resample import points_of
from fprc.recordings.table import Table

#: Most samples per channel that resampling may process.
MOST_POINTS = 5_000_000


class Recording(NamedTuple):
    """Channels at their original time stamps, in the units of a raw log."""

    time_s: np.ndarray  #: time stamps, increasing, 0 at the first sample kept
    channels: dict[str, np.ndarray]
    start_s: float = 0.0  #: time stamp of the first sample kept, on the file's clock
    notes: tuple[str, ...] = ()  #: samples that were left out


def gather(
    table: Table,
    *,
    time: Mapping[str, Any],
    channels: Mapping[str, Mapping[str, Any]],
    start_s: float = 0.0,
    end_s: float | None = None,
    skip_unusable: bool = False,
) -> Recording:
    """Select, convert and cut the channels of a file.

    Parameters
    ----------
    time : Mapping
        ``column``, ``unit`` and ``repeated``, or ``rate_hz``.
    channels : Mapping
        By channel: ``column``, ``unit``, ``scale``, ``offset``, and ``time``, the column of its
        own clock.
    start_s, end_s : float
        Interval to keep, s after the first sample; None: to the end.
    skip_unusable : bool
        Leave out lines that are no samples, and samples with a value that is not finite.

    Raises
    ------
    LogError
        Lists every column that is missing, or every channel with a value that is not finite or too
        large; or lengths differ, time does not increase, or nothing is left.
    """
    asked = {name: spec["column"] for name, spec in channels.items()}
    asked |= {f"{name}.time": spec["time"] for name, spec in channels.items() if spec.get("time")}
    asked |= {"time": time["column"]} if time.get("column") else {}
    picked = _each(table, asked, lambda name: table.pick(asked[name]).values)
    own = [name for name in channels if f"{name}.time" in picked]
    lengths = {n: len(values) for n, values in picked.items() if n.partition(".")[0] not in own}
    if len(set(lengths.values())) > 1:
        unequal = ", ".join(f"{asked[name]} {length}" for name, length in lengths.items())
        raise LogError(
            f"{table.path}: columns have unequal numbers of samples ({unequal}); say for each that "
            "has another clock which column that is, as `time: column`, or resample them first"
        )
    count = next(iter(lengths.values()), 0) or max(map(len, picked.values()))
    stamps = picked["time"] if "time" in picked else np.arange(count) / time["rate_hz"]
    values = {name: picked[name] for name in channels if name not in own}
    where = f"{table.path}: time: {time.get('column')}"
    usable, notes = _usable(table, where, stamps, values, skip_unusable)
    numbers = np.flatnonzero(usable)
    stamps, values = stamps[usable], {name: array[usable] for name, array in values.items()}
    stamps, values, numbers, note = _once(time.get("repeated"), stamps, values, numbers)
    notes += note
    _refuse_late(table, where, stamps, numbers)
    values |= {name: _at(table, name, stamps, picked[f"{name}.time"], picked[name]) for name in own}
    factor = SECONDS[time.get("unit") or "s"]
    if not len(stamps):
        raise LogError(f"{table.path}: no usable sample is left")
    # subtract before converting, or stamps counted from 1970 would lose digits
    since_s = (stamps - stamps[0]) * factor
    last_s = np.inf if end_s is None else end_s
    # 1e-9: the time stamps are rounded
    kept = (since_s >= start_s - 1e-9) & (since_s <= last_s + 1e-9)
    for name in own:  # their own clock may begin later or end earlier
        kept &= np.isfinite(values[name])
    if kept.sum() < 2:
        raise LogError(
            f"{table.path}: {kept.sum()} samples lie from {start_s:g} s to "
            f"{'the end' if end_s is None else f'{last_s:g} s'}; the file has {len(since_s)} "
            f"samples, over {since_s[-1]:g} s; correct start_s and end_s"
        )
    converted = _each(
        table,
        {name: asked[name] for name in channels},
        lambda name: _convert(table, values[name][kept], name, channels[name], numbers[kept]),
    )
    first_s = since_s[kept][0]
    begin_s = float(stamps[0] * factor + first_s)
    return Recording(since_s[kept] - first_s, converted, begin_s, notes)


def _usable(
    table: Table,
    where: str,
    stamps: np.ndarray,
    values: Mapping[str, np.ndarray],
    skip_unusable: bool,
) -> tuple[np.ndarray, tuple[str, ...]]:
    """Return which samples have a stamp and, of those to be skipped, values; notes on the others.

    Raises
    ------
    LogError
        A line is no sample, or a stamp is not finite, and they are not to be skipped.
    """
    remedy = "leave them out with `skip_unusable: true` in the map"
    lines = f"lines that are no samples: {len(table.unusable)}: {'; '.join(table.unusable[:3])}"
    if table.unusable and not skip_unusable:
        raise LogError(f"{table.path}: {lines}; repair them, or {remedy}")
    usable = np.isfinite(stamps)
    for array in values.values() if skip_unusable else ():
        usable &= np.isfinite(array)
    notes = (f"left out: {lines}",) if table.unusable else ()
    if usable.all():
        return usable, notes
    k = int(np.argmin(usable))
    first = f"{table.sample(k)}; in all: {np.sum(~usable)}"
    if not skip_unusable:
        raise LogError(
            f"{where}: {stamps[k]} at {first}; fill them in, give time.rate_hz, or {remedy}"
        )
    return usable, (*notes, f"left out: samples with missing values, the first {first}")


def _at(
    table: Table, name: str, stamps: np.ndarray, clock: np.ndarray, values: np.ndarray
) -> np.ndarray:
    """Return a channel with a clock of its own at other stamps; NaN before and after it."""
    known = np.isfinite(clock) & np.isfinite(values) if len(clock) == len(values) else None
    if known is None or not known.any() or (np.diff(clock[known]) < 0.0).any():
        raise LogError(f"{table.path}: channels.{name}.time is no clock of its column")
    return np.interp(stamps, clock[known], values[known], left=np.nan, right=np.nan)


def _once(
    how: str | None, stamps: np.ndarray, values: dict[str, np.ndarray], numbers: np.ndarray
) -> tuple[np.ndarray, dict[str, np.ndarray], np.ndarray, tuple[str, ...]]:
    """Return samples without those that repeat a stamp: the first, or the mean, of each stamp."""
    begins = np.append(0, 1 + np.flatnonzero(np.diff(stamps) != 0.0))
    if how is None or len(begins) == len(stamps):
        return stamps, values, numbers, ()
    counts = np.diff(np.append(begins, len(stamps)))
    once = {
        name: np.add.reduceat(array, begins) / counts if how == "mean" else array[begins]
        for name, array in values.items()
    }
    what = "their mean" if how == "mean" else "the first"
    note = f"{len(stamps) - len(begins)} samples repeat a time stamp; {what} of each was taken"
    return stamps[begins], once, numbers[begins], (note,)


def _refuse_late(table: Table, where: str, stamps: np.ndarray, numbers: np.ndarray) -> None:
    late = 1 + np.flatnonzero(np.diff(stamps) <= 0.0)
    if late.size:
        k = int(late[0])
        raise LogError(
            f"{where}: {table.sample(numbers[k])} at {stamps[k]:.16g} does not come after "
            f"{stamps[k - 1]:.16g}; such samples in all: {late.size}; if they repeat a time stamp, "
            "write `repeated: first` or `repeated: mean` beside the column; repair the clock if it "
            "was set back or restarted, or give time.rate_hz"
        )


def _each(
    table: Table, columns: Mapping[str, str], work: Callable[[str], np.ndarray]
) -> dict[str, np.ndarray]:
    """Return what ``work`` returns for each name; report its errors together."""
    results, problems = {}, []
    for name, column in columns.items():
        try:
            results[name] = work(name)
        except LogError as error:
            problems.append(f"{table.path}: {name}: {column}: {error}")
    if problems:
        raise LogError("\n".join(problems))
    return results


def _convert(
    table: Table, values: np.ndarray, name: str, spec: Mapping[str, Any], numbers: np.ndarray
) -> np.ndarray:
    """Return a column's samples in the unit of a raw log."""
    with np.errstate(over="ignore", invalid="ignore"):
        scaled = (values * spec["scale"] + spec["offset"]) * (factor_of(spec["unit"], name) or 1.0)
    bad = np.flatnonzero(~(np.abs(scaled) <= LARGEST))  # NaN is neither
    if bad.size:
        raise LogError(
            f"{table.sample(numbers[bad[0]])} is {values[bad[0]]:g}; not finite or beyond "
            f"{LARGEST:g} after scale, offset and unit in all: {bad.size}; correct these settings, "
            "cut the samples off with start_s and end_s, fill them in, or leave those without a "
            "value out with `skip_unusable: true` in the map"
        )
    return scaled


def refuse_length(path: object, time_s: np.ndarray, rate_hz: float) -> None:
    """Check, before resampling, that a recording is neither too short nor too long.

    Raises
    ------
    LogError
        It is too short or too long; the message names where its clock jumps.
    """
    duration_s = float(time_s[-1])
    k = int(np.argmax(np.diff(time_s)))
    jump = f"; its clock jumps from {time_s[k]:.10g} to {time_s[k + 1]:.10g} s: repair it there"
    remedy = jump if len(time_s) > 2 and time_s[k + 1] - time_s[k] > 0.5 * duration_s else ""
    with np.errstate(all="ignore"):
        points = points_of(time_s, rate_hz)
    if duration_s * rate_hz < 1.0:
        raise LogError(
            f"{path}: {duration_s:.4g} s are shorter than one sample at sample_rate_hz = "
            f"{rate_hz:g}; check time.unit, or keep more with start_s and end_s{remedy}"
        )
    if not points <= MOST_POINTS:  # NaN: the duration is infinite
        few = f"{points:.2g}" if math.isfinite(points) else "too many"
        raise LogError(
            f"{path}: {duration_s:.4g} s at sample_rate_hz = {rate_hz:g} need {few} samples in "
            f"resampling; the limit is {MOST_POINTS:.2g} samples; check time.unit, or shorten it "
            f"with start_s and end_s{remedy}"
        )
