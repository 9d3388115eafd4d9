"""The fitted rigs side by side: errors, and verdicts of the claims."""

from collections.abc import Mapping, Sequence
from typing import Any

import pandas as pd

from fprc.paper import ERRORS, REFERENCE_NAMES
from fprc.registry import controller_title, title_of
from fprc.tables.models import over_seeds
from fprc.tables.text import format_mean, spread
from fprc.tables.tracking import tracking_over_seeds

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
    rows = []
    for table, trained_on in (("II", "sweep"), ("III", "complex")):
        rows += [
            {
                "number": f"Table {table}, {title_of(row.model)}, {ERRORS[row.metric]} [kPa]",
                "published": row.published_mean,
                "mean": row.mean,
                "low": row.low,
                "high": row.high,
            }
            for row in over_seeds(models, published, trained_on).itertuples(index=False)
        ]
    tracking = tracking_over_seeds(controls, published)
    for row in tracking[tracking["published_rmse_deg"].notna()].itertuples(index=False):
        if (row.controller, row.gain) in _RUNS:
            rows.append(
                {
                    "number": f"Table IV, {controller_title(row.controller)}, "
                    f"{REFERENCE_NAMES[row.reference]} [deg]",
                    "published": row.published_rmse_deg,
                    "mean": row.rmse_deg,
                    "low": row.low,
                    "high": row.high,
                }
            )
    table = pd.DataFrame(rows)
    return table.assign(deviation=table["mean"] / table["published"] - 1.0)


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
