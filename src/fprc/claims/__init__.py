"""The paper's claims C1-C18, tested on result files; verdicts are computed, never typed."""

from fprc.claims.finding import Finding, Results, Statement
from fprc.claims.ledger import (
    changed_verdicts,
    fit_in_words,
    judge_claims,
    parts_of,
    status_of,
    turned_verdicts,
)

__all__ = [
    "Finding",
    "Results",
    "Statement",
    "changed_verdicts",
    "fit_in_words",
    "judge_claims",
    "parts_of",
    "status_of",
    "turned_verdicts",
]
