"""The ledger: every claim of the paper with numbers, limits and a computed verdict."""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from fprc.claims.claim import (
    NOT_INFORMATIVE,
    NOT_REPRODUCED,
    REPRODUCED,
    UNDECIDED,
    Claim,
    Results,
    Statement,
)
from fprc.claims.paper import CLAIMS
from fprc.escape import in_words

#: Terms of the calibration's objective that are not claims.
_TERMS = {
    "tables": "Tables II and III",
    "orders": "their orders",
    "plausible": "plausible loops",
    "open_loop": "open-loop Table IV",
    "closed_loop": "feedback that cuts errors by a fifth",
    "closed_sweep": "the closed-loop error of the sweep",
    "margin": "feedback that helps with gains half again as large",
}

#: Kinds of claims by what they have to do with the fit of the rig, in the order of readers.
KINDS = {
    "predicted": "no part of it was fitted",
    "half fitted": "a part of it was fitted",
    "fitted": "the simulated rig was fitted to it",
    "assumed": "it is built into the simulated rig",
    "counted": "multiplications a sample, which depend on no rig",
}

#: On how many of the rigs that fit print each claim holds: ``of``, their number; ``holds``, by
#: claim; ``ranges`` of the means, by claim and statement.
Members = Mapping[str, Any]

#: What a rig was fitted ``to``: terms of an objective (``fprc.config.calibration.Fitted``).
Fit = Mapping[str, Sequence[str]]


def status_of(claim: Claim, fitted: Fit) -> str:
    """Return whether a claim was fitted, in part or whole, predicted, or of its own kind."""
    to = set(fitted.get("to", ()))
    if claim.kind or to & set(claim.fitted_by):
        return claim.kind or "fitted"
    return "half fitted" if to & set(claim.half_fitted_by) else "predicted"


def holding(rows: Sequence[Mapping[str, Any]]) -> dict[str, tuple[int, int]]:
    """Return by kind how many claims are reproduced, of how many that are informative."""
    verdicts: dict[str, list[bool]] = {kind: [] for kind in KINDS}
    for row in rows:
        if row["verdict"] != NOT_INFORMATIVE:
            verdicts[row["rig"]].append(row["verdict"] == REPRODUCED)
    return {kind: (sum(held), len(held)) for kind, held in verdicts.items() if held}


def fit_in_words(fitted: Fit) -> str:
    """Return what a rig was fitted to, as a part of a sentence."""
    return in_words(_TERMS.get(term, term) for term in fitted.get("to", ())) or "nothing"


def judge_claims(
    results: Results,
    published: Mapping[str, Any],
    fitted: Fit,
    claims: Sequence[Claim] = CLAIMS,
    members: Members | None = None,
) -> list[dict[str, Any]]:
    """Return one row per claim, with its verdict and those of its statements.

    A claim is reproduced if every statement is, and not reproduced if one is not. One that almost
    any numbers support, or that no fit decides and that holds on every member, is not informative
    where others would be reproduced. ``members`` is as ``members_of`` returns it.
    """
    rows = []
    known = members or {"of": 0, "holds": {}, "ranges": {}}
    for claim in claims:
        statements = list(claim.statements(results, published))
        verdicts = {statement.verdict for statement in statements}
        status, held = status_of(claim, fitted), known["holds"].get(claim.id)
        anyway = held == known["of"] and status in ("predicted", "half fitted")
        holds = NOT_INFORMATIVE if claim.holds_by_chance or anyway else REPRODUCED
        weakest = (verdict for verdict in (NOT_REPRODUCED, UNDECIDED) if verdict in verdicts)
        ranges = known["ranges"].get(claim.id, {})
        by_limits: dict[str, list[str]] = {}
        for statement in statements:
            by_limits.setdefault(statement.limits(), []).append(statement.text)
        rows.append(
            {
                "id": claim.id,
                "claim": claim.text,
                "published": claim.printed,
                "ours": _ours(statements, ranges),
                "test": "; ".join(f"{', '.join(of)} {limits}" for limits, of in by_limits.items()),
                "basis": _basis(claim, results),
                "note": claim.note,
                "verdict": next(weakest, holds),
                "rig": status,
                "rigs": "-" if held is None else f"{held} of {known['of']}",
                "shown_in": list(claim.shown_in),
                "statements": [
                    {
                        "text": statement.text,
                        **dict(zip(("mean", "first", "last"), statement.interval, strict=True)),
                        "over_rigs": ranges.get(statement.text),
                        "limits": statement.limits(),
                        "verdict": statement.verdict,
                    }
                    for statement in statements
                ],
            }
        )
    return rows


def members_of(
    rigs: Sequence[Results], published: Mapping[str, Any], claims: Sequence[Claim]
) -> dict[str, Any]:
    """Judge claims on rigs one by one; return ``Members``, with the range of the middle 95 %."""
    holds, ranges = {}, {}
    for claim in claims:
        judged = [list(claim.statements(rig, published)) for rig in rigs]
        holds[claim.id] = sum({s.verdict for s in of_rig} == {REPRODUCED} for of_rig in judged)
        ranges[claim.id] = {
            column[0].text: [
                float(f"{end:.4g}")
                for end in np.quantile([s.interval[0] for s in column], (0.025, 0.975))
            ]
            for column in zip(*judged, strict=True)
        }
    return {"of": len(rigs), "holds": holds, "ranges": ranges}


def _ours(statements: Sequence[Statement], ranges: Mapping[str, Sequence[float]]) -> str:
    """Return our numbers; of many statements, that nearest to its limit or furthest beyond it."""
    if len(statements) <= 6:
        return "; ".join(s.shown(ranges.get(s.text, ())) for s in statements)
    held = sum(statement.verdict == REPRODUCED for statement in statements)
    worst = min(statements, key=lambda statement: statement.margin)
    what = "closest" if worst.margin > 0.0 else "furthest off"
    return f"{held} of {len(statements)} hold; {what}: {worst.shown(ranges.get(worst.text, ()))}"


def _basis(claim: Claim, results: Results) -> str:
    """Return what the values of a claim are taken over."""
    if claim.over == "one run":
        return "main run"
    of_grids, halved = "grids" in claim.over, claim.over.startswith("halves")
    seeds = len(results.grids if of_grids else results.replicates or results.controls)
    # see fprc.experiments.comparison.evaluate_grids
    folds = ", the first fold of each" if of_grids else ""
    if seeds == 1:
        return f"one seed{folds}"
    chosen = f"; the step is chosen on the first {seeds // 2}" if halved else ""
    judging = seeds - halved * (seeds // 2)
    return f"mean and its 95 % interval over {judging} noise seeds of this rig{folds}{chosen}"


def changed_verdicts(ledger: Sequence[Mapping[str, str]], declared: dict[str, str]) -> list[str]:
    """Return one line for each claim whose verdict differs from the declared one."""
    ours = {row["id"]: row["verdict"] for row in ledger}
    return [
        f"{claim}: {ours.get(claim, 'not judged')}, "
        f"but {declared.get(claim, 'nothing')} is declared"
        for claim in ours | declared
        if ours.get(claim) != declared.get(claim)
    ]
