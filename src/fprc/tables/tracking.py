"""Table IV: errors of the closed-loop runs."""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import pandas as pd

from fprc.given import read_yaml
from fprc.paper import PUBLISHED, REFERENCE_NAMES
from fprc.registry import controller_title
from fprc.signals import rms, settled
from fprc.tables.text import format_mean, means_of, spread

TITLE = "Table IV. RMSE of tracking"


def errors(runs: Sequence[Any]) -> pd.DataFrame:
    """RMSE and largest error of closed-loop runs after the settling time, a row each.

    ``runs`` are logs with ``time_s``, ``theta_d_deg`` and ``theta_deg``.
    """
    rows = []
    for log in runs:
        judged = settled(log.channels, log.attributes["settle_s"])
        error = judged["theta_d_deg"] - judged["theta_deg"]
        named = [log.attributes[key] for key in ("reference", "controller", "source")]
        rows.append([*named[:2], rms(error), np.abs(error).max(), named[2]])
    columns = ["reference", "controller", "rmse_deg", "max_abs_error_deg", "source"]
    return pd.DataFrame(rows, columns=columns)


def beside_print(table: pd.DataFrame) -> pd.DataFrame:
    """Return errors with those that the paper prints, before the source; tidy."""
    printed = read_yaml(PUBLISHED)["table_4_tracking_rmse_deg"]
    theirs = [printed.get(row.controller, {}).get(row.reference) for row in table.itertuples()]
    table.insert(len(table.columns) - 1, "published_rmse_deg", theirs)
    return table


def over_seeds(replicates: Sequence[Mapping[str, Any]]) -> pd.DataFrame:
    """Table IV over further seeds: mean, standard deviation, range, tidy."""
    samples = pd.DataFrame(
        [*run.split("/"), error]
        for report in replicates
        for run, error in report["rmse_deg"].items()
    ).set_axis(["reference", "controller", "value"], axis=1)
    table = means_of(samples, "controller", "reference").rename(columns={"mean": "rmse_deg"})
    return beside_print(table.assign(source=replicates[0]["source"]))


def page(table: pd.DataFrame) -> pd.DataFrame:
    """Return Table IV as the paper prints it, ours beside the published numbers."""
    lines = []
    for controller, rows in table.groupby("controller", sort=False):
        label = controller_title(controller)
        ours, theirs = ({"RMSE [deg]": label, "Whose": whose} for whose in ("ours", "paper"))
        for row in rows.itertuples():
            ours[REFERENCE_NAMES[row.reference]] = format_mean(row._asdict(), "rmse_deg")
            theirs[REFERENCE_NAMES[row.reference]] = spread(row.published_rmse_deg, None)
        lines += [ours, theirs] if rows["published_rmse_deg"].notna().any() else [ours]
    return pd.DataFrame(lines).fillna("")
