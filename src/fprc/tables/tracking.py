"""Table IV: errors of the closed-loop runs."""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import pandas as pd

from fprc.paper import REFERENCE_NAMES
from fprc.registry import controller_title
from fprc.signals import rms, settled
from fprc.tables.models import means_of
from fprc.tables.text import format_mean, spread

TITLE = "Table IV. RMSE of tracking"


def error_summary(runs: Sequence[Any]) -> pd.DataFrame:
    """RMSE and largest error of closed-loop runs after the settling time, a row each.

    ``runs`` are logs with ``time_s``, ``theta_d_deg`` and ``theta_deg``.
    """
    rows = []
    for log in runs:
        named, judged = log.attributes, settled(log.channels, log.attributes["settle_s"])
        error = judged["theta_d_deg"] - judged["theta_deg"]
        rows.append(
            {
                "reference": named["reference"],
                "controller": named["controller"],
                "rmse_deg": rms(error),
                "max_abs_error_deg": np.abs(error).max(),
                "source": named["source"],
            }
        )
    return pd.DataFrame(rows)


def tracking(runs: Sequence[Any], published: Mapping[str, Any]) -> pd.DataFrame:
    """Table IV: errors of every controller on every reference, tidy, from closed-loop logs."""
    table = error_summary(runs)[
        ["controller", "reference", "rmse_deg", "max_abs_error_deg", "source"]
    ]
    return _beside_print(table, published)


def _beside_print(table: pd.DataFrame, published: Mapping[str, Any]) -> pd.DataFrame:
    printed = published["table_4_tracking_rmse_deg"]
    theirs = [printed.get(row.controller, {}).get(row.reference) for row in table.itertuples()]
    table.insert(len(table.columns) - 1, "published_rmse_deg", theirs)
    return table


def tracking_over_seeds(
    replicates: Sequence[Mapping[str, Any]], published: Mapping[str, Any]
) -> pd.DataFrame:
    """Table IV over further seeds: mean, standard deviation, range, tidy."""
    samples = pd.DataFrame(
        [*run.split("/"), error]
        for report in replicates
        for run, error in report["rmse_deg"].items()
    ).set_axis(["reference", "controller", "value"], axis=1)
    table = means_of(samples, "controller", "reference").rename(columns={"mean": "rmse_deg"})
    return _beside_print(table.assign(source=replicates[0]["source"]), published)


def tracking_page(table: pd.DataFrame) -> pd.DataFrame:
    """Return Table IV as the paper prints it, ours beside the published numbers."""
    page = []
    for controller, rows in table.groupby("controller", sort=False):
        label = controller_title(controller)
        line, theirs = ({"RMSE [deg]": label, "Whose": whose} for whose in ("ours", "paper"))
        for row in rows.itertuples():
            line[REFERENCE_NAMES[row.reference]] = format_mean(row._asdict(), "rmse_deg")
            theirs[REFERENCE_NAMES[row.reference]] = spread(row.published_rmse_deg, None)
        page += [line, theirs] if rows["published_rmse_deg"].notna().any() else [line]
    return pd.DataFrame(page).fillna("")
