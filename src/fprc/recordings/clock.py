"""Time stamps of a recording: their order, and whether its duration is plausible."""

from collections.abc import Mapping
from typing import Any, NamedTuple

import numpy as np

from fprc.errors import LogError
from fprc.recordings.resample import points_of
from fprc.recordings.source import Source

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
    first: int  #: index of the first sample kept, in the file


def read_clock(source: Source, time: Mapping[str, Any], stamps: np.ndarray) -> Recording:
    """Return a recording without channels.

    Parameters
    ----------
    time : Mapping
        ``column``, ``unit`` (by default s).

    Raises
    ------
    LogError
        A time stamp is not finite, or does not come after the one before.
    """
    where = f"{source.path}: time: {time.get('column')}"
    bad = np.flatnonzero(~np.isfinite(stamps))
    if bad.size:
        raise LogError(
            f"{where}: {source.sample(bad[0])} is {stamps[bad[0]]}; not finite in all: "
            f"{bad.size}; fill them in, delete those rows, or give time.rate_hz"
        )
    late = 1 + np.flatnonzero(stamps[1:] <= stamps[:-1])
    if late.size:
        k = int(late[0])
        raise LogError(
            f"{where}: {source.sample(k)} at {stamps[k]:.16g} does not come after "
            f"{stamps[k - 1]:.16g}; such samples in all: {late.size}; repair the clock if it was "
            "set back or restarted; sort the samples if they were only written out of order; if "
            "they repeat a time stamp, keep one of each, or give time.rate_hz"
        )
    factor = SECONDS[time.get("unit", "s")]
    with np.errstate(over="ignore"):  # ``refuse_length`` rejects the overflow
        # subtract before converting, or stamps counted from 1970 would lose digits
        since_s = (stamps - stamps[0]) * factor
        return Recording(since_s, {}, float(stamps[0] * factor), 0)


def likely_rate(step: float, stated: str = "s") -> tuple[float, str] | None:
    """Guess the rate in Hz and the unit of a clock from its step; None if no unit is plausible.

    The stated unit is tried first.
    """
    for unit in (stated, "s", "ms", "us", "ns"):
        rate_hz = 1.0 / max(step * SECONDS[unit], 1e-12)
        if LIKELY_HZ[0] <= rate_hz <= LIKELY_HZ[1]:
            return rate_hz, unit
    return None


@np.errstate(all="ignore")  # steps of an implausible clock may overflow
def oddities(source: Source, time: Mapping[str, Any], recording: Recording) -> list[str]:
    """Say what is odd about the clock of a recording.

    That is a jump over more than half of the recording, and a unit that makes the rate implausible
    where another does not.
    """
    if not time.get("column"):
        return []
    unit, steps_s = time["unit"], np.diff(recording.time_s)
    found = []
    k = int(np.argmax(steps_s))
    if len(steps_s) > 1 and steps_s[k] > 0.5 * steps_s.sum():
        before = recording.first + k
        at = (recording.start_s + recording.time_s[[k, k + 1]]) / SECONDS[unit]
        found.append(
            f"the clock jumps from {at[0]:.10g} {unit} at {source.sample(before)} to "
            f"{at[1]:.10g} {unit} at {source.sample(before + 1)}: repair it there"
        )
    step_s = float(np.median(steps_s))
    rate_hz, likely = likely_rate(step_s / SECONDS[unit], unit) or (0.0, unit)
    if likely != unit:
        found.append(
            f"a step of {step_s:.4g} s is unusual; in {likely} the rate would be {rate_hz:.4g} Hz: "
            f"set time.unit: {likely} if that is right"
        )
    return found


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
    column = time.get("column")
    where = f"{source.path}: time{f': {column}' if column else '.rate_hz'}"
    remedy = "".join(f"; {oddity}" for oddity in oddities(source, time, recording))
    with np.errstate(all="ignore"):
        points = points_of(time_s, rate_hz)
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
