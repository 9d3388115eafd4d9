"""Quality record of a raw log: completeness, gaps, ranges, stuck sensors, leak."""

import re
from collections.abc import Mapping
from itertools import accumulate
from typing import TYPE_CHECKING, Any

import numpy as np

from fprc.channels import CHANNELS, NEEDED_SENSORS, unit_of
from fprc.logs.columns import Columns

if TYPE_CHECKING:
    from fprc.config.settings import Quality

#: In a shorter recording, s, hysteresis can look like a leak. Of the variance of P_o, without its
#: trend, P_i must explain this share, or it is not a sealed chamber that the drive squeezes.
SHORT_S, EXPLAINED = 60.0, 0.9
#: Half-width of the play that models hysteresis of the squeezing, a share of the largest P_i.
PLAY = 0.1


def assess(log: Columns, limits: "Quality", sample_rate_hz: float) -> dict[str, Any]:
    """Return the quality record of a readable raw log.

    Each check has ``passed``, and the ``finding`` in words. A failed check is recorded and printed,
    and does not stop the workflow. A check skips channels that an import left out, or that hold
    another quantity; ``samples`` of the check ``range`` counts those outside, by channel. ``loop``
    has the statistics of a real rig's control loop.
    """
    counts, outside = _outside(log, limits)
    found = {
        "complete": _complete(log),
        "gaps": _gaps(log.channels["time_s"], limits.gap_periods / sample_rate_hz),
        "range": (not outside, "; ".join(outside)),
        "stuck": _stuck(log, limits.stuck_s * sample_rate_hz),
        "leak": _leak(log, limits.leak_kpa_per_min, counts),
    }
    checks = {name: {"passed": passed, "finding": text} for name, (passed, text) in found.items()}
    checks["range"]["samples"] = counts
    more = {"loop": log.attributes.get("statistics"), "notes": log.attributes.get("notes")}
    return {
        "log": log.path.name,
        "experiment": log.attributes["experiment"],
        "source": log.attributes["source"],
        "samples": len(log.channels["time_s"]),
        "sample_rate_hz": sample_rate_hz,
        "checks": checks,
    } | {name: content for name, content in more.items() if content}


def warnings(record: Mapping[str, Any]) -> list[str]:
    """Return one line for each failed check of a quality record."""
    failed = {k: check for k, check in record["checks"].items() if not check["passed"]}
    return [f"{record['log']}: {name}: {check['finding']}" for name, check in failed.items()]


def other_quantity(name: str) -> str:
    """Return the beginning of the note of a channel that holds another quantity."""
    return f"not in {unit_of(name)}: "


def substitute(name: str, attributes: Mapping[str, Any]) -> str | None:
    """Return the quantity that a channel of an import holds instead of the one in its name."""
    begins, note = other_quantity(name), attributes.get("notes", {}).get(name, "")
    return note.removeprefix(begins) if note.startswith(begins) else None


def noted_unit(name: str, attributes: Mapping[str, Any]) -> str:
    """Return the unit of a channel; if it holds another quantity, the unit in its note.

    The note ends with the unit in brackets. Without brackets the unit is ``1``.
    """
    other = substitute(name, attributes)
    if other is None:
        return unit_of(name)
    unit = re.search(r"\[([^\[\]]+)\]\s*$", other)
    return unit[1] if unit else "1"


def _complete(log: Columns) -> tuple[bool, str]:
    if log.attributes.get("complete", True):
        return True, ""
    lost = log.attributes.get("lost_samples")
    more = f"; lost samples: {lost}" if lost else ""
    return False, f"{log.attributes.get('incomplete_reason') or 'unknown'}{more}"


def _gaps(time_s: np.ndarray, limit_s: float) -> tuple[bool, str]:
    steps_s = np.diff(time_s, append=time_s[-1])
    gaps = np.flatnonzero(steps_s > limit_s) + 1
    begin = f"{gaps.size} gaps, the first before sample {gaps[0]}; " if gaps.size else ""
    return not gaps.size, f"{begin}longest step {steps_s.max():.4g} s, limit {limit_s:.4g} s"


def _outside(log: Columns, limits: "Quality") -> tuple[dict[str, int], list[str]]:
    """Return how many samples of each channel are implausible, and a text on each such channel."""
    counts, findings = {}, []
    for name, _, _, plausible, _ in CHANNELS:
        values = log.channels.get(name)
        if plausible is None or values is None or substitute(name, log.attributes) is not None:
            continue
        low, high = getattr(limits, plausible) if isinstance(plausible, str) else plausible
        outside = np.flatnonzero((values < low) | (values > high))
        counts[name] = int(outside.size)
        if outside.size:
            findings.append(
                f"channel {name}: sample {outside[0]} is {values[outside[0]]:g} {unit_of(name)}, "
                f"outside of {low:g} to {high:g}, in all {outside.size}"
            )
    return counts, findings


def _stuck(log: Columns, limit: float) -> tuple[bool, str]:
    present = [name for name in NEEDED_SENSORS if name in log.channels]
    longest = {name: int(runs(log.channels[name])[1].max()) for name in present}
    channel = max(longest, key=longest.__getitem__)
    finding = f"channel {channel}: unchanged for {longest[channel]} samples, limit {int(limit)}"
    return longest[channel] <= limit, finding


def runs(values: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return the first sample and the length of every run of equal values."""
    begins = np.append(0, np.flatnonzero(values[1:] != values[:-1]) + 1)
    return begins, np.diff(np.append(begins, len(values)))


def _leak(log: Columns, limit: float, outside: Mapping[str, int]) -> tuple[bool, str]:
    """Fit P_o = cubic of P_i + play of P_i + slope t: a leak is what squeezing does not explain."""
    time_s = log.channels["time_s"]
    if "p_i_kpa" not in log.channels or outside.get("p_o_kpa", 1):
        return True, "not checked, needs p_i_kpa, and p_o_kpa within its range"
    if np.ptp(time_s) < SHORT_S:
        why = f"the log is shorter than {SHORT_S:g} s, in which hysteresis looks like a leak"
        return True, f"not checked, {why}"
    p_i, p_o = log.channels["p_i_kpa"], log.channels["p_o_kpa"]
    minutes, drive = (time_s - time_s.mean()) / 60.0, p_i / (np.abs(p_i).max() or 1.0)
    play = accumulate(drive.tolist(), lambda y, u: min(max(y, u - PLAY), u + PLAY))
    basis = np.column_stack([minutes, np.vander(drive, 4), list(play)])
    weights, *_ = np.linalg.lstsq(basis, p_o)
    trend = p_o - np.polyval(np.polyfit(minutes, p_o, 1), minutes)
    if not np.var(p_o - basis @ weights) < (1.0 - EXPLAINED) * np.var(trend):
        return True, "not checked, P_o does not follow P_i"
    return bool(weights[0] >= -limit), f"{weights[0]:.3g} kPa/min, limit {-limit:g} kPa/min"
