"""The ledger: every claim of the paper with numbers, test and a computed verdict."""

from collections.abc import Mapping, Sequence
from typing import Any

from fprc.claims.control import CONTROL_TESTS
from fprc.claims.finding import Finding, Results
from fprc.claims.models import MODEL_TESTS

REPRODUCED = "reproduced"
NOT_REPRODUCED = "not reproduced"
CONTRADICTED = "contradicted as printed"

_TESTS = MODEL_TESTS | CONTROL_TESTS


def judge_claims(
    texts: Sequence[Mapping[str, str]], results: Results, published: Mapping[str, Any]
) -> list[dict[str, str]]:
    """Return id, text, numbers, test and verdict of every claim, in the order of ``texts``."""
    rows = []
    for claim in texts:
        finding = _TESTS[claim["id"]](results, published)
        rows.append(
            {
                "id": claim["id"],
                "claim": claim["text"],
                "published": finding.published,
                "ours": finding.ours,
                "test": finding.test,
                "basis": finding.basis,
                "verdict": _verdict(finding),
            }
        )
    return rows


def _verdict(finding: Finding) -> str:
    if finding.holds is None:
        return CONTRADICTED
    return REPRODUCED if finding.holds else NOT_REPRODUCED


def changed_verdicts(ledger: Sequence[Mapping[str, str]], declared: Mapping[str, str]) -> list[str]:
    """Return one line for each claim whose verdict differs from the declared one."""
    ours = {row["id"]: row["verdict"] for row in ledger}
    return [
        f"{claim}: {ours.get(claim, 'not judged')}, "
        f"but {declared.get(claim, 'nothing')} is declared"
        for claim in sorted(ours.keys() | declared.keys(), key=lambda claim: int(claim[1:]))
        if ours.get(claim) != declared.get(claim)
    ]
