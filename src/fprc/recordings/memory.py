"""What P_o of a recording remembers of theta, and what it is made of."""

from collections.abc import Mapping
from typing import Any

import numpy as np
from matplotlib.axes import Axes

from fprc.evaluation.capacity import TAPS, filtered_capacity
from fprc.evaluation.readouts import BlockReadouts
from fprc.evaluation.sides import ALPHAS, Recordings, distances, readouts_of
from fprc.figures import style


def judge_memory(
    recordings: Recordings, models: Mapping[str, Any], seed: int, period_s: float | None
) -> dict[str, Any]:
    """Measure memory, capacity and parts of P_o, on the longest recording.

    Parameters
    ----------
    recordings : Recordings
        Thinned.
    period_s : float or None
        Period of a motion that repeats.

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
    theta, p_o = recordings.theta[rows], recordings.p_o[rows]
    of_each = {
        name: filtered_capacity(signal, theta, recordings.rate_hz)
        for name, signal in (("p_o", p_o), ("theta", theta))
    }
    of_p_o = recordings._replace(target=recordings.p_o)
    linear, with_plays = (
        explained(readouts_of(of_p_o, family, False, models, seed), recordings.p_o)
        for family in ("low-passes", "plays")
    )
    new = None
    if period_s and (lag := round(period_s * recordings.rate_hz)) <= len(p_o) // 2:
        new = float(distances(p_o)[lag])
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
        "parts": {"linear": linear, "hysteresis": max(0.0, with_plays - linear), "new": new},
    }


def explained(fits: BlockReadouts, target: np.ndarray) -> float:
    """Return the share of a target's variance that readouts explain on unseen blocks."""
    blocks = range(len(fits.blocks))
    middle = len(ALPHAS) // 2
    left = np.mean([fits.errors(block)[middle] ** 2 for block in blocks])
    return max(0.0, 1.0 - float(left / np.var(target)))


def memory_in_words(found: Mapping[str, Any]) -> list[str]:
    """Return what was measured as sentences."""
    parts, p_o, theta = found["parts"], found["p_o"], found["theta"]
    new = (
        ""
        if parts["new"] is None
        else f" {100 * parts['new']:.0f} % of it is new at each repetition of the motion."
    )
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
        f"Of P_o's variance, a linear filter of theta explains {100 * parts['linear']:.0f} %, "
        f"plays of theta {100 * parts['hysteresis']:.0f} % more, and neither "
        f"{100 * rest:.0f} %.{new}",
    ]


def draw_memory(found: Mapping[str, Any], png: str) -> None:
    """Draw the memory curve and the capacity by degree."""
    fig, (curve, bars) = style.figure(1, 2, style.PAGE_IN, 2.4)
    plot_memory(found, curve)
    plot_degrees(found, bars)
    style.save(fig, {"source": "import"}, png)


#: Colour and words of each state.
_STATES = {"p_o": ("0.15", "P$_o$ and its low-passes"), "theta": ("0.65", "θ and its low-passes")}


def plot_memory(found: Mapping[str, Any], ax: Axes) -> None:
    """Draw the share of past theta that each state adds, over the lag."""
    for name, (colour, label) in _STATES.items():
        ax.plot(found["lags_s"], found[name]["memory"], color=colour, label=label)
    ax.set(xlabel="Lag [s]", ylabel="Share of past θ added", xlim=(0, None))
    ax.set_ylim(0.0, max(0.1, 1.1 * max(max(found[name]["memory"]) for name in _STATES)))
    ax.legend()


def plot_degrees(found: Mapping[str, Any], ax: Axes) -> None:
    """Draw the capacity of each degree as a bar for each state, below the number of states."""
    rank = max(found[name]["rank"] for name in _STATES)
    for shift, (name, (colour, _)) in zip((-0.2, 0.2), _STATES.items(), strict=True):
        degrees = found[name]["degrees"]
        at = np.arange(1, len(degrees) + 1) + shift
        bars = ax.bar(at, degrees, color=colour, width=0.38)
        paper = {"facecolor": "white", "edgecolor": "none", "pad": 0.5}
        ax.bar_label(bars, fmt="%.2g", padding=3, bbox=paper, zorder=3)
    ax.axhline(rank, color="0.2", linestyle=":", linewidth=0.8)
    ax.text(len(degrees) + 0.4, rank, "number of states", ha="right", va="bottom")
    ax.set(xlabel="Degree", ylabel="Capacity", ylim=(0.0, 1.2 * rank))
    ax.set_xticks(range(1, len(degrees) + 1))
