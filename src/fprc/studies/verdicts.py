"""Judge claims on pairs of models in families of rigs, and show the verdicts."""

import math
from collections.abc import Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np
import pandas as pd

from fprc.escape import in_words
from fprc.evaluation.paired import NOT_JUDGED, Part, decide_together
from fprc.tables.text import three_digits

#: Symbol after a verdict, by the model or signal that the fit of its rigs favours.
SYMBOLS = {"FPRC": "†", "P_o": "‡"}

#: Numbers of a family by unit.
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
    favours: Mapping[str, str] = {}  #: by term of the calibration's objective: FPRC or P_o


def family_title(name: str) -> str:
    """Return a family's name for readers."""
    return "Bouc-Wen" if name == "bouc_wen" else name.replace("_", "-")


def decide(
    family: Mapping[str, Any], claims: Mapping[str, Claim], numbers: Numbers
) -> pd.DataFrame:
    """Judge claims in one family, see ``fprc.studies.family.judge_family``.

    The table is tidy and has the columns of ``decide_together``: one row for each part of a claim,
    one for a claim that is not judged. Also ``family`` and ``title``; ``favours``, whom the fits of
    its rigs favour, which in ``words`` a symbol says; and ``source``. A ratio below 1 supports the
    claim.
    """
    units, nothing = {cell["unit"] for cell in family["cells"]}, pd.Series(dtype=float)

    def part_of(pair: Pair) -> Part:
        ours, theirs = (np.log(numbers.get(key, nothing)) for key in (pair.ours, pair.theirs))
        by_unit = (ours - theirs - math.log(pair.limit)).dropna().to_dict()
        return Part(pair.text, by_unit, pair.limit, len(units) - len(by_unit))

    def favoured(name: str) -> list[str]:
        favours = claims[name].favours
        return [*dict.fromkeys(favours[term] for term in favours if term in family["fitted"])]

    parts = {name: (claim.text, [*map(part_of, claim.parts)]) for name, claim in claims.items()}
    table = pd.DataFrame(decide_together(parts))
    marks = table["id"].map(lambda name: "".join(SYMBOLS[who] for who in favoured(name)))
    # of a family without any number these would not be numbers
    return table.astype(dict.fromkeys(("mean", "low", "high", "stable"), float)).assign(
        family=family["name"],
        title=family_title(family["name"]),
        words=table["words"] + marks.where(table["verdict"] != NOT_JUDGED, ""),
        favours=table["id"].map(lambda name: in_words(favoured(name)) or "nobody"),
        source="sim",
    )


def claims_page(verdicts: pd.DataFrame) -> pd.DataFrame:
    """Return one row per claim: its verdict in each family, and the means of its parts."""
    table = verdicts.assign(mean=verdicts["mean"].map(three_digits))
    rows = table.groupby(["id", "claim", "title"], sort=False).agg(
        {"words": "first", "mean": ", ".join}
    )
    texts = (rows["words"] + " " + rows["mean"]).str.rstrip()
    page = texts.unstack("title")[verdicts["title"].unique()]
    return page.sort_index().reset_index(names=["Id", "Claim"])


def wide(
    table: pd.DataFrame, rows: Mapping[str, str], columns: Any, headings: Mapping[str, Any]
) -> pd.DataFrame:
    """Return the column ``text`` as a page, a column for each of the ``headings``.

    ``rows`` has by the columns that tell the rows apart their headings.
    """
    page = table.pivot(index=list(rows), columns=columns, values="text")
    order = table.set_index(list(rows)).index.unique()
    page = page.reindex(index=order, columns=list(headings.values()))
    page = page.set_axis(list(headings), axis=1).astype(object).fillna("-")
    return page.reset_index().rename(columns=rows)
