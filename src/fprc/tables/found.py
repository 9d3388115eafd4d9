"""What a run has found, in sentences."""

from collections.abc import Mapping, Sequence
from typing import Any

import pandas as pd

from fprc.escape import in_words
from fprc.registry import controller_title, title_of
from fprc.tables.text import three_digits

#: Claims in the order of the sentence, and what their ``rig`` is (``fprc.claims.ledger``).
_SIMULATED = {
    "that the simulated rig was not fitted to": ("predicted",),
    "that the rig was fitted to at least in part": ("fitted", "half fitted"),
    "that the rig assumes": ("assumed",),
    "on execution times": ("timed",),
}
_MEASURED = {
    "on accuracy and control": ("predicted", "fitted", "half fitted", "assumed"),
    "on execution times": ("timed",),
}


def found(
    claims: Sequence[Mapping[str, Any]], tables: Mapping[str, pd.DataFrame], *, simulated: bool
) -> list[str]:
    """Return up to three sentences: claims that hold, errors of the models, errors of tracking.

    Parameters
    ----------
    claims : sequence of Mapping
        Rows of the ledger, with ``verdict`` and ``rig``; those that are not informative do not
        count.
    tables : Mapping
        Tidy Tables II and IV, ``table2_seeds`` or else ``table2``, ``table4_seeds`` or ``table4``.
        A table that is not there has no sentence.
    simulated : bool
        Whether the data come from the simulated rig, which was fitted to some claims.
    """
    return [
        *_claims(claims, _SIMULATED if simulated else _MEASURED),
        *_errors(tables, "table2", "The test RMSE in Table II", "model", "mean", "published_mean"),
        *_errors(
            tables, "table4", "The RMSE of tracking in Table IV", "controller", "rmse_deg",
            "published_rmse_deg",
        ),
    ]  # fmt: skip


def _claims(claims: Sequence[Mapping[str, Any]], kinds: Mapping[str, Sequence[str]]) -> list[str]:
    parts: list[str] = []
    for words, statuses in kinds.items():
        verdicts = [
            claim["verdict"]
            for claim in claims
            if claim["rig"] in statuses and claim["verdict"] != "not informative"
        ]
        if verdicts:
            held = verdicts.count("reproduced")
            others = [
                f"{verdicts.count(verdict)} {verdict}"
                for verdict in ("not reproduced", "undecided")
                if verdict in verdicts
            ]
            why = f" ({', '.join(others)})" if others else ""
            # the first part says of what
            what = "" if parts else "claims of the paper "
            parts.append(f"{held} of {len(verdicts)} {what}{words}{why}")
    return [f"We reproduce {in_words(parts)}."] if parts else []


def _errors(
    tables: Mapping[str, pd.DataFrame], name: str, what: str, who: str, ours: str, printed: str
) -> list[str]:
    """Return a sentence with the errors of each model or controller, or their range."""
    table = tables.get(f"{name}_seeds", tables.get(name))
    if table is None:
        return []
    if "metric" in table:
        table = table[table["metric"] == "test_rmse"]
    if "reference" in table and table[printed].notna().any():
        # only then are our range and the paper's over the same references
        table = table[table["reference"].isin(table.loc[table[printed].notna(), "reference"])]
    unit = "deg" if who == "controller" else table["unit"].iloc[0]
    title = controller_title if who == "controller" else title_of
    over = f", mean over {table['seeds'].max()} seeds," if "seeds" in table else ""
    parts: list[str] = []
    for key, rows in table.groupby(who, sort=False):
        paper = f" (paper: {_range(rows[printed])})" if rows[printed].notna().any() else ""
        parts.append(f"{_range(rows[ours])} {unit} for {title(str(key))}{paper}")
    return [f"{what}{over} is {in_words(parts)}."] if parts else []


def _range(values: "pd.Series[float]") -> str:
    low, high = three_digits(values.min()), three_digits(values.max())
    return low if low == high else f"{low} to {high}"
