"""Judge claims on pairs of models in families of rigs, and show the verdicts."""

import math
from collections.abc import Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np
import pandas as pd

from fprc.escape import in_words
from fprc.evaluation.paired import NOT_JUDGED, Part, decide_together
from fprc.studies.beyond.measurements import family_title
from fprc.tables.text import three_digits

#: Symbol after a verdict, by the model or signal that the fit of its rigs favours.
SYMBOLS = {"FPRC": "†", "P_o": "‡"}
#: Headings of the page of details, by the columns of the table.
_DETAILS = {
    "id": "Id", "title": "Rigs", "words": "Verdict", "mean": "Mean", "interval": "Interval",
    "p": "p", "stable": "Subsets that agree", "units": "Units", "dropped": "Units lost",
}  # fmt: skip


#: Numbers of a family, one per simulated rig; one level of the index is the ``unit``.
Numbers = Mapping[tuple[Any, ...], pd.Series]


class Pair(NamedTuple):
    """An error over that of another model; a ratio below the limit is better."""

    ours: tuple[Any, ...]  #: a key of ``Numbers``
    theirs: tuple[Any, ...]  #: the same
    text: str  #: what is compared, for readers
    limit: float = 1.0


class Claim(NamedTuple):
    """What is claimed, what is compared, and which fits of the rig favour a side."""

    text: str
    parts: Sequence[Pair]
    #: By term of the calibration's objective: what its fit favours, and what was fitted.
    favours: Mapping[str, tuple[str, str]] = {}


_NONE = pd.Series(index=pd.Index([], name="unit"), dtype=float)


def part_of(pair: Pair, numbers: Numbers, family: Mapping[str, Any]) -> Part:
    """Return a pair as it was measured in a family."""
    ours, theirs = (np.log(numbers.get(key, _NONE)) for key in (pair.ours, pair.theirs))
    values = ours - theirs - math.log(pair.limit)
    # simulations of one rig with several seeds are one unit
    by_unit = values.dropna().groupby(level="unit").mean().to_dict()
    dropped = len({cell["unit"] for cell in family["cells"]}) - len(by_unit)
    return Part(pair.text, by_unit, pair.limit, dropped)


def judge_family(
    family: Mapping[str, Any],
    claims: Mapping[str, Claim],
    numbers: Numbers,
) -> pd.DataFrame:
    """Judge claims in one family.

    Parameters
    ----------
    family : Mapping
        See ``fprc.studies.beyond.measurements``; ``fitted``: the terms its rigs were fitted to.
    claims : Mapping
        By their ids.

    Returns
    -------
    DataFrame
        Tidy, with the columns of ``decide_together``: one row for each part of a claim, one for a
        claim that is not judged. Also ``world`` and ``title``; ``fits``, those that bear on the
        claim, pairs of what each favours and what was fitted; the same as text, ``favours`` and
        ``fitted``; and ``source``. In ``words`` a symbol says what the fits favour. A ratio below 1
        supports the claim.
    """
    rows = []
    parts = {
        name: (claim.text, [part_of(pair, numbers, family) for pair in claim.parts])
        for name, claim in claims.items()
    }
    for row in decide_together(parts):
        favours = claims[row["id"]].favours
        fits = [*dict.fromkeys(favours[term] for term in favours if term in family["fitted"])]
        favoured = list(dict.fromkeys(whom for whom, _ in fits))
        marks = [SYMBOLS[whom] for whom in favoured if row["verdict"] != NOT_JUDGED]
        rows.append(
            {
                **row,
                "world": family["name"],
                "title": family_title(family["name"]),
                "words": "".join([row["words"], *marks]),
                "fits": fits,
                "favours": in_words(favoured) or "nobody",
                "fitted": "; ".join(what for _, what in fits),
                "source": "sim",
            }
        )
    # of a family without any number these would not be numbers
    return pd.DataFrame(rows).astype(dict.fromkeys(("mean", "low", "high", "stable"), float))


def by_claim(verdicts: pd.DataFrame) -> pd.DataFrame:
    """Return a row for each claim and family, claim by claim.

    Parameters
    ----------
    verdicts : DataFrame
        One row for each part of a claim, see ``judge_family``; of all families.

    Returns
    -------
    DataFrame
        Its columns; ``mean`` and ``interval`` are the numbers of all parts as text.
    """
    ends = zip(verdicts["low"], verdicts["high"], strict=True)
    table = verdicts.assign(
        mean=list(map(three_digits, verdicts["mean"])),
        interval=[f"{three_digits(low)} to {three_digits(high)}" for low, high in ends],
    )
    merged = dict.fromkeys(table, "first") | dict.fromkeys(("mean", "interval"), ", ".join)
    rows = table.groupby(["id", "title"], sort=False).agg(merged).reset_index(drop=True)
    return rows.sort_values("id", kind="stable")


def claims_page(verdicts: pd.DataFrame) -> pd.DataFrame:
    """Return one row per claim: its verdict in each family, and the means of its parts."""
    rows = by_claim(verdicts)
    texts = (rows["words"] + " " + rows["mean"]).str.rstrip()
    page = rows.assign(text=texts).pivot(index=["id", "claim"], columns="title", values="text")
    return page[verdicts["title"].unique()].reset_index(names=["Id", "Claim"])


def fitted_page(verdicts: pd.DataFrame) -> pd.DataFrame:
    """Return whom the fit of rigs favours, what was fitted, the claims and families concerned."""
    why = ["In favour of", "What was fitted"]
    rows = by_claim(verdicts[verdicts["verdict"] != NOT_JUDGED])
    found = pd.DataFrame(
        (
            (f"{whom} {SYMBOLS[whom]}", what, row.id, row.title)
            for row in rows.itertuples()
            for whom, what in row.fits
        ),
        columns=[*why, "Claims", "Rigs"],
    )
    # claims of the same families share a row
    for key, joined in (("Claims", "Rigs"), ("Rigs", "Claims")):
        groups = found.groupby([*why, key], sort=False)[joined]
        found = groups.agg(", ".join).reset_index()
    return found[[*why, "Claims", "Rigs"]]


def details_page(verdicts: pd.DataFrame) -> pd.DataFrame:
    """Return what each verdict rests on: intervals, p, agreeing subsets, units."""
    rows = by_claim(verdicts[verdicts["verdict"] != NOT_JUDGED])
    texts = {
        "p": ["< 0.001" if p < 0.001 else three_digits(p) for p in rows["p"]],
        "stable": ["-" if pd.isna(part) else f"{100 * part:.0f} %" for part in rows["stable"]],
        "units": rows["units"].astype(str),
        "dropped": rows["dropped"].astype(str),
    }
    return rows.assign(**texts)[list(_DETAILS)].rename(columns=_DETAILS)
