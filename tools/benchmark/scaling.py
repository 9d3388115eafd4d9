"""Measure the cost of a rig of the ensemble, and of planning its jobs: `make scaling`.

    python -m tools.benchmark.scaling --page docs/scaling.md

Times are processor times of whole commands, which hardly depend on what else the machine runs.
This program imports no library, since Linux counts its memory in the peak of what it starts.
"""

import argparse
import os
import re
import subprocess
import sys
import tempfile
from collections.abc import Sequence
from datetime import date
from pathlib import Path
from typing import NamedTuple

from tools.benchmark import load, refuse_other_kernels, show

#: Numbers of jobs to plan, of one rig each.
JOBS = (1, 100, 1000, 10_000)
#: So many jobs are not planned at once, only one of them, as each job does on its node.
MOST_JOBS = 1_000_000


class Spent(NamedTuple):
    """What a command took."""

    cpu_s: float
    peak_mb: float
    printed: str


def snakemake(folder: Path, *arguments: str, rigs: int, chunk: int) -> Spent:
    """Run Snakemake on an ensemble, into a folder.

    Raises
    ------
    SystemExit
        It failed.
    """
    with tempfile.TemporaryFile("w+", encoding="utf-8") as output:
        process = subprocess.Popen(
            [
                *(sys.executable, "-m", "snakemake", "--cores", "1", "--nolock"),
                *("--snakefile", "workflow/studies/Snakefile"),
                *arguments,
                *("--config", f"ensemble={{rigs: {rigs}, chunk: {chunk}}}"),
                f"folders={{raw: {folder}/raw, results: {folder}}}",
            ],
            stdout=output,
            stderr=subprocess.STDOUT,
        )
        _, status, used = os.wait4(process.pid, 0)
        process.returncode = os.waitstatus_to_exitcode(status)
        output.seek(0)
        printed = output.read()
    if process.returncode:
        raise SystemExit(f"snakemake failed:\n{printed}")
    return Spent(used.ru_utime + used.ru_stime, used.ru_maxrss / 1024, printed)


def planned(jobs: int, *, alone: bool = False) -> Spent:
    """Plan an ensemble of so many jobs, or one of these jobs ``alone``.

    Raises
    ------
    SystemExit
        Snakemake planned another number.
    """
    with tempfile.TemporaryDirectory() as name:
        target = f"{name}/ensemble/rigs_0.json" if alone else "ensemble"
        asked = ("--quiet", "rules", "--dry-run", target)
        spent = snakemake(Path(name), *asked, rigs=jobs, chunk=1)
    found = re.findall(r"^ensemble_chunk +(\d+)$", spent.printed, flags=re.MULTILINE)
    if set(found) != {str(1 if alone else jobs)}:
        raise SystemExit(f"snakemake planned {found[:1]} of {jobs} jobs:\n{spent.printed}")
    return spent


def judged(rigs: int) -> tuple[float, int]:
    """Judge the first rigs of an ensemble in one job; return processor time and size of result."""
    with tempfile.TemporaryDirectory() as name:
        result = Path(name, "ensemble/rigs_0.json")
        spent = snakemake(Path(name), str(result), rigs=rigs, chunk=rigs)
        return spent.cpu_s, result.stat().st_size


def costs(rigs: int) -> list[list[str]]:
    """Measure one rig, and the start of a job."""
    judged(1)  # compiles
    (first_s, first), (all_s, whole) = judged(1), judged(1 + rigs)
    rig_s = (all_s - first_s) / rigs
    planning_s = planned(1, alone=True).cpu_s
    return [
        ["What", "Core-seconds", "Result [kB]"],
        [
            "one rig: draws, both logs, Tables II to IV",
            f"{rig_s:.2f}",
            f"{(whole - first) / rigs / 1000:.1f}",
        ],
        ["start of a job", f"{first_s - rig_s:.2f}", ""],
        [
            "start of a job under Slurm, which plans twice",
            f"{first_s - rig_s + planning_s:.2f}",
            "",
        ],
    ]


def plans() -> list[list[str]]:
    """Measure how planning grows with the number of jobs."""
    rows = [["Jobs", "All of them [core-seconds]", "Memory [MB]", "One of them [core-seconds]"]]
    for jobs in JOBS:
        whole, alone = planned(jobs), planned(jobs, alone=True)
        rows.append(
            [f"{jobs:,}", f"{whole.cpu_s:.2f}", f"{whole.peak_mb:.0f}", f"{alone.cpu_s:.2f}"]
        )
    alone = planned(MOST_JOBS, alone=True)
    return [*rows, [f"{MOST_JOBS:,}", "not measured", "not measured", f"{alone.cpu_s:.1f}"]]


def markdown(rows: Sequence[Sequence[str]]) -> str:
    """Return rows as a table, the first as its head."""
    head, *others = (f"| {' | '.join(row)} |" for row in rows)
    return "\n".join([head, "|---" * len(rows[0]) + "|", *others])


def main() -> None:
    """Run the command line."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--page", type=Path, help="write the tables there too")
    parser.add_argument("--rigs", type=int, default=2, help="rigs to judge")
    given = parser.parse_args()
    refuse_other_kernels()
    found = {"costs": markdown(costs(given.rigs)), "dag": markdown(plans())}

    from fprc.evaluation.timing import machine

    found["machine"] = f"Measured on {date.today().isoformat()} on {machine()['cpu']}; {load()}."
    show(found, given.page)


if __name__ == "__main__":
    main()
