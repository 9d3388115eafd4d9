"""Table of FPRC and its competitors on a recording."""

from collections.abc import Mapping
from typing import Any

import numpy as np
import pandas as pd

from fprc.registry import title_of
from fprc.signals import mean_and_std
from fprc.tables.text import spread


def competitors_table(report: Mapping[str, Any]) -> pd.DataFrame:
    """Errors of each competitor, tidy: mean and deviation over blocks, and on the test data.

    Returns
    -------
    DataFrame
        ``model``, ``block_rmse``, ``block_std``, ``test_rmse``, ``blocks``, ``unit``, ``source``,
        ``reason``; lowest mean first. Models without errors come last and have a reason.
    """
    rows = []
    for cell in report["cells"]:
        errors = cell.get("validation_rmse_kpa", [])
        mean, std = mean_and_std(errors)
        rows.append(
            {
                "model": cell["model"],
                "block_rmse": mean,
                "block_std": std,
                "test_rmse": cell.get("test_rmse_kpa", np.nan),
                "blocks": len(errors),
                "unit": report["unit"],
                "source": report["source"],
                "reason": cell.get("reason", ""),
            }
        )
    return pd.DataFrame(rows).sort_values("block_rmse", kind="stable", ignore_index=True)


def competitors_page(table: pd.DataFrame) -> pd.DataFrame:
    """Return the competitors as a page; a model without errors has the reason in their place."""
    return pd.DataFrame(
        {
            "Model": title_of(row.model),
            f"Blocks [{row.unit}]": row.reason or spread(row.block_rmse, row.block_std),
            f"Test [{row.unit}]": "" if row.reason else spread(row.test_rmse, None),
        }
        for row in table.itertuples()
    )
