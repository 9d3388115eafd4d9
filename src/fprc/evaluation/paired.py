"""Compare two models that were measured on the same units; decide on several pairs at once.

A unit is a seed, a rig, or a block of a recording.
"""

import math
from collections.abc import Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np
from scipy.special import stdtr

from fprc.intervals import interval_of_mean

#: Verdicts from the weakest to the strongest.
INFERIOR, UNDECIDED, EQUIVALENT, SUPERIOR = _STRENGTH = (
    "inferior", "undecided", "equivalent", "superior",
)  # fmt: skip
NOT_JUDGED = "not judged"
#: Verdicts on what is compared with a limit and not with another model, as readers see them.
_ON_A_LIMIT = {SUPERIOR: "holds", INFERIOR: "does not hold"}

#: Two models are equivalent within this factor.
EQUIVALENT_WITHIN = 1.05
#: Chance that any of a family's verdicts is wrong.
ALPHA = 0.05
#: Fewest units that decide anything; units that a subset leaves out.
LEAST_UNITS, LEFT_OUT = 8, 5
#: Number of random subsets, and the share of them that must agree with a verdict.
SUBSETS, AGREEING = 200, 0.95


class Part(NamedTuple):
    """One comparison of a claim: the logarithm of a ratio over its limit, per unit."""

    text: str
    values: Mapping[int, float]  #: by unit; lower is better
    limit: float = 1.0  #: with any other there is no equivalence
    dropped: int = 0  #: units without this pair
    #: Samples that test per sample that trains, if the units of one cross-validation share their
    #: training data; 0 for units that share none.
    overlap: float = 0.0

    def interval(self, level: float) -> tuple[float, float, float]:
        """Return the mean and the ends of the interval that errs with probability ``level``.

        Units that share training data resemble each other: the mean has the variance
        s^2 (1/n + overlap), not s^2 / n (Nadeau and Bengio, Machine Learning 52, 2003). That is an
        approximation: no unbiased one exists (Bengio and Grandvalet, JMLR 5, 2004).
        """
        values = np.array([*self.values.values()])
        return interval_of_mean(values, 1.0 - level, math.sqrt(1.0 + values.size * self.overlap))

    def levels(self, units: Sequence[int] | None = None) -> dict[str, float]:
        """Return by verdict the level above which the interval, of all or some units, says so.

        The first of them that is below a level is the verdict: equivalent if the interval lies
        within 1/1.05 to 1.05, superior if it lies below 1, inferior if it lies above 1.
        """
        chosen = self.values if units is None else [u for u in units if u in self.values]
        values = np.array([self.values[unit] for unit in chosen])
        error = values.std(ddof=1) * math.sqrt(1.0 / values.size + self.overlap)
        mean, error = float(values.mean()), max(error, 1e-12)  # also if all units agree exactly
        margin = math.log(EQUIVALENT_WITHIN) if self.limit == 1.0 else -math.inf
        ends = {EQUIVALENT: abs(mean) - margin, SUPERIOR: mean, INFERIOR: -mean}
        levels = 2.0 * stdtr(values.size - 1, np.array([*ends.values()]) / error)
        return dict(zip(ends, levels.tolist(), strict=True))

    def verdict(self, level: float, units: Sequence[int] | None = None) -> str:
        """Return the verdict from the interval that errs with probability ``level``."""
        decided = (name for name, least in self.levels(units).items() if least < level)
        return next(decided, UNDECIDED)


def decide_together(
    claims: Mapping[str, tuple[str, Sequence[Part]]], left_out: int = LEFT_OUT
) -> list[dict[str, Any]]:
    """Decide on several claims so that any verdict is wrong with probability ``ALPHA`` at most.

    Each claim has a lowest level that decides it: superior, equivalent or inferior, whichever
    comes first. Holm's step-down procedure takes the claims by these levels, lowest first: the
    k-th of K claims is judged at ALPHA / (K + 1 - k), and the first that this does not decide
    leaves itself and all later ones undecided. K counts the claims that could not be judged. At a
    higher level than its lowest a part may be equivalent and no longer inferior: a claim that this
    leaves undecided comes again at the next level that decides it.

    The parts of a claim are judged at equal shares of its level. Its verdict is the weakest:
    inferior if a part is, otherwise undecided if a part is, then equivalent, then superior. A claim
    with a part of fewer than two units is not judged. A decided verdict becomes undecided with
    fewer than 8 units, or if fewer than 95 % of 200 random subsets with ``left_out`` (fewer than 7)
    units fewer give the same verdict at the same level.

    Each part has a row, and a claim that is not judged has one without numbers: ``p`` is the lowest
    level that decides the claim, adjusted over all claims; ``level``, at which each part was
    judged; ``stable``, the share of the subsets, or None; ``words``, the verdict as readers see it;
    ``units``, of the part that has the fewest; ``dropped``, those without a pair. Holm,
    Scandinavian Journal of Statistics 6 (1979); Schuirmann, Journal of Pharmacokinetics and
    Biopharmaceutics 15 (1987), for equivalence by an interval.
    """
    parts_of = [parts for _, parts in claims.values()]
    units = [min(len(part.values) for part in parts) for parts in parts_of]
    judged = [k for k, count in enumerate(units) if count > 1]

    def is_decided(k: int, level: float) -> bool:
        return _weakest(parts_of[k], level / len(parts_of[k])) != UNDECIDED

    p = np.ones(len(parts_of))
    p[judged] = [_least_level(parts_of[k]) for k in judged]
    adjusted, levels = holm(p)
    while loose := [k for k in judged if p[k] <= levels[k] and not is_decided(k, levels[k])]:
        for k in loose:
            higher = ALPHA / np.arange(len(p), 0, -1)
            p[k] = next((h for h in higher if h > levels[k] and is_decided(k, h)), 1.0)
        adjusted, levels = holm(p)
    rows = []
    for k, (name, (text, parts)) in enumerate(claims.items()):
        level, stable, verdict = float(levels[k]), None, NOT_JUDGED
        if k in judged:
            level /= len(parts)
            verdict = _weakest(parts, level) if units[k] >= LEAST_UNITS else UNDECIDED
        words = verdict if parts[0].limit == 1.0 else _ON_A_LIMIT.get(verdict, verdict)
        if verdict not in (NOT_JUDGED, UNDECIDED):
            stable = _share_of_subsets(parts, level, verdict, left_out)
            if stable < AGREEING:
                verdict, words = UNDECIDED, f"{words}, unstable"
        of_claim = {
            "id": name,
            "claim": text,
            "verdict": verdict,
            "p": float(adjusted[k]),
            "level": level,
            "stable": stable,
            "words": words,
            "units": units[k],
            "dropped": max(part.dropped for part in parts),
            **dict.fromkeys(("part", "mean", "low", "high")),
        }
        if k not in judged:
            rows.append(of_claim)
            continue
        for part in parts:
            mean, low, high = (part.limit * np.exp(part.interval(level))).tolist()
            rows.append(of_claim | {"part": part.text, "mean": mean, "low": low, "high": high})
    return rows


def holm(p: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return Holm's adjusted p values, and the level at which each claim is decided.

    From the first claim that is not decided on, all have that claim's level.
    """
    order = np.argsort(p, kind="stable")
    remaining = np.arange(len(p), 0, -1)
    adjusted, levels = np.empty(len(p)), np.empty(len(p))
    adjusted[order] = np.minimum(np.maximum.accumulate(remaining * p[order]), 1.0)
    missed = np.flatnonzero(p[order] > ALPHA / remaining)
    last = missed[0] if missed.size else len(p) - 1
    levels[order] = ALPHA / remaining[np.minimum(np.arange(len(p)), last)]
    return adjusted, levels


def _least_level(parts: Sequence[Part]) -> float:
    """Return the lowest level that decides all parts of a claim, or that one is inferior."""
    found = [part.levels() for part in parts]
    # a part that is equivalent before its interval lies above 1 is never inferior
    inferior = [of[INFERIOR] if of[INFERIOR] < of[EQUIVALENT] else 1.0 for of in found]
    return min(1.0, len(parts) * min(max(min(of.values()) for of in found), *inferior))


def _weakest(parts: Sequence[Part], level: float, units: Sequence[int] | None = None) -> str:
    return min((part.verdict(level, units) for part in parts), key=_STRENGTH.index)


def _share_of_subsets(parts: Sequence[Part], level: float, verdict: str, left_out: int) -> float:
    units = sorted(set().union(*(part.values for part in parts)))
    random = np.random.default_rng(len(units))
    subsets = (
        random.choice(units, len(units) - left_out, replace=False).tolist() for _ in range(SUBSETS)
    )
    return sum(_weakest(parts, level, subset) == verdict for subset in subsets) / SUBSETS
