"""Processor time of a rig, a cell of a grid, a closed-loop second and a job.

Unlike wall time, processor time hardly depends on what else the machine runs.
"""

import json
import logging
import os
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Mapping, Sequence
from functools import partial
from pathlib import Path
from typing import Any

from fprc.calibration.ensemble import judge_rig
from fprc.calibration.space import free_parameters
from fprc.errors import EvaluationError
from fprc.experiments.grids import judge_cell
from fprc.experiments.hysteresis import simulate
from fprc.experiments.settings import Judgement, RigSettings
from fprc.experiments.tracking import Track
from fprc.registry import build

log = logging.getLogger(__name__)

#: Runs a command from a small process: Linux includes the parent's memory in the child's peak.
_WATCH = """
import json, resource, subprocess, sys, time
start = time.monotonic()
with open(sys.argv[1], "w") as printed:
    subprocess.run(sys.argv[2:], stdout=printed, stderr=subprocess.STDOUT)
used = resource.getrusage(resource.RUSAGE_CHILDREN)
spent = {
    "cpu_s": used.ru_utime + used.ru_stime,
    "wall_s": time.monotonic() - start,
    "peak_mb": used.ru_maxrss / 1024,
}
print(json.dumps(spent))
"""


def costs(
    rigs: int,
    taps: Sequence[Mapping[str, int]],
    *,
    ensemble: Mapping[str, Any],
    free: Mapping[str, Any],
    on_rig: RigSettings,
    tracking: Mapping[str, Any],
    judgement: Mapping[str, Any],
    seed: int,
) -> dict[str, dict[str, float]]:
    """Measure the processor time of a rig, a cell of a grid and a closed-loop second.

    Parameters
    ----------
    rigs : int
        Number of rigs of the ensemble to judge.
    taps : sequence of Mapping
        ``n_u`` and ``n_y`` of the cells to judge.
    judgement : Mapping
        Arguments of ``Judgement`` without the seed.
    """
    data = simulate(on_rig, seed)  # compiles the rig
    model = build("fprc", judgement["models"], seed).fit(*data["sweep"].pair("fprc"))
    bench = Track(tracking, on_rig.control, on_rig.rig, seed)
    theta_d = bench.reference("sine_0p2")
    loop_s = len(theta_d) / on_rig.control["sample_rate_hz"]
    loop, _ = _timed(lambda: bench.drive(theta_d, "fprc_pd", model, 10))
    log.info("a closed-loop second: %.3f s", loop / loop_s)

    how = Judgement(**judgement, seed=seed)
    logs = {"train": data["sweep"], "test": data["complex"]}
    cells = [
        _timed(judge_cell, {"model": "fprc", **pair}, **logs, judgement=how)[0] for pair in taps
    ]
    log.info("a cell of a grid: %.2f s", sum(cells) / len(cells))
    rig = partial(
        judge_rig,
        ensemble=ensemble,
        free=free_parameters(**free),
        on_rig=on_rig,
        tracking=tracking,
        judgement=judgement,
    )
    judged = []
    for number in range(rigs):
        judged.append(_timed(rig, {"rig": number}))
        log.info("rig %d: %.1f s", number, judged[-1][0])
    return {
        "rig": {
            "cpu_s": sum(seconds for seconds, _ in judged) / rigs,
            "bytes": len(json.dumps({"rigs": [rig for _, rig in judged]}, indent=2)) / rigs,
            "measured": rigs,
        },
        "cell": {"cpu_s": sum(cells) / len(cells), "measured": len(cells)},
        "loop": {"cpu_s": loop / loop_s, "measured": loop_s},
    }


def plan_ensemble(jobs: int, *, alone: bool = False) -> dict[str, float]:
    """Let Snakemake plan an ensemble of ``jobs`` jobs, one rig each; return the time and memory.

    Parameters
    ----------
    alone : bool
        Plan only one of the jobs, as each job does on its node.

    Raises
    ------
    EvaluationError
        Snakemake did not plan them.
    """
    wanted = 1 if alone else jobs
    with tempfile.TemporaryDirectory() as folder:
        command = [sys.executable, "-m", "snakemake", "--dry-run"]
        command += ["--quiet", "rules", "--cores", "1", "--nolock"]
        command += [f"{folder}/ensemble/rigs_0.json" if alone else "ensemble", "--config"]
        command += [f"ensemble={{rigs: {jobs}, chunk: 1}}"]
        command += [f"folders={{raw: {folder}/raw, results: {folder}}}"]
        spent = spent_by(command, f"{folder}/printed")
        lines = [
            line.split()
            for line in Path(folder, "printed").read_text(encoding="utf-8").splitlines()
        ]
    if ["ensemble_chunk", str(wanted)] not in lines:
        tail = "\n".join(" ".join(line) for line in lines[-5:])
        raise EvaluationError(f"snakemake did not plan {wanted} of {jobs} jobs: {tail}")
    log.info("%d of %d jobs planned in %.1f s", wanted, jobs, spent["cpu_s"])
    return {"jobs": jobs, **spent}


def _timed(work: Callable[..., Any], *arguments: Any, **named: Any) -> tuple[float, Any]:
    before = time.process_time()
    result = work(*arguments, **named)
    return time.process_time() - before, result


def spent_by(command: Sequence[str], printed: str = os.devnull) -> dict[str, float]:
    """Run a command; return its processor time, wall time and peak memory."""
    done = subprocess.run(
        [sys.executable, "-c", _WATCH, printed, *command], stdout=subprocess.PIPE, check=True
    )
    return json.loads(done.stdout)
