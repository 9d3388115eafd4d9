"""Time stamps of a recording: order, repeats, and whether its duration is plausible."""

from collections.abc import Mapping
from typing import Any, NamedTuple

import numpy as np

from fprc.errors import LogError
from fprc.logs.resample import points_of
from fprc.logs.source import Source

#: Seconds per unit of time, coarsest first.
SECONDS = {"min": 60.0, "s": 1.0, "ms": 1e-3, "us": 1e-6, "ns": 1e-9}
#: Range of plausible sample rates, Hz.
LIKELY_HZ = (10.0, 20000.0)
#: Most samples per channel that resampling may process.
MOST_POINTS = 5_000_000


class Recording(NamedTuple):
    """Channels at their original time stamps, in the units of a raw log."""

    time_s: np.ndarray  #: time stamps, increasing, 0 at the first sample kept
    channels: dict[str, np.ndarray]
    start_s: float  #: time stamp of the first sample kept, on the file's clock
    samples: np.ndarray  #: for each time stamp, the index of its first sample in the file
    #: ``unordered_samples``, ``repeated_samples``: counts in the file; ``repeated``: how repeated
    #: time stamps are merged, ``first`` or ``mean``
    corrections: dict[str, Any]


def read_clock(source: Source, time: Mapping[str, Any], stamps: np.ndarray) -> Recording:
    """Return a recording without channels, its time stamps sorted.

    A time stamp that is repeated, and not to be merged with ``first``, stands there for each of
    its samples.

    Parameters
    ----------
    time : Mapping
        ``column``, ``unit`` (by default s), and how to treat ``repeated`` time stamps (``first``,
        ``mean``) and ``unordered`` ones (``sort``).

    Raises
    ------
    LogError
        Time stamps are not finite, or are repeated or unordered and ``time`` does not say how
        to treat them.
    """
    where = f"{source.path}: time: {time.get('column')}"
    bad = np.flatnonzero(~np.isfinite(stamps))
    if bad.size:
        raise LogError(
            f"{where}: {source.sample(bad[0])} is {stamps[bad[0]]}; not finite in all: "
            f"{bad.size}; fill them in, delete those rows, or give time.rate_hz"
        )
    latest = np.maximum.accumulate(stamps)
    late = np.flatnonzero(stamps < latest)
    order = np.argsort(stamps, kind="stable") if late.size else np.arange(len(stamps))
    ordered = stamps[order]
    fresh = np.append(True, ordered[1:] != ordered[:-1])
    repeated = order[~fresh]
    problems = _disorder(source, time, stamps, late, repeated)
    if problems:
        raise LogError("\n".join(f"{where}: {problem}" for problem in problems))
    corrections = {
        "unordered_samples": int(late.size),
        "repeated_samples": int(repeated.size),
        "repeated": time["repeated"] if repeated.size else None,
    }
    if time.get("repeated") != "mean":
        order = order[fresh]
    factor = SECONDS[time.get("unit", "s")]
    with np.errstate(over="ignore"):  # ``refuse_length`` rejects the overflow
        # subtract before converting, or stamps counted from 1970 would lose digits
        since_s = (stamps[order] - ordered[0]) * factor
        return Recording(since_s, {}, float(ordered[0] * factor), order, corrections)


def _disorder(
    source: Source,
    time: Mapping[str, Any],
    stamps: np.ndarray,
    late: np.ndarray,
    repeated: np.ndarray,
) -> list[str]:
    """Return an error text for unordered and for repeated samples that ``time`` does not allow."""
    total, problems = len(stamps), []
    if late.size and not time.get("unordered"):
        k = int(late[0])
        before = int(np.argmax(stamps[:k]))
        problems.append(
            f"{late.size} of {total} samples are out of order; the first is "
            f"{source.sample(k)} at {stamps[k]:.16g}, after {source.sample(before)} at "
            f"{stamps[before]:.16g}; set time.unordered: sort if the time stamps are right and "
            "the samples were only written out of order; repair the clock if it was set back or "
            "restarted"
        )
    if repeated.size and not time.get("repeated"):
        k = int(repeated.min())
        problems.append(
            f"{repeated.size} of {total} samples repeat an earlier time stamp; the first is "
            f"{source.sample(k)} at {stamps[k]:.16g}; set time.repeated: first to keep the "
            "first sample of each time stamp, or mean to average them; or give time.rate_hz"
        )
    return problems


def likely_rate(step: float) -> tuple[float, str] | None:
    """Guess the rate in Hz and the unit of a clock from its step; None if no unit is plausible."""
    for unit in ("s", "ms", "us", "ns"):
        rate_hz = 1.0 / max(step * SECONDS[unit], 1e-12)
        if LIKELY_HZ[0] <= rate_hz <= LIKELY_HZ[1]:
            return rate_hz, unit
    return None


def other_unit(time_s: np.ndarray, unit: str) -> str | None:
    """Suggest a unit that makes the rate plausible; None if it already is or no unit does."""
    step_s = float(np.median(np.diff(time_s)))
    guess = likely_rate(step_s / SECONDS[unit])
    if guess is None or LIKELY_HZ[0] * step_s <= 1.0 <= LIKELY_HZ[1] * step_s:
        return None
    return (
        f"a step of {step_s:.4g} s is unusual; in {guess[1]} the rate would be "
        f"{guess[0]:.4g} Hz: set time.unit: {guess[1]} if that is right"
    )


def refuse_length(
    source: Source, time: Mapping[str, Any], recording: Recording, rate_hz: float
) -> None:
    """Check, before resampling, that a recording is neither too short nor too long.

    Raises
    ------
    LogError
        It is too short or too long; the message names the sample at which the clock jumped, or
        the unit that gives a plausible rate.
    """
    time_s = recording.time_s
    duration_s = float(time_s[-1])
    where = f"{source.path}: time: {time.get('column') or 'rate_hz'}"
    with np.errstate(all="ignore"):
        points = points_of(time_s, rate_hz)
        remedy = _remedy(source, time, recording)
    if duration_s * rate_hz < 1.0:
        raise LogError(
            f"{where}: {duration_s:.4g} s are shorter than one sample at sample_rate_hz = "
            f"{rate_hz:g}; keep more with start_s and end_s{remedy}"
        )
    if not points <= MOST_POINTS:  # NaN: the duration is infinite
        raise LogError(
            f"{where}: {duration_s:.4g} s at sample_rate_hz = {rate_hz:g} need {points:.2g} "
            f"samples in resampling; the limit is {MOST_POINTS:.2g} samples; shorten it with "
            f"start_s and end_s{remedy}"
        )


def _remedy(source: Source, time: Mapping[str, Any], recording: Recording) -> str:
    """Return what may be wrong with the clock, for the end of a message."""
    if not time.get("column"):
        return "; or correct time.rate_hz"
    unit, steps_s = time["unit"], np.diff(recording.time_s)
    hint = ""
    k = int(np.argmax(steps_s))
    if len(steps_s) > 1 and steps_s[k] > 0.5 * steps_s.sum():
        before, after = recording.samples[[k, k + 1]]
        at = (recording.start_s + recording.time_s[[k, k + 1]]) / SECONDS[unit]
        hint = (
            f"; the clock jumps from {at[0]:.10g} {unit} at {source.sample(before)} to "
            f"{at[1]:.10g} {unit} at {source.sample(after)}: repair it there"
        )
    suggestion = other_unit(recording.time_s, unit)
    return f"{hint}; {suggestion}" if suggestion else hint
