"""The paper's claims C1-C18, tested on result files; verdicts are computed, never typed."""

from fprc.claims.finding import Finding, Results
from fprc.claims.ledger import changed_verdicts, judge_claims

__all__ = [
    "Finding",
    "Results",
    "changed_verdicts",
    "judge_claims",
]
