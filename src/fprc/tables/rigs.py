"""The rigs of config/rigs side by side: errors, and verdicts of the claims."""

from collections.abc import Mapping, Sequence
from typing import Any

import pandas as pd

from fprc.tables.text import format_mean, spread
from fprc.tables.tracking import all_over_seeds

#: Runs of Table IV that the paper prints, and one that it calls by the same name.
_RUNS = (("fprc", "none"), ("fprc_pd", "identified"))


def rig_errors(
    models: Sequence[Mapping[str, Any]],
    controls: Sequence[Mapping[str, Any]],
    published: Mapping[str, Any],
) -> pd.DataFrame:
    """Return the errors of Tables II to IV on one rig that the paper prints, tidy.

    Columns ``number``, ``published``, ``mean``, ``low``, ``high``, and ``deviation``, which is
    ours / print - 1.
    """
    table = all_over_seeds(models, controls, published)
    runs = pd.MultiIndex.from_frame(table[["controller", "gain"]]).isin(_RUNS)
    table = table[table["controller"].isna() | (runs & table["published"].notna())]
    number = "Table " + table["table"] + ", " + table["what"] + " [" + table["unit"] + "]"
    table = table.assign(number=number, deviation=table["mean"] / table["published"] - 1.0)
    columns = ["number", "published", "mean", "low", "high", "deviation"]
    return table[columns].reset_index(drop=True)


def rigs_page(
    errors: Mapping[str, pd.DataFrame], ledgers: Mapping[str, Sequence[Mapping[str, str]]]
) -> pd.DataFrame:
    """Return errors and verdicts, a column per rig.

    Parameters
    ----------
    errors : Mapping
        Result of ``rig_errors``, by rig.
    ledgers : Mapping
        ``id``, ``claim``, ``verdict`` and ``rig`` (fitted, predicted, ...) of each claim, by rig.
    """
    first = next(iter(errors))
    page = pd.DataFrame(
        {
            "Number or claim": errors[first]["number"],
            "Paper": [spread(value, None) for value in errors[first]["published"]],
        }
    )
    for name, table in errors.items():
        page[f"Rig {name}"] = [
            f"{format_mean(row, 'mean')}, {100 * row['deviation']:+.0f} %"
            for row in table.to_dict("records")
        ]
    claims = pd.DataFrame(
        {
            "Number or claim": [f"{row['id']}: {row['claim']}" for row in ledgers[first]],
            "Paper": "holds",
            **{
                f"Rig {name}": [f"{row['verdict']} ({row['rig']})" for row in ledger]
                for name, ledger in ledgers.items()
            },
        }
    )
    return pd.concat([page, claims], ignore_index=True)
