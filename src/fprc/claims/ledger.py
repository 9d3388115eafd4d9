"""The ledger: every claim of the paper with numbers, limits and a computed verdict."""

from collections.abc import Mapping, Sequence
from typing import Any

from fprc.claims.control import CONTROL_TESTS
from fprc.claims.finding import Results
from fprc.claims.models import MODEL_TESTS
from fprc.escape import in_words

_TESTS = MODEL_TESTS | CONTROL_TESTS

#: Statements of claims that assert several things; each is judged on its own.
PARTS = {
    "C4a": "FPRC beats Fuzzy-linear in training, validation and test RMSE",
    "C4b": "the reservoir readout contributes: FPRC beats the same model on low-passed theta_d",
    "C9a": "raising epsilon lowers FPRC's training RMSE",
    "C9b": "raising n_c lowers FPRC's training RMSE",
    "C9c": "test RMSE is non-monotonic in epsilon and in n_c",
    "C12a": "fewer n_u help training and validation",
    "C12b": "more n_y help training and validation",
    "C12c": "a medium n_u helps the test RMSE",
    "C13a": "open-loop FPRC and closed-loop FPRC+PD both follow all four references; FPRC+PD has "
    "the lower RMSE on each (Table IV)",
    "C13b": "feedback cuts the error of each reference by as much as Table IV shows",
    "C18a": "the hysteresis loops of actuator and reservoir are frequency-independent, over the "
    "measured pressure",
    "C18b": "the hysteresis loops of actuator and reservoir are frequency-independent, over the "
    "commanded pressure",
}


#: Claims that follow from each term of the calibration's objective.
FITTED_BY = {
    "tables": ("C1", "C2", "C3", "C4a", "C7"),
    "orders": ("C1", "C2", "C3", "C7"),
    "C8": ("C8",),
    "C9a": ("C9a",),
    "C9b": ("C9b",),
    "C11": ("C11",),
    "C12": ("C12a", "C12b"),
    "C18": ("C18a", "C18b"),
}

#: Claims about execution times, which do not depend on the rig.
TIMED = ("C5", "C6", "C10")

#: The simulated rig assumes, as the paper does, that the reservoir's bending hardly changes P_o.
_ASSUMED = ("C17",)

#: Terms of an objective that are not claims.
_TERMS = {
    "tables": "Tables II and III",
    "orders": "their orders",
    "plausible": "plausible loops",
    "open_loop": "open-loop Table IV",
}


def status_of(claim: str, terms: Sequence[str]) -> str:
    """Return whether a claim was fitted by the terms of an objective, predicted, or neither.

    C13a is half fitted if the open loop was: it is about the open and the closed loop.
    """
    if claim in TIMED:
        return "timed"
    if claim in _ASSUMED:
        return "assumed"
    if claim == "C13a" and "open_loop" in terms:
        return "half fitted"
    return "fitted" if any(claim in FITTED_BY.get(term, ()) for term in terms) else "predicted"


def fit_in_words(terms: Sequence[str]) -> str:
    """Return what the terms of an objective fit, as a list in a sentence."""
    return in_words([_TERMS.get(term, term) for term in terms]) or "nothing"


def parts_of(claims: Sequence[Mapping[str, str]]) -> list[dict[str, str]]:
    """Return the claims with those that assert several things replaced by their parts."""
    parts = []
    for claim in claims:
        own = [name for name in PARTS if name[:-1] == claim["id"]]
        parts += [{"id": name, "text": PARTS[name]} for name in own] or [dict(claim)]
    return parts


def judge_claims(
    claims: Sequence[Mapping[str, str]], results: Results, published: Mapping[str, Any]
) -> list[dict[str, Any]]:
    """Return one row per claim, or part of a claim, in the order of ``claims``.

    Returns
    -------
    list of dict
        ``id``, ``claim``, ``published``, ``ours``, ``test``, ``basis``, ``verdict``, and
        ``statements``: text, mean, interval, limits and verdict of each.
    """
    rows = []
    for claim in parts_of(claims):
        finding = _TESTS[claim["id"]](results, published)
        rows.append(
            {
                "id": claim["id"],
                "claim": claim["text"],
                "published": finding.published,
                "ours": finding.ours(),
                "test": finding.test(),
                "basis": finding.basis,
                "verdict": finding.verdict,
                "statements": [
                    {
                        "text": each.text,
                        **dict(zip(("mean", "first", "last"), each.interval, strict=True)),
                        "limits": each.limits().removeprefix(f"{each.text} "),
                        "verdict": each.verdict,
                    }
                    for each in finding.statements
                ],
            }
        )
    return rows


def changed_verdicts(ledger: Sequence[Mapping[str, str]], declared: Mapping[str, str]) -> list[str]:
    """Return one line for each claim whose verdict differs from the declared one."""
    ours = {row["id"]: row["verdict"] for row in ledger}
    return [
        f"{claim}: {ours.get(claim, 'not judged')}, "
        f"but {declared.get(claim, 'nothing')} is declared"
        for claim in sorted(ours.keys() | declared.keys(), key=_order)
        if ours.get(claim) != declared.get(claim)
    ]


def _order(claim: str) -> tuple[int, str]:
    number = claim.lstrip("C").rstrip("abc")
    return int(number), claim
