"""Measured cost of one rig or job, and estimated cost of a thousand and a million rigs."""

from collections.abc import Mapping
from typing import Any

import numpy as np
import pandas as pd

from fprc.tables.text import three_digits

#: Files of a job: its result, its log, and Snakemake's record of the result.
FILES_PER_JOB = 3
RIGS = (1_000, 1_000_000)


def costs(scale: Mapping[str, Any]) -> pd.DataFrame:
    """Processor seconds of one rig, grid cell, closed-loop second and job start."""
    work = [
        ("one rig of the ensemble: draws, both logs, Tables II to IV", "rig", "rigs"),
        ("one cell of a grid: five folds and a test of FPRC", "cell", "cells"),
        ("one closed-loop second: rig, FPRC+PD and both pressure loops", "loop", "s"),
    ]
    rows = [
        (what, three_digits(scale[key]["cpu_s"]), f"{scale[key]['measured']:g} {unit}")
        for what, key, unit in work
    ]
    start = "start of a job under Slurm: Snakemake twice, imports once"
    rows.append((start, three_digits(start_of_job(scale, 1)), "1 start"))
    return pd.DataFrame(rows, columns=["What", "Core-seconds", "Mean of"])


def dag(scale: Mapping[str, Any]) -> pd.DataFrame:
    """Time and memory for planning all jobs, and time for planning one of them."""
    whole = {planned["jobs"]: planned for planned in scale["dag"]}
    return pd.DataFrame(
        {
            "Jobs": f"{jobs:,}",
            "All of them [core-seconds]": three_digits(whole[jobs]["cpu_s"])
            if jobs in whole
            else "not measured",
            "Memory [MB]": f"{whole[jobs]['peak_mb']:.0f}" if jobs in whole else "not measured",
            "One of them [core-seconds]": three_digits(alone["cpu_s"]),
        }
        for jobs, alone in ((planned["jobs"], planned) for planned in scale["alone"])
    )


def plan(scale: Mapping[str, Any]) -> pd.DataFrame:
    """Cost of an ensemble over its size and the size of its chunks.

    Planning is interpolated linearly between the measured sizes, and extrapolated beyond them.
    """
    chunks = sorted({1, scale["chunk"], 100, 1000})
    rows = []
    for rigs in RIGS:
        for chunk in chunks:
            jobs = -(-rigs // chunk)
            busy_s = rigs * scale["rig"]["cpu_s"] + jobs * start_of_job(scale, jobs)
            rows.append(
                {
                    "Rigs": f"{rigs:,}",
                    "Chunk": f"{chunk:,}",
                    "Jobs": f"{jobs:,}",
                    "Minutes per job": three_digits(busy_s / jobs / 60),
                    "Core-hours": f"{busy_s / 3600:,.0f}",
                    "Results [GB]": three_digits(rigs * scale["rig"]["bytes"] / 1e9),
                    "Files": f"{FILES_PER_JOB * jobs:,}",
                    "Planning [min]": three_digits(_at(scale["dag"], "cpu_s", jobs) / 60),
                    "Memory of it [GB]": three_digits(_at(scale["dag"], "peak_mb", jobs) / 1e3),
                }
            )
    return pd.DataFrame(rows)


def start_of_job(scale: Mapping[str, Any], jobs: int) -> float:
    """Processor seconds until the first line of one of ``jobs`` Slurm jobs runs.

    Snakemake plans the job twice, in the Slurm job and in its job step, and each time reads the
    names of all files.
    """
    return 2 * _at(scale["alone"], "cpu_s", jobs) + scale["start"]["cpu_s"]


def _at(planned: list[Mapping[str, float]], key: str, jobs: int) -> float:
    x, y = ([entry[name] for entry in planned] for name in ("jobs", key))
    if jobs <= x[-1]:
        return float(np.interp(jobs, x, y))
    return y[-1] + (jobs - x[-1]) * (y[-1] - y[-2]) / (x[-1] - x[-2])
