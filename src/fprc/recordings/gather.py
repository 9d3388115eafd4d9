"""Select the channels of a recording from a table, and resample them to a uniform time grid."""

import math
from collections.abc import Mapping
from typing import NamedTuple

import numpy as np

from fprc.channels import unit_of
from fprc.errors import LogError
from fprc.limits import LARGEST
from fprc.recordings.clock import pauses_of, rate_of
from fprc.recordings.importing import ImportMap
from fprc.recordings.names import SECONDS, factor_of
from fprc.recordings.table import Table

#: Most samples per channel that resampling may process.
MOST_POINTS = 5_000_000

#: Edges of pass band and stop band, as shares of the new Nyquist frequency.
PASS, STOP = 0.8, 1.0
#: Attenuation in the stop band, dB.
STOP_DB = 70.0
#: Half the length of the low-pass, in new samples (Kaiser's formula).
_HALF_TAPS = (STOP_DB - 7.95) / (2.285 * math.pi * (STOP - PASS)) / 2.0


class Recording(NamedTuple):
    """Channels at their original time stamps, in the units of a raw log."""

    time_s: np.ndarray  #: time stamps, increasing, 0 at the first sample kept
    channels: dict[str, np.ndarray]
    start_s: float = 0.0  #: time stamp of the first sample kept, on the file's clock
    since_s: float = 0.0  #: of the first sample kept, since the first one of the file
    notes: tuple[str, ...] = ()  #: samples that were left out, and gaps that will be filled


@np.errstate(all="ignore")  # numbers that overflow are refused
def gather(table: Table, mapping: ImportMap) -> Recording:
    """Select, convert and cut the channels of a file.

    LogError lists every column that is missing; or lengths differ, time does not increase, a value
    is not finite or too large, or nothing is left.
    """
    path, specs, time = table.path, mapping.columns, mapping.time
    asked = {name: spec["column"] for name, spec in specs.items()}
    asked |= {f"{name}.time": spec["time"] for name, spec in specs.items() if "time" in spec}
    asked |= {"time": time.column} if time.column else {}
    picked, problems = {}, []
    for name, column in asked.items():
        try:
            picked[name] = table.pick(column).values
        except LogError as error:
            problems.append(f"{path}: {name}: {column}: {error}")
    if problems:
        raise LogError("\n".join(problems))
    own = [name for name in specs if f"{name}.time" in picked]
    shared = [name for name in specs if name not in own]
    lengths = {name: len(picked[name]) for name in (*shared, "time") if name in picked}
    if len(set(lengths.values())) > 1:
        unequal = ", ".join(f"{asked[name]} {length}" for name, length in lengths.items())
        raise LogError(
            f"{path}: columns have unequal numbers of samples ({unequal}); name the clock of each, "
            "as `time: column`"
        )
    count = max(lengths.values() or map(len, picked.values()))
    stamps = np.arange(count) / time.rate_hz if time.rate_hz else picked["time"]
    rows = np.array([stamps, *(picked[name] for name in shared)])
    usable = np.isfinite(rows if mapping.skip_unusable else rows[:1]).all(axis=0)
    lost = [f"lines that are no samples: {len(table.unusable)}: {'; '.join(table.unusable[:3])}"]
    lost = lost[: len(table.unusable)]
    if not usable.all():
        first = table.sample(int(np.argmin(usable)))
        lost.append(f"samples with missing values, the first {first}; in all: {np.sum(~usable)}")
    if lost and not mapping.skip_unusable:
        raise LogError(
            f"{path}: {'; '.join(lost)}; repair them or the clock, or leave them out with "
            "`skip_unusable: true` in the map"
        )
    notes = [f"left out: {line}" for line in lost]
    numbers = np.flatnonzero(usable)
    rows = rows[:, numbers]
    begins = np.flatnonzero(np.diff(rows[0], prepend=np.nan) != 0.0)
    if time.repeated and len(begins) < len(numbers):
        taken = {"first": "the first", "mean": "their mean"}[time.repeated]
        repeats, counts = len(numbers) - len(begins), np.diff(begins, append=len(numbers))
        notes.append(f"{repeats} samples repeat a time stamp; {taken} of each was taken")
        means = np.add.reduceat(rows, begins, axis=1) / counts
        numbers, rows = numbers[begins], rows[:, begins]
        rows[1:] = rows[1:] if time.repeated == "first" else means[1:]
    stamps, values = rows[0], dict(zip(shared, rows[1:], strict=True))
    late = 1 + np.flatnonzero(np.diff(stamps) <= 0.0)
    if late.size:
        k = int(late[0])
        raise LogError(
            f"{path}: time: {time.column}: {table.sample(numbers[k])} at {stamps[k]:.16g} does not "
            f"come after {stamps[k - 1]:.16g}; such samples in all: {late.size}; give "
            "time.repeated, first or mean, or time.rate_hz, or repair the clock"
        )
    for name in own:
        clock, given = picked[f"{name}.time"], picked[name]
        known = np.isfinite(clock) & np.isfinite(given) if len(clock) == len(given) else None
        if known is None or not known.any() or (np.diff(clock[known]) < 0.0).any():
            raise LogError(f"{path}: channels.{name}.time is no clock of its column")
        values[name] = np.interp(stamps, clock[known], given[known], left=np.nan, right=np.nan)
    # subtract before converting, or stamps counted from 1970 would lose digits
    since_s = (stamps - stamps[:1]) * SECONDS[time.unit]
    last_s = np.inf if mapping.end_s is None else mapping.end_s
    # 1e-9: the time stamps are rounded
    kept = (since_s >= mapping.start_s - 1e-9) & (since_s <= last_s + 1e-9)
    for name in own:  # their own clock may begin later or end earlier
        kept &= np.isfinite(values[name])
    if kept.sum() < 2:
        raise LogError(
            f"{path}: {kept.sum()} samples lie from {mapping.start_s:g} s to {last_s:g} s; "
            f"{len(since_s)} are usable; correct start_s and end_s"
        )
    channels = {}
    for name, spec in specs.items():
        given, factor = values[name][kept], factor_of(spec["unit"], unit_of(name)) or 1.0
        channels[name] = (given * spec["scale"] + spec["offset"]) * factor
        bad = np.flatnonzero(~(np.abs(channels[name]) <= LARGEST))  # NaN is neither
        if bad.size:
            raise LogError(
                f"{path}: {name}: {asked[name]}: {table.sample(numbers[kept][bad[0]])} is "
                f"{given[bad[0]]:g}; not finite or beyond {LARGEST:g} in all: {bad.size}; correct "
                "the unit, cut them off with start_s and end_s, or give `skip_unusable: true`"
            )
    first_s = float(since_s[kept][0])
    time_s, start_s = since_s[kept] - first_s, float(stamps[0] * SECONDS[time.unit]) + first_s
    gaps, steps = pauses_of(time_s), np.diff(time_s)
    if gaps.size:
        missing = np.maximum(np.round(steps[gaps] * rate_of(time_s)) - 1.0, 1.0).sum()
        k = gaps[steps[gaps].argmax()]
        notes.append(
            f"gaps in the clock, filled by linear interpolation: {gaps.size}, about {missing:.0f} "
            f"samples missing, the longest from {time_s[k]:.4g} to {time_s[k + 1]:.4g} s"
        )
    return Recording(time_s, channels, start_s, first_s, tuple(notes))


@np.errstate(all="ignore")  # too many points are refused
def resample(
    time_s: np.ndarray, channels: Mapping[str, np.ndarray], rate_hz: float, path: object = ""
) -> tuple[np.ndarray, dict[str, np.ndarray]]:
    """Return times and channels on a uniform grid that begins at the first sample.

    Where the grid coincides with the recording's time stamps, values are copied. Elsewhere they
    are interpolated linearly, which does not overshoot at held values and gaps; a sine of
    f Hz, sampled at s Hz, loses at most (pi f / s)^2 / 2 of its amplitude. For a lower rate, this
    is done at a multiple of it, at least that of the recording; then a linear-phase FIR low-pass,
    applied without delay to the recording extended by point reflection, which is flat up to 0.8 of
    the new Nyquist frequency and at -70 dB above it, and every n-th sample is kept.
    LogError: it is shorter than a sample, or takes more than ``MOST_POINTS``.
    """
    span_s, ratio = float(time_s[-1] - time_s[0]), rate_of(time_s) / rate_hz
    factor, aligned = 1, False  # how much finer the grid of the low-pass is; 1: there is none
    if 0.0 < ratio < 1e9:  # else the time stamps are nearly equal
        factor = max(round(ratio), 1)
        even_s = time_s[0] + np.arange(len(time_s)) / (factor * rate_hz)
        aligned = bool(np.abs(time_s - even_s).max() <= 1e-3 / (factor * rate_hz))
        if not aligned:
            # up to 1.01 it is the same rate, with clock error; above, where values are
            # interpolated, the grid is twice as fine, so that less is lost
            factor = 1 if ratio <= 1.01 else math.ceil(2.0 * ratio)
    points = factor * (span_s * rate_hz + 2.0 * _HALF_TAPS)
    if not (span_s * rate_hz >= 1.0 and points <= MOST_POINTS and ratio < 1e9):
        k = int(np.argmax(np.diff(time_s)))
        raise LogError(
            f"{path}: {span_s:.4g} s at sample_rate_hz = {rate_hz:g} are {span_s * rate_hz:.4g} "
            f"samples, {points:.2g} while resampled; must be from 1 to {MOST_POINTS:.2g}: check "
            f"the clock, whose longest step is from {time_s[k]:.10g} to {time_s[k + 1]:.10g} s"
        )
    samples = math.floor(span_s * rate_hz + 1e-6) + 1
    fine_s = time_s[0] + np.arange((samples - 1) * factor + 1) / (factor * rate_hz)
    resampled = {}
    for name, values in channels.items():
        fine = values[: len(fine_s)] if aligned else np.interp(fine_s, time_s, values)
        resampled[name] = np.array(fine) if factor == 1 else _lowpass(fine, factor)[::factor]
    return time_s[0] + np.arange(samples) / rate_hz, resampled


def _lowpass(values: np.ndarray, factor: int) -> np.ndarray:
    from scipy.signal import fftconvolve, firwin, kaiser_beta  # slow to import

    half = math.ceil(_HALF_TAPS * factor) + 1
    edge = 0.5 * (PASS + STOP) / factor
    taps = firwin(2 * half + 1, edge, window=("kaiser", kaiser_beta(STOP_DB)))
    padded = np.pad(values, half, mode="reflect", reflect_type="odd")
    return fftconvolve(padded, taps, mode="valid")
