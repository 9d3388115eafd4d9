"""Table IV: errors of the closed-loop runs."""

from collections.abc import Mapping, Sequence
from typing import Any

import pandas as pd

from fprc.paper import REFERENCE_NAMES
from fprc.registry import controller_title
from fprc.tables.figure_data import error_summary
from fprc.tables.models import means_of
from fprc.tables.text import format_mean, spread


def tracking(runs: Sequence[Any], published: Mapping[str, Any]) -> pd.DataFrame:
    """Table IV: errors of every controller on every reference, tidy, from closed-loop logs."""
    errors = error_summary(runs)
    table = errors[["controller", "reference", "rmse_deg", "max_abs_error_deg"]]
    return table.assign(published_rmse_deg=_printed(errors, published), source=errors["source"])


def _printed(table: pd.DataFrame, published: Mapping[str, Any]) -> list[float | None]:
    printed = published["table_4_tracking_rmse_deg"]
    return [printed.get(row.controller, {}).get(row.reference) for row in table.itertuples()]


def tracking_over_seeds(
    replicates: Sequence[Mapping[str, Any]], published: Mapping[str, Any]
) -> pd.DataFrame:
    """Table IV over further seeds: mean, standard deviation, range, tidy."""
    samples = pd.DataFrame(
        {
            **dict(zip(("reference", "controller"), run.split("/"), strict=True)),
            "value": error,
            "source": report["source"],
        }
        for report in replicates
        for run, error in report["rmse_deg"].items()
    )
    table = means_of(samples, "controller", "reference").rename(columns={"mean": "rmse_deg"})
    return table.assign(published_rmse_deg=_printed(table, published), source=samples["source"][0])


def tracking_page(table: pd.DataFrame) -> pd.DataFrame:
    """Return Table IV as the paper prints it, ours beside the published numbers."""
    page = []
    for controller, rows in table.groupby("controller", sort=False):
        label = controller_title(controller)
        line, theirs = ({"RMSE [deg]": label, "Whose": whose} for whose in ("ours", "paper"))
        for row in rows.itertuples():
            line[REFERENCE_NAMES[row.reference]] = format_mean(row._asdict(), "rmse_deg")
            theirs[REFERENCE_NAMES[row.reference]] = spread(row.published_rmse_deg, None)
        page.append(line)
        if rows["published_rmse_deg"].notna().any():
            page.append(theirs)
    return pd.DataFrame(page).fillna("")
