"""Measure the speed compared with other libraries, and the cost of larger problems."""

import os
import sys
from collections.abc import Mapping, Sequence
from typing import Any

from fprc.artifacts import write_json
from fprc.benchmark import peers
from fprc.benchmark.comparisons import compare, fuzzy_comparisons, network_comparisons
from fprc.benchmark.cost import costs, plan_ensemble, spent_by
from fprc.benchmark.growth import growth
from fprc.benchmark.steps import memory_bound, real_time, single_steps, starts
from fprc.evaluation.timing import machine
from fprc.experiments.data import read_data
from fprc.experiments.settings import RigSettings


def measure_benchmark(
    train: str,
    test: str,
    report: str,
    *,
    models: Mapping[str, Any],
    on_rig: Mapping[str, Any],
    tracking: Mapping[str, Any],
    sizes: Mapping[str, Sequence[int]],
    rounds: int,
    seed: int,
) -> None:
    """Compare with other libraries, and measure how the cost grows with size.

    Parameters
    ----------
    sizes : Mapping
        Sizes ``r``, ``samples``, ``clusters``, ``cells``, ``workers`` and ``rigs`` at which the
        cost is measured; ``taps``, the n_u and n_y of the cells that represent the tap grid.
    """
    peers.refuse_missing()
    settings = RigSettings(**on_rig)
    data = [read_data(path) for path in (train, test)]
    comparisons = [
        *network_comparisons(models, data, seed),
        *fuzzy_comparisons(models, data[0], sizes["taps"], seed),
    ]
    content = {
        "source": data[0].attributes["source"],
        "seed": seed,
        "rounds": rounds,
        "cores": os.cpu_count(),
        **machine(),
        "comparisons": [compare(each, rounds) for each in comparisons],
        "bound": memory_bound(models, data[0], rounds, seed),
        "step": single_steps(models, data[0], seed),
        "real_time": real_time(models, settings, tracking, data[0], rounds, seed),
        "starts": starts(rounds),
        "growth": growth(models, settings, data, sizes, rounds, seed),
    }
    write_json(report, content)


def measure_scale(
    scale: str,
    *,
    rigs: int,
    jobs: Sequence[int],
    taps: Sequence[Mapping[str, int]],
    chunk: int,
    on_rig: Mapping[str, Any],
    **settings: Any,
) -> None:
    """Measure the cost of an ensemble, and of planning its jobs by Snakemake.

    Parameters
    ----------
    jobs : sequence of int
        Numbers of jobs to plan.
    rigs, taps, **settings
        Arguments of ``fprc.benchmark.cost.costs``.
    """
    measured = costs(rigs, taps, on_rig=RigSettings(**on_rig), **settings)
    planned = [plan_ensemble(n) for n in [1, *jobs]]
    alone = [plan_ensemble(n, alone=True) for n in [1, *jobs, 100 * max(jobs)]]
    start = spent_by([sys.executable, "-c", "import fprc.stages.ensemble"])
    plans = {"start": start, "dag": planned, "alone": alone, "chunk": chunk}
    write_json(scale, {"source": "sim", **machine(), **measured, **plans})
