"""Time stamps of a recording: which column holds them, in which unit, at which rate."""

import re
from os.path import commonprefix
from typing import NamedTuple

import numpy as np

from fprc.recordings.names import SECONDS, TIMES, has, is_time, parse_unit, unit_in
from fprc.recordings.table import Column, Table

#: Largest distance of a clock that jitters from a straight line, as a share of its span.
_OFF_LINE = 0.01
#: Range of the first stamp of a clock that counts from 1970 (or 1904), or days as Excel or MATLAB.
_EPOCHS = (
    (1e9, 5e9, "s"), (1e12, 5e12, "ms"), (1e15, 5e15, "us"), (1e18, 5e18, "ns"),
    (3e4, 6e4, "d"), (7e5, 8e5, "d"),
)  # fmt: skip
#: Range of sample rates of a column that may be a clock, Hz.
_LIKELY_HZ = (0.05, 50000.0)
#: A time step longer than this many median steps is a pause.
PAUSE_PERIODS = 1.5
#: A rate this near to a whole number of Hz, as a share, is that number: quartz clocks are better.
_INTEGER_TOLERANCE = 5e-4


class Clock(NamedTuple):
    """What a column is as a clock."""

    unit: str
    rate_hz: float
    repeated: int  #: samples whose stamp is that of the sample before
    doubts: tuple[str, ...] = ()


def pauses_of(time_s: np.ndarray) -> np.ndarray:
    """Return the last sample before each pause of a clock."""
    steps = np.diff(time_s)
    # of a clock that scatters, long steps are no pauses
    limit, (high, highest) = PAUSE_PERIODS * np.median(steps), np.percentile(steps, (95, 99))
    return np.flatnonzero(steps > (max(limit, 3.0 * highest) if high > limit else limit))


def rate_of(time_s: np.ndarray) -> float:
    """Return the sample rate of a recording, Hz: its steps over their span, without pauses."""
    mean = float(np.delete(np.diff(time_s), pauses_of(time_s)).mean())
    rate_hz = 1.0 / mean if mean > 0.0 else np.inf
    whole_hz = float(np.round(rate_hz))
    return whole_hz if abs(rate_hz - whole_hz) <= _INTEGER_TOLERANCE * rate_hz else rate_hz


def clocks_of(table: Table) -> dict[str, Clock]:
    """Return every column that may be a clock, the likeliest first."""
    found = {n: clock for n, column in table.columns.items() if (clock := guess_clock(n, column))}
    parts = {part for name in found if " + " in name for part in name.split(" + ")}

    def rank(name: str) -> tuple[bool, bool]:
        named = " + " in name or is_time(f"{name} {table.columns[name].label}")
        return not named, found[name].repeated > 0.5 * len(table.columns[name].values)

    return {name: found[name] for name in sorted(found, key=rank) if name not in parts}


@np.errstate(all="ignore")  # differences of large values may overflow, and are no steps of a clock
def guess_clock(name: str, column: Column) -> Clock | None:
    """Guess unit and rate of a column that increases as a clock does; None for another.

    Its steps are even, or it is near a straight line, or its name says so; it counts no samples.
    """
    stamps, words = column.values[np.isfinite(column.values)], f"{name} {column.label}"
    named = is_time(words)
    stated = parse_unit(column.unit) or unit_in(name) or unit_in(words, TIMES)
    if len(stamps) < max(3, 0.9 * len(column.values)) or (stated and stated.quantity != "s"):
        return None
    steps, span = np.diff(stamps), float(stamps[-1] - stamps[0])
    back, step = int((steps < 0.0).sum()), np.median(steps)
    even = (np.abs(steps - step) < 0.5 * step).mean() > 0.9
    off_line = np.abs(stamps - np.linspace(stamps[0], stamps[-1], len(stamps))).max()
    likely = named or even or off_line < _OFF_LINE * span
    if not likely or span <= 0.0 or back > 0.01 * len(steps) * named:
        return None
    epoch = None
    for begin, end, unit in _EPOCHS:
        if begin <= stamps[0] <= end and span / len(steps) * SECONDS[unit] <= 1.0 / _LIKELY_HZ[0]:
            epoch = unit
    whole = bool((stamps == np.round(stamps)).all())
    if whole and not stated and (has(name, "count") or (step == 1.0 and not epoch)):
        return None  # the number of the sample
    step = np.median(steps[steps > 0.0])
    usual = "s" if step < 2.0 else "ms" if step < 1e3 else "us" if step < 1e6 else "ns"
    unit = stated.text if stated else epoch or usual
    doubts: tuple[str, ...] = () if stated or epoch else ("unit?",)
    rate_hz = rate_of(np.unique(stamps - stamps[0]) * SECONDS[unit])
    if not _LIKELY_HZ[0] <= rate_hz <= _LIKELY_HZ[1]:
        if not named:
            return None
        doubts = (f"{rate_hz:.4g} Hz are unusual: is the unit {unit}?",)
    if back:
        k = int(np.argmax(steps < 0.0)) + 1
        doubts += (f"it goes back at sample {k}, from {stamps[k - 1]:.10g} to {stamps[k]:.10g}",)
    return Clock(unit, rate_hz, int((steps == 0.0).sum()), doubts)


def own_clock(name: str, table: Table, clocks: dict[str, Clock]) -> str | None:
    """Return the clock of a column: with the longest common part of the name, or just before it."""
    order, length = list(table.columns), len(table.columns[name].values)
    same = [clock for clock in clocks if len(table.columns[clock].values) == length]
    same = [clock for clock in same if is_time(clock)] or same[:1]
    places = {order.index(clock) for clock in same if " + " not in clock}
    in_turn = not places & {place + 1 for place in places}

    def nearness(clock: str) -> tuple[int, int]:
        shared = len(commonprefix([re.split("[./]", clock), re.split("[./]", name)]))
        distance = order.index(name) - order.index(clock)
        return shared, -distance if in_turn and distance > 0 else -len(order)

    return max(same, key=nearness, default=None)
