"""The ledger: every claim of the paper with numbers, limits and a computed verdict."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from fprc.claims.finding import NOT_REPRODUCED, REPRODUCED, UNDECIDED, Results, Statement
from fprc.claims.paper import CLAIMS, Claim
from fprc.escape import in_words

#: What tests the sentences and numbers of the paper.
SENTENCES = Path(__file__).with_name("sentences.yaml")

#: Terms of the calibration's objective that are not claims.
_TERMS = {
    "tables": "Tables II and III",
    "orders": "their orders",
    "plausible": "plausible loops",
    "open_loop": "open-loop Table IV",
    "closed_loop": "feedback that cuts errors by a fifth",
    "closed_sweep": "the closed-loop error of the sweep",
}


def status_of(claim: Claim, terms: Sequence[str]) -> str:
    """Return whether the terms of an objective fitted a claim: fitted, half fitted, or predicted.

    Claims of another kind are timed or assumed.
    """
    if claim.kind:
        return claim.kind
    if set(claim.fitted_by) & set(terms):
        return "fitted"
    return "half fitted" if set(claim.half_fitted_by) & set(terms) else "predicted"


def fit_in_words(terms: Sequence[str]) -> str:
    """Return what the terms of an objective fit, as a list in a sentence."""
    return in_words([_TERMS.get(term, term) for term in terms]) or "nothing"


def judge_claims(
    results: Results,
    published: Mapping[str, Any],
    terms: Sequence[str] = (),
    claims: Sequence[Claim] = CLAIMS,
) -> list[dict[str, Any]]:
    """Return one row per claim.

    Parameters
    ----------
    terms : sequence of str
        Terms of the objective that the rig was fitted to.

    Returns
    -------
    list of dict
        ``id``, ``claim``, ``published``, ``ours``, ``test``, ``basis``, ``verdict``, ``rig`` (see
        ``status_of``), ``shown_in`` (tables and figures), and ``statements``, each with text, mean,
        interval, limits and verdict. A claim is reproduced if every statement is, and not
        reproduced if one is not.
    """
    rows = []
    for claim in claims:
        statements = claim.statements(results, published)
        verdicts = {statement.verdict for statement in statements}
        weakest = (verdict for verdict in (NOT_REPRODUCED, UNDECIDED) if verdict in verdicts)
        rows.append(
            {
                "id": claim.id,
                "claim": claim.text,
                "published": claim.printed,
                "ours": _ours(statements),
                "test": _limits(statements),
                "basis": "; ".join(filter(None, (_basis(claim, results, statements), claim.note))),
                "verdict": next(weakest, REPRODUCED),
                "rig": status_of(claim, terms),
                "shown_in": list(claim.shown_in),
                "statements": [
                    {
                        "text": statement.text,
                        **dict(zip(("mean", "first", "last"), statement.interval, strict=True)),
                        "limits": statement.limits().removeprefix(f"{statement.text} "),
                        "verdict": statement.verdict,
                    }
                    for statement in statements
                ],
            }
        )
    return rows


def _ours(statements: Sequence[Statement]) -> str:
    """Return our numbers; of many statements, the one that is closest to its limit."""
    if len(statements) <= 4:
        return "; ".join(statement.shown() for statement in statements)
    held = sum(statement.verdict == REPRODUCED for statement in statements)
    closest = min(statements, key=lambda statement: statement.margin)
    return f"{held} of {len(statements)} hold; closest: {closest.shown()}"


def _limits(statements: Sequence[Statement]) -> str:
    """Return the limits; those that several statements share are given once."""
    by_limits: dict[str, list[str]] = {}
    for statement in statements:
        limits = statement.limits().removeprefix(statement.text)
        by_limits.setdefault(limits, []).append(statement.text)
    return "; ".join(", ".join(texts) + limits for limits, texts in by_limits.items())


def _basis(claim: Claim, results: Results, statements: Sequence[Statement]) -> str:
    """Return what the values of a claim are taken over."""
    interval = "mean and its 95 % interval over"
    if claim.over.startswith("repeats"):
        return f"main run, this machine, {interval} {np.size(statements[0].values)} repeats"
    seeds = len(results.grids if "grids" in claim.over else results.replicates or results.controls)
    if claim.over == "halves of the grids" and seeds > 1:
        half = seeds // 2
        return f"{interval} {seeds - half} seeds; the step is chosen on the first {half}"
    return "one seed" if seeds == 1 else f"{interval} {seeds} seeds"


def not_tested(rows: Mapping[str, Any]) -> dict[str, str]:
    """Return the sentences that cannot be tested here, by their first words, with their reasons.

    Parameters
    ----------
    rows : Mapping
        Content of ``SENTENCES``.
    """
    found = {}
    for section in rows["sentences"].values():
        for begins, row in section.items() if isinstance(section, dict) else ():
            if isinstance(row, str) and row.startswith("cannot be tested here: "):
                found[begins] = row.partition(": ")[2]
    return found


def changed_verdicts(ledger: Sequence[Mapping[str, str]], declared: Mapping[str, str]) -> list[str]:
    """Return one line for each claim whose verdict differs from the declared one."""
    ours = {row["id"]: row["verdict"] for row in ledger}
    order = [*ours, *(name for name in declared if name not in ours)]
    return [
        f"{claim}: {ours.get(claim, 'not judged')}, "
        f"but {declared.get(claim, 'nothing')} is declared"
        for claim in order
        if ours.get(claim) != declared.get(claim)
    ]
