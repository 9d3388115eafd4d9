"""Compare two models that were measured on the same units; decide on several pairs at once.

A unit is a seed, a rig, or a block of a recording.
"""

import math
from collections.abc import Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np
from scipy.special import stdtr

from fprc.intervals import interval_of_mean

SUPERIOR = "superior"
EQUIVALENT = "equivalent"
INFERIOR = "inferior"
UNDECIDED = "undecided"
NOT_JUDGED = "not judged"

#: Two models are equivalent within this factor.
EQUIVALENT_WITHIN = 1.05
#: Chance that any of a family's verdicts is wrong.
ALPHA = 0.05
#: Fewest units that decide anything; units that a subset leaves out.
LEAST_UNITS, LEFT_OUT = 8, 5
#: Number of random subsets, and the share of them that must agree with a verdict.
SUBSETS, AGREEING = 200, 0.95

#: Verdicts from the weakest to the strongest.
_STRENGTH = (INFERIOR, UNDECIDED, EQUIVALENT, SUPERIOR)


#: A mean and the ends of its interval.
Ends = tuple[float, float, float]


class Part(NamedTuple):
    """One comparison of a claim: the logarithm of a ratio over its limit, per unit."""

    text: str
    values: Mapping[int, float]  #: by unit; lower is better
    limit: float = 1.0  #: with any other there is no equivalence
    dropped: int = 0  #: units without this pair
    #: Samples that test per sample that trains, if the units of one cross-validation share their
    #: training data; 0 for units that share none.
    overlap: float = 0.0

    def interval(self, level: float, units: Sequence[int] | None = None) -> Ends:
        """Return the mean and the ends of the interval that errs with probability ``level``.

        Units that share training data resemble each other. Their n values then have the variance
        s^2 (1/n + overlap) of the mean, not s^2 / n. This is an approximation: no
        unbiased estimate of that variance exists for one cross-validation.

        References
        ----------
        Nadeau and Bengio, Machine Learning 52 (2003); Bouckaert and Frank, PAKDD 2004; Bengio and
        Grandvalet, Journal of Machine Learning Research 5 (2004), on the bias.
        """
        values = self._array(units)
        return interval_of_mean(values, 1.0 - level, self._widened(values.size))

    def ends(self, level: float) -> dict[str, float]:
        """Return the interval as readers see it: ``mean``, ``low`` and ``high``."""
        ends = zip(("mean", "low", "high"), self.interval(level), strict=True)
        return {name: self.limit * math.exp(value) for name, value in ends}

    def verdict(self, level: float, units: Sequence[int] | None = None) -> str:
        """Return the verdict from the interval that errs with probability ``level``.

        In this order: equivalent if the interval lies within 1/1.05 to 1.05, superior if it lies
        below 1, inferior if it lies above 1, otherwise undecided.
        """
        _, low, high = self.interval(level, units)
        margin = math.log(EQUIVALENT_WITHIN)
        if self.limit == 1.0 and -margin <= low and high <= margin:
            return EQUIVALENT
        if high < 0.0:
            return SUPERIOR
        return INFERIOR if low > 0.0 else UNDECIDED

    def least_levels(self) -> tuple[float, float]:
        """Return the lowest levels that decide anything, and that say inferior (1 if none does)."""
        values = self._array(None)
        mean, freedom = float(values.mean()), values.size - 1
        # positive even if all units agree exactly
        error = float(values.std(ddof=1)) / math.sqrt(values.size) * self._widened(values.size)
        error = max(error, 1e-12)
        below, above = (2.0 * float(stdtr(freedom, sign * mean / error)) for sign in (1.0, -1.0))
        levels = [below, above]
        if self.limit == 1.0:
            # both ends of the interval are within the margin
            nearer = (abs(mean) - math.log(EQUIVALENT_WITHIN)) / error
            levels.append(2.0 * float(stdtr(freedom, nearer)))
            if levels[-1] <= above:  # it is equivalent before the interval lies above 1
                above = 1.0
        return min(levels), above

    def _widened(self, size: int) -> float:
        return math.sqrt(1.0 + size * self.overlap)

    def _array(self, units: Sequence[int] | None) -> np.ndarray:
        chosen = self.values if units is None else [u for u in units if u in self.values]
        return np.array([self.values[unit] for unit in chosen])


#: Verdicts on what is compared with a limit and not with another model, as readers see them.
_ON_A_LIMIT = {SUPERIOR: "holds", INFERIOR: "does not hold"}


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
    with a part of fewer than two units is not judged.

    A decided verdict becomes undecided if there are fewer than 8 units, or if fewer than 95 %
    of 200 random subsets with ``left_out`` units fewer give the same verdict at the same level.

    Parameters
    ----------
    claims : Mapping
        Text and parts of each claim, by its id.
    left_out : int
        Units that a subset lacks, fewer than 7.

    Returns
    -------
    list of dict
        One for each part of a claim: its text and ``Part.ends``; of a claim that is not judged one,
        in which these are None. Of the claim ``verdict``; ``p``, the lowest level that decides it,
        adjusted over all claims; ``level``, at which each part was judged; ``stable``, the share of
        the subsets that give the same verdict, or None; ``words``, the verdict as readers see it,
        unstable if too few of the subsets give it; ``units``, of the part that has the fewest;
        ``dropped``, units without a pair.

    References
    ----------
    Holm, Scandinavian Journal of Statistics 6 (1979); Schuirmann, Journal of Pharmacokinetics and
    Biopharmaceutics 15 (1987), for equivalence by an interval.
    """
    parts_of = [parts for _, parts in claims.values()]
    units = [min(len(part.values) for part in parts) for parts in parts_of]
    judged = zip(parts_of, units, strict=True)
    p = np.array([_least_level(parts) if n > 1 else 1.0 for parts, n in judged])
    adjusted, levels = holm(p)
    while loose := [
        k
        for k, parts in enumerate(parts_of)
        if p[k] <= levels[k] and not _is_decided(parts, levels[k])
    ]:
        for k in loose:
            higher = ALPHA / np.arange(len(p), 0, -1)
            p[k] = next((h for h in higher if h > levels[k] and _is_decided(parts_of[k], h)), 1.0)
        adjusted, levels = holm(p)
    rows = []
    for k, (name, (text, parts)) in enumerate(claims.items()):
        level, stable = float(levels[k]), None
        shown: list[dict[str, Any]] = [dict.fromkeys(("part", "mean", "low", "high"))]
        verdict = NOT_JUDGED
        if units[k] > 1:
            level /= len(parts)
            verdict = _weakest(parts, level, None)
            shown = [{"part": part.text, **part.ends(level)} for part in parts]
        if 1 < units[k] < LEAST_UNITS:
            verdict = UNDECIDED
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
        }
        rows += [of_claim | part for part in shown]
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
    # it decides all parts of a claim, or that one is inferior
    decided, inferior = zip(*(part.least_levels() for part in parts), strict=True)
    return min(1.0, len(parts) * min(max(decided), min(inferior)))


def _is_decided(parts: Sequence[Part], level: float) -> bool:
    return _weakest(parts, level / len(parts), None) != UNDECIDED


def _weakest(parts: Sequence[Part], level: float, units: Sequence[int] | None) -> str:
    return min((part.verdict(level, units) for part in parts), key=_STRENGTH.index)


def _share_of_subsets(parts: Sequence[Part], level: float, verdict: str, left_out: int) -> float:
    units = sorted(set().union(*(part.values for part in parts)))
    random = np.random.default_rng(len(units))
    subsets = (
        random.choice(units, len(units) - left_out, replace=False).tolist() for _ in range(SUBSETS)
    )
    return sum(_weakest(parts, level, subset) == verdict for subset in subsets) / SUBSETS
