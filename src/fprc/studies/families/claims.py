"""Share of the rigs on which each claim holds, and its correlation with their parameters."""

import math
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from scipy.stats import binomtest, fisher_exact, rankdata, t

from fprc.claims import numbers
from fprc.claims.finding import REPRODUCED, Results, Statement
from fprc.claims.paper import ASSUMED, CLAIMS, Claim, Printed


def _worth(results: Results, printed: Printed) -> list[Statement]:
    errors = [report["filter_alone"]["test_rmse_kpa"] for report in results.replicates]
    ratio = numbers.error(results, "sweep", "fprc", "test") / np.array(list(map(np.mean, errors)))
    return [Statement("FPRC / FPRC on low-passed theta_d, test", ratio, high=1.0)]


#: B1 on one rig: what P_o is worth there.
WORTH = Claim("B1", "P_o beats low-passed theta_d, forward", "-", _worth)

#: Claims that Tables II to IV, weights and loops decide; the others need grids or times, or are
#: assumed.
JUDGED_BY_RIG = (
    *(claim for claim in CLAIMS if claim.over == "seeds" and claim.kind != ASSUMED), WORTH,
)  # fmt: skip

#: Claims that hold on the dry rig and fail on the viscous one: the worth of P_o is also given on
#: rigs that have them. C18b is left out because few rigs have it, see docs/preregistration.md.
CONDITIONS: tuple[tuple[str, ...], ...] = ((), ("C8a",), ("C18a",), ("C8a", "C18a"))


def shares_of(
    claims: Sequence[Claim],
    verdicts: Sequence[Mapping[str, str]],
    parameters: Sequence[Mapping[str, float]],
    level: float = 0.95,
) -> list[dict[str, Any]]:
    """Return share, Wilson interval and rank correlations of each claim.

    Parameters
    ----------
    verdicts, parameters : sequences of mapping
        Verdict by claim, and value by parameter, of each rig.

    Returns
    -------
    list of dict
        ``id``, ``claim``, ``holds``, ``rigs``, ``share``, ``low``, ``high``; ``correlations`` of
        the verdict with each parameter (empty if all rigs agree); ``least_significant``: by
        chance, one of all these correlations exceeds this with probability 1 - level.
    """
    names = list(parameters[0])
    values = np.array([[rig[name] for name in names] for rig in parameters])
    held_by = {
        claim.id: np.array([rig[claim.id] == REPRODUCED for rig in verdicts]) for claim in claims
    }
    correlations = {name: _correlations(held, values, names) for name, held in held_by.items()}
    limit = _least_significant(len(verdicts), sum(map(len, correlations.values())), level)
    rows = []
    for claim in claims:
        held = held_by[claim.id]
        rows.append(
            {
                "id": claim.id,
                "claim": claim.text,
                **share_of(held, level),
                "correlations": correlations[claim.id],
                "least_significant": limit,
            }
        )
    return rows


def worth_given(
    verdicts: Sequence[Mapping[str, str]], ratios: Sequence[float], level: float = 0.95
) -> list[dict[str, Any]]:
    """Return how often B1 holds on all rigs, and on those on which other claims hold too.

    Parameters
    ----------
    verdicts : sequence of mapping
        Verdict by claim, of each rig.
    ratios : sequence of float
        FPRC's test RMSE over that of the same model on low-passed theta_d, of each rig.

    Returns
    -------
    list of dict
        One for each of ``CONDITIONS``: ``given`` (the claims), ``holds``, ``rigs``, ``share``,
        ``low``, ``high``; ``ratio``: median, smallest and largest; ``p`` of Fisher's exact test,
        two-sided, between the rigs that meet the condition and the others, and ``matters``: it is
        below ``1 - level`` divided by the number of tests. What cannot be computed is None.
    """
    held = np.array([rig["B1"] == REPRODUCED for rig in verdicts])
    values = np.asarray(ratios)
    limit = (1.0 - level) / sum(map(bool, CONDITIONS))
    rows = []
    for names in CONDITIONS:
        meets = np.array([all(rig[name] == REPRODUCED for name in names) for rig in verdicts])
        counts = [[np.sum(part & held), np.sum(part & ~held)] for part in (meets, ~meets)]
        p = None if meets.all() or not meets.any() else float(fisher_exact(counts).pvalue)
        own = values[meets]
        rows.append(
            {
                "given": list(names),
                **share_of(held[meets], level),
                "ratio": [float(f(own)) if own.size else None for f in (np.median, np.min, np.max)],
                "p": p,
                "matters": None if p is None else p < limit,
            }
        )
    return rows


def share_of(held: np.ndarray, level: float = 0.95) -> dict[str, Any]:
    """Return on how many rigs something holds, their number, the share and its Wilson interval.

    The share and the ends of its interval are None if there is no rig.
    """
    counted = {"holds": int(held.sum()), "rigs": held.size}
    if not held.size:
        return {**counted, "share": None, "low": None, "high": None}
    interval = binomtest(counted["holds"], held.size).proportion_ci(level, method="wilson")
    share = {"share": float(held.mean()), "low": float(interval.low), "high": float(interval.high)}
    return counted | share


def _correlations(held: np.ndarray, values: np.ndarray, names: Sequence[str]) -> dict[str, float]:
    if held.all() or not held.any():
        return {}
    ranks = rankdata(values, axis=0)
    if not (np.ptp(ranks, axis=0) > 0).all():
        return {}
    return {
        name: float(np.corrcoef(held, column)[0, 1])
        for name, column in zip(names, ranks.T, strict=True)
    }


def _least_significant(rigs: int, correlations: int, level: float) -> float:
    """Return the Bonferroni limit for correlations over ``rigs`` rigs, by Student's t."""
    if rigs < 4 or correlations == 0:
        return 1.0
    quantile = t.isf((1.0 - level) / (2 * correlations), rigs - 2)
    return float(quantile / math.sqrt(rigs - 2 + quantile**2))
