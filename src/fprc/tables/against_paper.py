"""Our numbers of Tables II to IV over the printed ones."""

from collections.abc import Mapping
from typing import Any

import pandas as pd

from fprc.paper import ERRORS, REFERENCE_NAMES
from fprc.registry import controller_title, has_feedback, title_of

_NUMBERS = {"table2": "II", "table3": "III", "table4": "IV"}
_COLUMNS = [
    "table", "number", "what", "controller", "unit", "ours", "low", "high", "published", "source",
]  # fmt: skip


def in_one(tables: Mapping[str, pd.DataFrame]) -> pd.DataFrame:
    """Return Tables II to IV in one.

    Parameters
    ----------
    tables : Mapping
        Tidy Tables II to IV by their name, ``table2`` or ``table2_seeds``.

    Returns
    -------
    DataFrame
        ``table``; ``number``, II to IV; ``what``; ``controller``, empty in Tables II and III;
        ``unit``; ``ours``, and the ends ``low`` and ``high`` of its interval, which are missing
        without further seeds; ``published``, which is missing where the paper prints no number;
        ``source``.
    """
    rows = [
        {
            "table": name,
            "number": _NUMBERS[name.removesuffix("_seeds")],
            "what": f"{name_of}, {number_of}",
            "controller": row.get("controller", ""),
            "unit": "deg" if "rmse_deg" in row else row["unit"],
            "ours": ours,
            "low": row.get("low", float("nan")),
            "high": row.get("high", float("nan")),
            "published": float("nan") if published is None else published,
            "source": row.get("source", ""),
        }
        for name, table in tables.items()
        for row in table.to_dict("records")
        for name_of, number_of, ours, published in [_named(row)]
    ]
    return pd.DataFrame(rows, columns=_COLUMNS)


def against_paper(tables: Mapping[str, pd.DataFrame]) -> pd.DataFrame:
    """Return ours over the paper's for each number that the paper prints.

    Parameters
    ----------
    tables : Mapping
        As ``in_one`` takes them.

    Returns
    -------
    DataFrame
        The columns of ``in_one``, with ``low`` and ``high`` over the paper's number too; ``ratio``;
        and ``closed_loop``, whether a feedback controller acted.
    """
    rows = in_one(tables).dropna(subset=["ours", "published"])
    return rows.assign(
        ratio=rows["ours"] / rows["published"],
        low=rows["low"] / rows["published"],
        high=rows["high"] / rows["published"],
        closed_loop=rows["controller"].map(has_feedback),
    )


def _named(row: Mapping[str, Any]) -> tuple[str, str, float, float]:
    """Return whose number a row has, which number it is, ours and the printed one."""
    if "controller" in row:
        words = controller_title(row["controller"]), REFERENCE_NAMES[row["reference"]]
        return *words, row["rmse_deg"], row["published_rmse_deg"]
    words = title_of(row["model"]), ERRORS[row["metric"]]
    return *words, row["mean"], row["published_mean"]
