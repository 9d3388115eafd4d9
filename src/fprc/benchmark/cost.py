"""What a rig, a sweep cell, a closed-loop second and a job cost, and what many would."""

import json
import logging
import os
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Mapping, Sequence
from typing import Any

from fprc.artifacts import read_json, write_json, write_text
from fprc.calibration.ensemble import judge_rig
from fprc.calibration.fit import free_parameters
from fprc.errors import EvaluationError
from fprc.evaluation.timing import machine
from fprc.experiments.comparison import build
from fprc.experiments.sweeps import judge_cell
from fprc.experiments.tracking import Track
from fprc.stages.documents import replace_block
from fprc.stages.replicate import simulate
from fprc.tables.scaling import costs, dag, plan

log = logging.getLogger(__name__)

#: Runs a command in a process of its own: a child is told the memory of its parent as its own
#: peak, and this parent is small.
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


def measure_scale(
    scale: str,
    *,
    rigs: int,
    jobs: Sequence[int],
    ensemble: Mapping[str, Any],
    paths: Sequence[str],
    ranges: Mapping[str, Sequence[float]],
    taps: Sequence[Mapping[str, int]],
    chunk: int,
    seed: int,
    **settings: Any,
) -> None:
    """Measure by processor time, which neighbours on the machine disturb little.

    Parameters
    ----------
    rigs : int
        Rigs of the ensemble that are judged.
    jobs : sequence of int
        Sizes of the DAG that are planned.
    taps : sequence of Mapping
        ``n_u`` and ``n_y`` of the sweep cells that are judged.
    **settings
        As ``judge_rig`` takes them.
    """
    judgement = {key: settings[key] for key in ("models", "folds", "split")}
    experiments = [settings[key] for key in ("signals", "control", "rig", "target")]
    data = simulate(*experiments, seed)  # compiles the rig
    model = build("fprc", settings["models"], seed).fit(*data["sweep"].pair("fprc"))
    bench = Track(settings["tracking"], settings["control"], settings["rig"], seed)
    theta_d = bench.reference("sine_0p2")
    loop_s = len(theta_d) / settings["control"]["sample_rate_hz"]
    loop, _ = _timed(lambda: bench.drive(theta_d, model, bench.tracking["printed_gains"], 10))
    log.info("a closed-loop second: %.3f s", loop / loop_s)

    cells = [
        _timed(
            judge_cell,
            {"model": "fprc", **pair},
            train=data["sweep"],
            test=data["complex"],
            seed=seed,
            **judgement,
        )[0]
        for pair in taps
    ]
    log.info("a sweep cell: %.2f s", sum(cells) / len(cells))
    free = free_parameters(paths, ranges)
    judged = []
    for number in range(rigs):
        judged.append(_timed(judge_rig, {"rig": number}, ensemble=ensemble, free=free, **settings))
        log.info("rig %d: %.1f s", number, judged[-1][0])
    planned = [plan_ensemble(n) for n in [1, *jobs]]
    alone = [plan_ensemble(n, alone=True) for n in [1, *jobs, 100 * max(jobs)]]
    write_json(
        scale,
        {
            "source": "sim",
            **machine(),
            "rig": {
                "cpu_s": sum(seconds for seconds, _ in judged) / rigs,
                "bytes": len(json.dumps({"rigs": [rig for _, rig in judged]}, indent=2)) / rigs,
                "measured": rigs,
            },
            "cell": {"cpu_s": sum(cells) / len(cells), "measured": len(cells)},
            "loop": {"cpu_s": loop / loop_s, "measured": loop_s},
            "start": _spent([sys.executable, "-c", "import fprc.calibration.ensemble"]),
            "dag": planned,
            "alone": alone,
            "chunk": chunk,
        },
    )


def plan_ensemble(
    jobs: int, *, alone: bool = False, snakefile: str = "Snakefile"
) -> dict[str, float]:
    """Let Snakemake plan an ensemble of ``jobs`` jobs, one rig each, and return what it spent.

    Parameters
    ----------
    alone : bool
        Plan one of the jobs only, as each of them does on its node.

    Raises
    ------
    EvaluationError
        It did not plan them.
    """
    wanted = 1 if alone else jobs
    with tempfile.TemporaryDirectory() as folder:
        command = [sys.executable, "-m", "snakemake", "--snakefile", snakefile, "--dry-run"]
        command += ["--quiet", "rules", "--cores", "1", "--nolock"]
        command += [f"{folder}/ensemble/rigs_0.json" if alone else "ensemble", "--config"]
        command += [f"ensemble={{rigs: {jobs}, chunk: 1}}"]
        command += [f"folders={{raw: {folder}/raw, results: {folder}}}"]
        spent = _spent(command, f"{folder}/printed")
        lines = [line.split() for line in _read(f"{folder}/printed").splitlines()]
    if ["ensemble_chunk", str(wanted)] not in lines:
        told = "\n".join(" ".join(line) for line in lines[-5:])
        raise EvaluationError(f"snakemake did not plan {wanted} of {jobs} jobs: {told}")
    log.info("%d of %d jobs planned in %.1f s", wanted, jobs, spent["cpu_s"])
    return {"jobs": jobs, **spent}


def update_scaling_page(scale: str, *, page: str) -> None:
    """Replace the generated blocks of docs/scaling.md."""
    measured = read_json(scale)
    text = _read(page)
    tables = {"costs": costs, "dag": dag, "plan": plan}
    for name, table in tables.items():
        shown = table(measured).to_markdown(index=False, disable_numparse=True)
        text = replace_block(text, name, shown, page)
    text = replace_block(text, "machine", f"Measured on {measured['cpu']}.", page)
    write_text(page, text)
    log.info("updated %s", page)


def _read(path: str) -> str:
    with open(path, encoding="utf-8") as file:
        return file.read()


def _timed(work: Callable[..., Any], *arguments: Any, **named: Any) -> tuple[float, Any]:
    before = time.process_time()
    result = work(*arguments, **named)
    return time.process_time() - before, result


def _spent(command: Sequence[str], printed: str = os.devnull) -> dict[str, float]:
    """Run a command; return its processor time and the most memory that it held."""
    done = subprocess.run(
        [sys.executable, "-c", _WATCH, printed, *command], stdout=subprocess.PIPE, check=True
    )
    return json.loads(done.stdout)
