"""Our numbers of Tables II to IV over the printed ones."""

from collections.abc import Mapping

import pandas as pd

from fprc.paper import ERRORS, REFERENCE_NAMES
from fprc.registry import controller_title, has_feedback, title_of

_NUMBERS = {"table2": "II", "table3": "III", "table4": "IV"}


def against_paper(tables: Mapping[str, pd.DataFrame]) -> pd.DataFrame:
    """Return ours over the paper's for each number that the paper prints.

    Parameters
    ----------
    tables : Mapping
        Tidy Tables II to IV by their name, ``table2`` or ``table2_seeds``.

    Returns
    -------
    DataFrame
        ``table``; ``number``, II to IV; ``what``; ``unit``; ``ours``, ``published``; ``ratio``, and
        the ends ``low`` and ``high`` of its interval, which are missing without further seeds.
        ``closed_loop`` says whether a feedback controller acted.
    """
    rows = [
        {
            "table": name,
            "number": _NUMBERS[name.removesuffix("_seeds")],
            "what": _what(row),
            "unit": "deg" if "rmse_deg" in row else row["unit"],
            "ours": ours,
            "published": published,
            "ratio": ours / published,
            "low": row.get("low", float("nan")) / published,
            "high": row.get("high", float("nan")) / published,
            "closed_loop": has_feedback(row.get("controller", "")),
        }
        for name, table in tables.items()
        for row in table.to_dict("records")
        for ours, published in [_means(row)]
        if pd.notna(ours) and pd.notna(published)
    ]
    return pd.DataFrame(rows)


def _means(row: Mapping[str, float]) -> tuple[float, float]:
    if "rmse_deg" in row:
        return row["rmse_deg"], row["published_rmse_deg"]
    return row["mean"], row["published_mean"]


def _what(row: Mapping[str, str]) -> str:
    if "controller" not in row:
        return f"{title_of(row['model'])}, {ERRORS[row['metric']]}"
    return f"{controller_title(row['controller'])}, {REFERENCE_NAMES[row['reference']]}"
