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
    """RMSE and largest error of closed-loop runs after the settling time.

    Parameters
    ----------
    runs : sequence
        Logs with ``time_s``, ``theta_d_deg`` and ``theta_deg``.

    Returns
    -------
    DataFrame
        ``reference``, ``controller``, ``rmse_deg``, ``max_abs_error_deg``, ``source``.
    """
    rows = []
    for log in runs:
        named = log.attributes
        judged = settled(log.channels, named["settle_s"])
        error = judged["theta_d_deg"] - judged["theta_deg"]
        rows.append(
            {
                **{key: named[key] for key in ("reference", "controller")},
                "rmse_deg": rms(error),
                "max_abs_error_deg": np.abs(error).max(),
                "source": named["source"],
            }
        )
    return pd.DataFrame(rows)


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


def over_starts(replicates: Sequence[Mapping[str, Any]]) -> str:
    """Return a sentence on how much Table IV depends on where FPRC's clustering begins."""
    shares: dict[str, list[float]] = {"fprc": [], "fprc_pd": []}
    ratios = []
    for report in replicates:
        for run, errors in report["fprc_rmse_over_starts"].items():
            shares[run.partition("/")[2]].append(np.std(errors, ddof=1) / np.mean(errors))
            ratios.append(max(errors) / min(errors))
    opened, closed = (100.0 * np.mean(of_controller) for of_controller in shares.values())
    return (
        f"Where FPRC's clustering begins, among {len(errors)} starts on the same rows, changes the "
        f"RMSE of FPRC by {opened:.1f} % and that of FPRC+PD by {closed:.1f} % (standard deviation "
        f"within a seed, mean over the references that the paper prints); at most, the worst "
        f"start's is {max(ratios):.2f} times the best one's."
    )


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
