"""How fast we are beside other libraries."""

from collections.abc import Mapping
from typing import Any

import numpy as np
import pandas as pd

from fprc.tables.text import three_digits


def benchmark(report: Mapping[str, Any]) -> pd.DataFrame:
    """Return each comparison: medians, and the ratio round by round, tidy.

    Where the two differ by more than the limit, there is no ratio.
    """
    rows = []
    for each in report["comparisons"]:
        ours, theirs = (np.array(each["seconds"][who]) for who in ("ours", "theirs"))
        ratios = theirs / ours if each["agrees"] else np.array([np.nan])
        rows.append(
            {
                **{key: each[key] for key in ("work", "against", "aim", "samples")},
                "ours_s": np.median(ours) if ours.size else np.nan,
                "theirs_s": np.median(theirs) if theirs.size else np.nan,
                "ratio": np.median(ratios),
                "ratio_low": ratios.min(),
                "ratio_high": ratios.max(),
                "difference": each["difference"],
                "limit": each["limit"],
            }
        )
    for each in report["real_time"]:
        times = each["simulated_s"] / np.array(each["seconds"])
        rows.append(
            {
                "work": f"Simulated rig, {each['simulated_s']:g} s, {each['loop']}",
                "against": "real time",
                "aim": each["aim"],
                "samples": 0,
                "ours_s": np.median(each["seconds"]),
                "theirs_s": each["simulated_s"],
                "ratio": np.median(times),
                "ratio_low": times.min(),
                "ratio_high": times.max(),
            }
        )
    return pd.DataFrame(rows)


def benchmark_page(table: pd.DataFrame) -> pd.DataFrame:
    """Return the comparisons as a person reads them."""
    rows = []
    for row in table.itertuples():
        scale, unit = (1e6 / row.samples, "us") if row.samples else (1.0, "s")
        disagree = np.isnan(row.ratio)
        rows.append(
            (
                row.work,
                row.against,
                "" if disagree else f"{three_digits(row.ours_s * scale)} {unit}",
                "" if disagree else f"{three_digits(row.theirs_s * scale)} {unit}",
                "results differ" if disagree else _ratio(row),
                f"{row.aim:g}",
                "" if np.isnan(row.difference) else f"{row.difference:.0e}",
            )
        )
    columns = ["Work", "Against", "Ours", "Theirs", "Times faster", "Aim", "Results differ by"]
    return pd.DataFrame(rows, columns=columns)


def _ratio(row: Any) -> str:
    low, high = three_digits(row.ratio_low), three_digits(row.ratio_high)
    return f"{three_digits(row.ratio)} ({low} to {high})"


def growth(report: Mapping[str, Any]) -> pd.DataFrame:
    """Return the cost over size: median seconds and peak memory, tidy."""
    table = pd.DataFrame(report["growth"])
    return table.assign(seconds=[np.median(each) for each in table["seconds"]])


def exponent(sizes: np.ndarray, cost: np.ndarray) -> float:
    """Return the exponent p of cost ~ size^p, by least squares of the logarithms."""
    return float(np.polyfit(np.log(sizes), np.log(cost), 1)[0])
