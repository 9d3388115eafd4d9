"""Diagnosis of a recording before it is resampled: clock, channels, sealed chamber."""

from collections.abc import Iterator, Mapping, Sequence
from itertools import combinations
from typing import Any

import numpy as np

from fprc.logs.quality import runs
from fprc.logs.sealed_chamber import SHORT_S, fit_sealed
from fprc.recordings.clock import pauses_of, rate_of
from fprc.recordings.gather import Recording

#: What a stretch of a channel may be, in words.
MARKS = {"frozen": "frozen or at rest", "clipped": "clipped or held at an extreme"}
#: A channel is clipped if its extreme occurs this many times as often as the levels next to it.
CLIPPED_RATIO = 12.0
#: A sealed chamber leaks if its pressure falls faster, kPa/min. The fit can detect half of this.
#: ``quality.leak_kpa_per_min`` is higher: it fails a log, and this only informs a person.
LEAK_KPA_PER_MIN = 2.0


def diagnose(recording: Recording, *, quality: Mapping[str, Any]) -> dict[str, Any]:
    """Measure clock, channels and sealed chamber of a recording.

    Parameters
    ----------
    quality : Mapping
        ``gap_periods`` and ``stuck_s`` of the section ``quality`` of the configuration.

    Returns
    -------
    dict
        ``samples``, ``duration_s``; ``clock``; ``channels``, each with its
        range, the rate of new values, and the stretches of each of ``MARKS``; ``identical`` pairs;
        ``sealed``, leak of ``p_o_kpa``, or None.
    """
    time_s, channels = recording.time_s, recording.channels
    clock = _clock(time_s, quality["gap_periods"])
    longest = max(quality["stuck_s"] * clock["median_hz"], 20.0)  # of a slow log too
    diagnoses = {name: _channel(time_s, values, longest) for name, values in channels.items()}
    pairs = [[a, b] for a, b in combinations(channels, 2) if (channels[a] == channels[b]).all()]
    return {
        "samples": len(time_s),
        "duration_s": float(time_s[-1] - time_s[0]),
        "clock": clock,
        "channels": diagnoses,
        "identical": pairs,
        "sealed": fit_sealed(time_s, channels),
    }


def _clock(time_s: np.ndarray, gap_periods: float) -> dict[str, Any]:
    steps = np.diff(time_s)
    median = float(np.median(steps))
    gaps, rate_hz = pauses_of(time_s, gap_periods), rate_of(time_s)
    late = np.delete(steps, gaps) - median  # a gap is no jitter
    return {
        "mean_hz": float(1.0 / steps.mean()),
        "median_hz": 1.0 / median,
        "running_hz": rate_hz,
        "jitter_s": float(np.abs(np.percentile(late, [1, 99])).max()),
        "gaps": [
            {
                "from_s": float(time_s[k]),
                "to_s": float(time_s[k + 1]),
                "missing_samples": max(round(float(steps[k] * rate_hz)) - 1, 1),
            }
            for k in gaps
        ],
    }


def _channel(time_s: np.ndarray, values: np.ndarray, longest: float) -> dict[str, Any]:
    begins, lengths = runs(values)
    marked = {"frozen": lengths > longest, "clipped": _clipped(values, begins, lengths)}
    stretches = {
        kind: [
            {"from_s": float(time_s[first]), "to_s": float(time_s[first + length - 1])}
            for first, length in zip(begins[which], lengths[which], strict=True)
        ]
        for kind, which in marked.items()
    }
    return {
        "lowest": float(values.min()),
        "highest": float(values.max()),
        "new_values_hz": float((len(begins) - 1) / (time_s[-1] - time_s[0])),
        **stretches,
    }


def _clipped(values: np.ndarray, begins: np.ndarray, lengths: np.ndarray) -> np.ndarray:
    """Return which runs of equal values are at the lowest or highest one, if it clips the channel.

    A slow, quantised sine takes its highest level up to five times as often as the levels
    below it, hence the threshold of twelve.
    """
    levels, counts = np.unique(values, return_counts=True)
    if len(levels) < 5:
        return np.zeros(len(begins), bool)
    clipping = [
        levels[k]
        for k, beside in ((0, slice(1, 11)), (-1, slice(-11, -1)))
        if counts[k] >= CLIPPED_RATIO * counts[beside].mean()
    ]
    return np.isin(values[begins], clipping) & (lengths >= 3)


def describe(diagnosis: Mapping[str, Any], units: Mapping[str, str]) -> list[str]:
    """Return a diagnosis as lines of text.

    Parameters
    ----------
    diagnosis : Mapping
        Result of ``diagnose``.
    units : Mapping
        Unit to print for each channel; empty if it holds a quantity other than its name says.
    """
    clock = diagnosis["clock"]
    units = {name: f" {unit}".rstrip() for name, unit in units.items()}
    lines = [
        f"{diagnosis['samples']} samples over {diagnosis['duration_s']:.6g} s, mean rate "
        f"{clock['mean_hz']:.6g} Hz"
    ]
    lines += [f"clock: {text}" for text in _describe_clock(clock)]
    for name, channel in diagnosis["channels"].items():
        lines += [f"{name}: {text}" for text in _describe_channel(channel, units[name])]
    lines += [f"{a} and {b}: identical, sample by sample" for a, b in diagnosis["identical"]]
    if diagnosis["sealed"]:
        lines += [f"p_o_kpa: {text}" for text in _describe_leak(diagnosis, units["p_o_kpa"])]
    return lines


def _describe_clock(clock: Mapping[str, Any]) -> Iterator[str]:
    percent = max(100 * clock["jitter_s"] * clock["median_hz"], 0.001)
    yield (
        f"steps of {1e3 / clock['median_hz']:.4g} ms, 98 % of them within "
        f"{float(f'{percent:.2g}'):g} % of that"
    )
    if clock["gaps"]:
        missing = sum(gap["missing_samples"] for gap in clock["gaps"])
        yield (
            f"gaps, filled by linear interpolation: {len(clock['gaps'])}, about {missing} samples "
            f"missing, the longest {_longest(clock['gaps'])}"
        )


def _longest(stretches: Sequence[Mapping[str, float]]) -> str:
    longest = max(stretches, key=lambda stretch: stretch["to_s"] - stretch["from_s"])
    return f"from {longest['from_s']:.4g} to {longest['to_s']:.4g} s"


def _describe_channel(channel: Mapping[str, Any], unit: str) -> Iterator[str]:
    yield (
        f"{channel['lowest']:.4g} to {channel['highest']:.4g}{unit}, "
        f"{channel['new_values_hz']:.4g} new values a second"
    )
    for kind, words in MARKS.items():
        if channel[kind]:
            yield f"{words}: {len(channel[kind])} times, the longest {_longest(channel[kind])}"


def _describe_leak(diagnosis: Mapping[str, Any], unit: str) -> Iterator[str]:
    sealed, channel = diagnosis["sealed"], diagnosis["channels"]["p_o_kpa"]
    slope = sealed["slope_kpa_per_min"]
    if slope is None:
        yield (
            f"{sealed['relative_to']} explains only {sealed['explained']:.0%} of its variance, too "
            "little for a sealed chamber; a leak is not evaluated"
        )
        return
    limit = LEAK_KPA_PER_MIN if unit else 0.05 * (channel["highest"] - channel["lowest"])
    if abs(slope) > limit:
        what = "leaks" if slope < 0.0 else "warms, or was re-filled"
        short = diagnosis["duration_s"] < SHORT_S
        doubt = "; hysteresis can cause this in under a minute" if short else ""
        yield f"{what}: at equal {sealed['relative_to']} {slope:+.2g}{unit} a minute{doubt}"
