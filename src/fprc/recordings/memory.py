"""What P_o of a recording remembers of theta, and what it is made of."""

from collections.abc import Mapping
from typing import Any

import numpy as np

from fprc.evaluation.capacity import TAPS, filtered_capacity
from fprc.evaluation.sides import ALPHAS, Recordings, distances, readouts_of
from fprc.figures import style


def judge_memory(
    recordings: Recordings, models: Mapping[str, Any], seed: int, period_s: float | None
) -> dict[str, Any]:
    """Measure memory, capacity and parts of P_o, on the longest of thinned recordings.

    Returns
    -------
    dict
        ``p_o`` and ``theta``, of P_o with its low-passes and of theta with the same: ``memory``,
        ``memory_s``, ``degrees`` and ``rank``, see ``fprc.capacity``; ``lags_s``; ``parts``,
        shares of the variance of P_o on unseen blocks: ``linear``, a filter of theta;
        ``hysteresis``, what plays add; and ``new``, what does not come back when the motion
        repeats (None if it does not repeat).
    """
    ends = np.cumsum(recordings.lengths)
    longest = int(np.argmax(recordings.lengths))
    rows = slice(ends[longest] - recordings.lengths[longest], ends[longest])
    signals = {"p_o": recordings.p_o[rows], "theta": recordings.theta[rows]}
    of_each = {
        name: filtered_capacity(signal, signals["theta"], recordings.rate_hz)
        for name, signal in signals.items()
    }
    of_p_o = recordings._replace(target=recordings.p_o)
    explained = []
    for family in ("low-passes", "plays"):
        fits = readouts_of(of_p_o, family, False, models, seed)
        errors = [fits.errors(block)[len(ALPHAS) // 2] for block in range(len(fits.blocks))]
        explained.append(max(0.0, 1.0 - float(np.mean(np.square(errors)) / np.var(of_p_o.target))))
    new = None
    if period_s and (lag := round(period_s * recordings.rate_hz)) <= len(signals["p_o"]) // 2:
        new = float(distances(signals["p_o"])[lag])
    return {
        **{
            name: {
                "memory": found.memory.tolist(),
                "memory_s": found.memory_s,
                "degrees": found.degrees.tolist(),
                "rank": found.rank,
            }
            for name, found in of_each.items()
        },
        "lags_s": of_each["p_o"].lags_s.tolist(),
        "parts": {
            "linear": explained[0],
            "hysteresis": max(0.0, explained[1] - explained[0]),
            "new": new,
        },
    }


def memory_in_words(found: Mapping[str, Any]) -> list[str]:
    """Return what was measured as sentences."""
    parts, p_o, theta = found["parts"], found["p_o"], found["theta"]
    new = "" if parts["new"] is None else f", and {parts['new']:.0%} is new at each repetition"
    rest = max(0.0, 1.0 - parts["linear"] - parts["hysteresis"])
    degrees = [
        ", ".join(f"{share:.2g} of degree {number}" for number, share in enumerate(each, 1))
        for each in (p_o["degrees"], theta["degrees"])
    ]
    return [
        f"Memory: P_o and its low-passes add {p_o['memory_s']:.2g} s to theta's own newest "
        f"{TAPS} samples, the same low-passes of theta {theta['memory_s']:.2g} s. This is the sum, "
        f"over lags up to {found['lags_s'][-1]:.2g} s, of the share of past theta's variance that "
        "they explain on unseen blocks; 0 where the same of another time does as well.",
        f"Capacity: {degrees[0]} of {p_o['rank']} states with P_o; {degrees[1]} of "
        f"{theta['rank']} with theta. The input is correlated, so these compare states on this "
        "recording only.",
        f"Of P_o's variance, a linear filter of theta explains {parts['linear']:.0%}, plays of "
        f"theta {parts['hysteresis']:.0%} more, and neither {rest:.0%}{new}.",
    ]


#: Colour and words of each state.
_STATES = {"p_o": ("0.15", "P$_o$ and its low-passes"), "theta": ("0.65", "θ and its low-passes")}


def draw_memory(found: Mapping[str, Any], png: str) -> None:
    """Draw the memory curve, and the capacity by degree below the number of states."""
    fig, (curve, bars) = style.figure(1, 2, style.PAGE_IN, 2.4)
    rank = max(found[name]["rank"] for name in _STATES)
    for shift, (name, (colour, label)) in zip((-0.2, 0.2), _STATES.items(), strict=True):
        curve.plot(found["lags_s"], found[name]["memory"], color=colour, label=label)
        degrees = found[name]["degrees"]
        at = np.arange(1, len(degrees) + 1)
        drawn = bars.bar(at + shift, degrees, color=colour, width=0.38)
        paper = {"facecolor": "white", "edgecolor": "none", "pad": 0.5}
        bars.bar_label(drawn, fmt="%.2g", padding=3, bbox=paper, zorder=3)
    curve.set(xlabel="Lag [s]", ylabel="Share of past θ added", xlim=(0, None))
    curve.set_ylim(0.0, max(0.1, 1.1 * max(max(found[name]["memory"]) for name in _STATES)))
    curve.legend()
    bars.axhline(rank, color="0.2", linestyle=":", linewidth=0.8)
    bars.text(at[-1] + 0.4, rank, "number of states", ha="right", va="bottom")
    bars.set(xlabel="Degree", ylabel="Capacity", ylim=(0.0, 1.2 * rank), xticks=at)
    style.save(fig, {"source": "import"}, png)
