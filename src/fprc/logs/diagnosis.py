"""Diagnosis of a recording before it is resampled: clock, channels, sealed chamber."""

from collections.abc import Mapping
from itertools import combinations
from typing import Any

import numpy as np

from fprc.logs.clock import NO_CORRECTIONS
from fprc.logs.quality import runs
from fprc.logs.resample import rate_of
from fprc.logs.sealed_chamber import SHORT_S, fit_sealed

#: Longest time that a working channel may keep one value, s.
FROZEN_S = 2.0
#: A clock step longer than this many median steps is a gap.
GAP_PERIODS = 1.5
#: A channel is clipped if its extreme occurs this many times as often as the levels next to it.
CLIPPED_RATIO = 12.0
#: A sealed chamber leaks if its pressure falls faster, kPa/min. The fit can detect half of this.
LEAK_KPA_PER_MIN = 2.0


def diagnose(
    time_s: np.ndarray,
    channels: Mapping[str, np.ndarray],
    corrections: Mapping[str, Any] = NO_CORRECTIONS,
) -> dict[str, Any]:
    """Measure clock, channels and sealed chamber of a recording.

    Parameters
    ----------
    time_s : ndarray
        Time stamps, increasing.
    channels : Mapping
        Arrays of the same length, in the units of their names.
    corrections : Mapping
        Corrections made to the file's clock, see ``fprc.logs.clock.Clock``.

    Returns
    -------
    dict
        ``samples``, ``duration_s``; ``clock``, with ``corrections``; ``channels``, each with its
        range, the rate of new values, ``held_samples`` (None unless sample-and-hold),
        ``step`` (None unless quantised), ``frozen`` and ``at_extreme``; ``identical`` pairs;
        ``sealed``, leak and re-fills of ``p_o_kpa``, or None.
    """
    clock = {**_clock(time_s), **corrections}
    diagnoses = {name: _channel(time_s, values, clock) for name, values in channels.items()}
    pairs = [[a, b] for a, b in combinations(channels, 2) if (channels[a] == channels[b]).all()]
    return {
        "samples": len(time_s),
        "duration_s": float(time_s[-1] - time_s[0]),
        "clock": clock,
        "channels": diagnoses,
        "identical": pairs,
        "sealed": fit_sealed(time_s, channels),
    }


def _clock(time_s: np.ndarray) -> dict[str, Any]:
    steps = np.diff(time_s)
    median = float(np.median(steps))
    gaps = np.flatnonzero(steps > GAP_PERIODS * median)
    # a gap is no jitter
    late = steps[steps <= GAP_PERIODS * median] - median
    low, high = np.percentile(late, [1, 99])
    return {
        "mean_hz": float(1.0 / steps.mean()),
        "median_hz": 1.0 / median,
        "running_hz": rate_of(time_s),
        "jitter_p1_s": float(low),
        "jitter_p99_s": float(high),
        "jitter_max_s": float(np.abs(late).max()),
        "gaps": [
            {
                "from_s": float(time_s[k]),
                "to_s": float(time_s[k + 1]),
                "missing_samples": max(int(round(steps[k] / median)) - 1, 1),
            }
            for k in gaps
        ],
    }


def _channel(time_s: np.ndarray, values: np.ndarray, clock: Mapping[str, Any]) -> dict[str, Any]:
    begins, lengths = runs(values)
    step = _step(values)
    held = None if step else _held(lengths)
    longest = max(FROZEN_S * clock["median_hz"], 20.0 * (held or 1))
    frozen = np.flatnonzero(lengths > longest)
    extremes = (_at_extreme(values, begins, lengths, held or 1, side) for side in ("low", "high"))
    return {
        "lowest": float(values.min()),
        "highest": float(values.max()),
        "new_values_hz": float((len(begins) - 1) / (time_s[-1] - time_s[0])),
        "held_samples": held,
        "step": step,
        "frozen": [
            {
                "from_s": float(time_s[begins[k]]),
                "to_s": float(time_s[begins[k] + lengths[k] - 1]),
                "value": float(values[begins[k]]),
            }
            for k in frozen
        ],
        "at_extreme": [extreme for extreme in extremes if extreme],
    }


def _step(values: np.ndarray) -> float | None:
    """Return the resolution of a quantised channel; None if it cannot be seen."""
    changes = np.abs(np.diff(values))
    changes = changes[changes > 1e-12 * np.ptp(values)]  # less is rounding
    if len(changes) < 10 or len(changes) > 0.9 * (len(values) - 1):
        return None  # constant, or nearly every sample is new: quantisation is negligible
    smallest = np.median(changes[changes < 1.5 * changes.min()])
    multiples = changes / smallest
    whole = np.abs(multiples - np.round(multiples)) < 0.05
    return float(smallest) if whole.mean() > 0.95 and (multiples < 2.5).mean() > 0.5 else None


def _held(lengths: np.ndarray) -> int | None:
    """Return the hold time of a sample-and-hold channel in samples; None if it is irregular."""
    inner = lengths[1:-1]
    if len(inner) < 5:
        return None
    typical = int(np.median(inner))
    # a new value may equal the last one, and the slower clock has jitter
    multiples = inner / typical
    regular = (np.abs(inner - typical) <= typical // 4) | (multiples == np.round(multiples))
    return typical if typical >= 2 and regular.mean() >= 0.8 else None


def _at_extreme(
    values: np.ndarray, begins: np.ndarray, lengths: np.ndarray, held: int, side: str
) -> dict[str, Any] | None:
    """Return where a channel is clipped at its lowest or highest value; None if it is not.

    A slow, quantised sine takes its highest level up to five times as often as the levels
    below it, hence the threshold of twelve.
    """
    levels, counts = np.unique(values, return_counts=True)
    if len(levels) < 5:
        return None
    k, beside = (0, slice(1, 11)) if side == "low" else (-1, slice(-11, -1))
    here = np.flatnonzero((values[begins] == levels[k]) & (lengths >= 3 * held))
    if counts[k] < CLIPPED_RATIO * counts[beside].mean() or not here.size:
        return None
    return {
        "side": side,
        "value": float(levels[k]),
        "share": float(counts[k] / len(values)),
        "stretches": [[int(begins[i]), int(begins[i] + lengths[i] - 1)] for i in here],
    }


def describe(diagnosis: Mapping[str, Any], units: Mapping[str, str]) -> list[str]:
    """Return a diagnosis as lines of text.

    Parameters
    ----------
    diagnosis : Mapping
        Result of ``diagnose``.
    units : Mapping
        Unit to print for each channel; empty if it holds a quantity other than its name says.
    """
    clock, sealed = diagnosis["clock"], diagnosis["sealed"]
    lines = [
        f"{diagnosis['samples']} samples over {diagnosis['duration_s']:.6g} s, mean rate "
        f"{clock['mean_hz']:.6g} Hz",
        *_describe_clock(clock),
    ]
    for name, channel in diagnosis["channels"].items():
        lines += [f"{name}: {text}" for text in _describe_channel(channel, units[name], clock)]
    lines += [f"{a} and {b}: identical, sample by sample" for a, b in diagnosis["identical"]]
    leak = _describe_leak(sealed, diagnosis, units["p_o_kpa"]) if sealed else []
    return lines + [f"p_o_kpa: {text}" for text in leak]


def _describe_clock(clock: Mapping[str, Any]) -> list[str]:
    lines = []
    period_s = 1.0 / clock["median_hz"]
    jitter = max(-clock["jitter_p1_s"], clock["jitter_p99_s"]) / period_s
    if jitter < 1e-3:
        lines.append("clock: even, jitter below 0.1 % of a period")
    else:
        lines.append(
            f"clock: 98 % of the steps differ from the median {1e3 * period_s:.4g} ms by "
            f"{1e3 * clock['jitter_p1_s']:+.2g} to {1e3 * clock['jitter_p99_s']:+.2g} ms "
            f"({jitter:.0%} of a period)"
        )
    if clock["unordered_samples"]:
        lines.append(
            f"clock: {_count(clock['unordered_samples'], 'sample')} out of order; sorted by time"
        )
    if clock["repeated_samples"]:
        kept = {"first": "kept the first of each", "mean": "averaged those of each"}
        lines.append(
            f"clock: {_count(clock['repeated_samples'], 'sample')} repeated an earlier time stamp; "
            f"{kept[clock['repeated']]} time stamp"
        )
    if clock["gaps"]:
        longest = max(clock["gaps"], key=lambda gap: gap["to_s"] - gap["from_s"])
        missing = sum(gap["missing_samples"] for gap in clock["gaps"])
        lines.append(
            f"clock: {_count(len(clock['gaps']), 'gap')}, about {missing} samples missing; the "
            f"longest from {longest['from_s']:.4g} to {longest['to_s']:.4g} s; filled by linear "
            "interpolation"
        )
    return lines


def _describe_channel(channel: Mapping[str, Any], unit: str, clock: Mapping[str, Any]) -> list[str]:
    def value(number: float) -> str:
        return f"{number:.4g} {unit}".rstrip()

    if channel["lowest"] == channel["highest"]:
        return [f"constant at {value(channel['lowest'])}"]
    lines = [
        f"{channel['lowest']:.4g} to {value(channel['highest'])}, "
        f"{channel['new_values_hz']:.4g} new values a second"
    ]
    if channel["held_samples"]:
        lines.append(
            f"sample-and-hold: a new value every {channel['held_samples']} samples, effectively "
            f"{clock['median_hz'] / channel['held_samples']:.4g} Hz"
        )
    if channel["step"]:
        lines.append(f"quantised in steps of {value(channel['step'])}")
    if channel["frozen"]:
        longest = max(channel["frozen"], key=lambda stretch: stretch["to_s"] - stretch["from_s"])
        lines.append(
            f"frozen or at rest in {_count(len(channel['frozen']), 'stretch')}, the longest "
            f"from {longest['from_s']:.4g} to {longest['to_s']:.4g} s at {value(longest['value'])}"
        )
    for extreme in channel["at_extreme"]:
        lines.append(
            f"{extreme['share']:.1%} of the samples are exactly the {extreme['side']}est value, "
            f"{value(extreme['value'])}, in {_count(len(extreme['stretches']), 'stretch')}: "
            "clipped, or held there"
        )
    return lines


def _describe_leak(sealed: Mapping[str, Any], diagnosis: Mapping[str, Any], unit: str) -> list[str]:
    slope, channel = sealed["slope_kpa_per_min"], diagnosis["channels"]["p_o_kpa"]
    if slope is None:
        return [
            f"{sealed['relative_to']} explains only {sealed['explained']:.0%} of its variance, too "
            "little for a sealed chamber; leak and re-fills are not evaluated"
        ]
    limit = LEAK_KPA_PER_MIN if unit else 0.05 * (channel["highest"] - channel["lowest"])
    rate = f"{abs(slope):.2g} {unit}".rstrip()
    lines = []
    at_equal = f"at equal {sealed['relative_to']} it"
    if slope < -limit:
        short = diagnosis["duration_s"] < SHORT_S
        doubt = "; hysteresis can cause this in under a minute" if short else ""
        lines.append(f"leaks: {at_equal} falls by about {rate} a minute{doubt}")
    elif slope > limit:
        lines.append(f"{at_equal} rises by about {rate} a minute: warming, or inflow")
    for noun, sign in (("re-fill", 1.0), ("sudden loss", -1.0)):
        steps = [step for step in sealed["steps"] if sign * step["height_kpa"] > 0.0]
        if steps:
            heights = [
                f"{s['height_kpa']:+.3g} {unit}".rstrip() + f" at {s['at_s']:.1f} s" for s in steps
            ]
            more = ", ..." if len(heights) > 6 else ""
            lines.append(f"{_count(len(steps), noun)}: {', '.join(heights[:6])}{more}")
    return lines


def _count(number: int, noun: str) -> str:
    plural = {"stretch": "stretches", "sudden loss": "sudden losses"}.get(noun, f"{noun}s")
    return f"{number} {noun if number == 1 else plural}"
