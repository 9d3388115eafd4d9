"""Tables of the verdicts on claims B1-B8: what they rest on, and what the rigs were fitted to."""

from collections.abc import Mapping, Sequence
from typing import Any

import pandas as pd

from fprc.escape import in_words
from fprc.studies.beyond.claims import beside_b1
from fprc.studies.beyond.measurements import family_title
from fprc.tables.text import format_mean, three_digits

Ledgers = Sequence[Sequence[Mapping[str, Any]]]

#: Symbol after a verdict, by the model or signal that the fit of its rigs favours.
_SYMBOLS = {"FPRC": "†", "P_o": "‡"}


def claims(ledgers: Ledgers) -> pd.DataFrame:
    """Claims B1-B8 in each family, tidy: one row for each part, one for a claim not judged.

    Parameters
    ----------
    ledgers : sequence
        Of each family, the rows of ``beyond.claims.judge_family``.

    Returns
    -------
    DataFrame
        ``world``, ``id``, ``claim``, ``part``, ``ratio`` (a difference if not), ``mean``, ``low``,
        ``high``, ``verdict`` (the claim's), ``p``, ``stable``, ``units``, ``dropped``,
        ``favours`` (what the fit of the rigs favours), ``fitted`` (what they were fitted to) and
        ``source``. A claim that is not judged has no numbers.
    """
    kept = ("verdict", "p", "stable", "units", "dropped")
    nothing = {"text": "", "ratio": "", "mean": None, "low": None, "high": None}
    return pd.DataFrame(
        {
            **{key: row[key] for key in ("world", "title", "id", "claim")},
            "part": part["text"],
            **{key: part[key] for key in ("ratio", "mean", "low", "high")},
            **{key: row[key] for key in kept},
            "favours": in_words(dict.fromkeys(whom for whom, _ in row["fitted"])) or "nobody",
            "fitted": "; ".join(what for _, what in row["fitted"]),
            "source": "sim",
        }
        for ledger in ledgers
        for row in ledger
        for part in (row["parts"] or [nothing])
    )


def claims_page(ledgers: Ledgers) -> pd.DataFrame:
    """Return one row per claim: its verdict in each family, and what the fit favours."""
    return pd.DataFrame(
        {
            "Id": of_claim[0]["id"],
            "Claim": of_claim[0]["claim"],
            **{row["title"]: f"{verdict_of(row)} {means_of(row)}".rstrip() for row in of_claim},
        }
        for of_claim in zip(*ledgers, strict=True)
    )


def verdict_of(row: Mapping[str, Any]) -> str:
    """Return the words of a verdict, with the symbol of what the fit favours."""
    whose = {whom for whom, _ in row["fitted"]} if row["parts"] else set()
    symbols = "".join(symbol for whom, symbol in _SYMBOLS.items() if whom in whose)
    return f"{row['words']}{symbols}"


def means_of(row: Mapping[str, Any]) -> str:
    """Return the mean of each part, in three digits."""
    return ", ".join(three_digits(part["mean"]) for part in row["parts"])


def fitted_page(ledgers: Ledgers) -> pd.DataFrame:
    """Return whom the fit of rigs favours, what was fitted, the claims and families concerned."""
    why = ["In favour of", "What was fitted"]
    found = pd.DataFrame(
        (
            (f"{whom} {_SYMBOLS[whom]}", what, row["id"], row["title"])
            for of_claim in zip(*ledgers, strict=True)
            for row in of_claim
            if row["parts"]
            for whom, what in row["fitted"]
        ),
        columns=[*why, "Claims", "Rigs"],
    )
    # claims of the same families share a row
    for key, joined in (("Claims", "Rigs"), ("Rigs", "Claims")):
        groups = found.groupby([*why, key], sort=False)[joined]
        found = groups.agg(", ".join).reset_index()
    return found[[*why, "Claims", "Rigs"]]


def details_page(ledgers: Ledgers) -> pd.DataFrame:
    """Return what each verdict rests on: intervals, p, agreeing subsets, units."""
    rows = [row for of_claim in zip(*ledgers, strict=True) for row in of_claim if row["parts"]]
    columns = {
        "Id": [row["id"] for row in rows],
        "Rigs": [row["title"] for row in rows],
        "Verdict": [verdict_of(row) for row in rows],
        "Mean": [means_of(row) for row in rows],
        "Interval": [
            ", ".join(
                f"{three_digits(part['low'])} to {three_digits(part['high'])}"
                for part in row["parts"]
            )
            for row in rows
        ],
        "p": ["< 0.001" if row["p"] < 0.001 else three_digits(row["p"]) for row in rows],
        "Subsets that agree": [
            "-" if row["stable"] is None else f"{100 * row['stable']:.0f} %" for row in rows
        ],
        "Units": [str(row["units"]) for row in rows],
        "Units lost": [str(row["dropped"]) for row in rows],
    }
    return pd.DataFrame(columns, dtype=object)


def beside_page(families: Sequence[Mapping[str, Any]]) -> pd.DataFrame:
    """Return the ratios of ``beside_b1`` with their intervals, a column per family."""
    columns = {
        family_title(family["name"]): {
            text: format_mean(ends, "mean") if ends else "-"
            for text, ends in beside_b1(family).items()
        }
        for family in families
    }
    return pd.DataFrame(columns).reset_index(names="Ratio")
