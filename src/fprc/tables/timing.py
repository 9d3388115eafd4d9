"""Execution times."""

from collections.abc import Mapping
from typing import Any

import pandas as pd

from fprc.intervals import mean_and_std
from fprc.registry import title_of
from fprc.tables.text import spread, three_digits


def timing(report: Mapping[str, Any], published: Mapping[str, Any]) -> pd.DataFrame:
    """Table II, execution times in s and us per sample, both modes, tidy."""
    rows = []
    for entry in report["times"]:
        mean, std = mean_and_std(entry["seconds"])
        printed = published["table_2_models"].get(entry["model"], {})
        theirs = (
            printed.get("train_time_s", (None, None))
            if entry["phase"] == "train"
            else [value / 1000.0 for value in printed.get("test_time_ms", ())] or (None, None)
        )
        rows.append(
            {
                "model": entry["model"],
                "metric": f"{entry['phase']}_time",
                "mode": entry["mode"],
                "unit": "s",
                "mean": mean,
                "std": std,
                "us_per_sample": 1e6 * mean / entry["samples"],
                "samples": entry["samples"],
                "repeats": len(entry["seconds"]),
                "published_mean": theirs[0],
                "published_std": theirs[1],
                "threads": report["threads"],
                "cpu": report["cpu"],
                "source": report["source"],
            }
        )
    return pd.DataFrame(rows)


def timing_page(table: pd.DataFrame) -> pd.DataFrame:
    """Return the times as a page."""
    phases = {"train_time": "Training", "test_time": "Test"}
    return pd.DataFrame(
        {
            "Model": title_of(row.model),
            "Phase": phases[row.metric],
            "Mode": row.mode,
            "Ours [s]": spread(row.mean, row.std),
            "Ours [us per sample]": three_digits(row.us_per_sample),
            "Paper [s]": spread(row.published_mean, row.published_std) or "-",
        }
        for row in table.itertuples()
    )
