"""How the cost grows with size."""

import logging
import tempfile
import tracemalloc
from collections.abc import Callable, Mapping, Sequence
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from fprc.evaluation.cells import judging
from fprc.evaluation.timing import interleaved
from fprc.experiments.data import Data
from fprc.experiments.grids import judge_cell
from fprc.experiments.hysteresis import acquire
from fprc.experiments.settings import Judgement, RigSettings
from fprc.models.echo import LANES, SHORTEST, echo_states
from fprc.models.fcm import fuzzy_c_means
from fprc.registry import build

log = logging.getLogger(__name__)


def growth(
    models: Mapping[str, Any],
    on_rig: RigSettings,
    data: Sequence[Data],
    sizes: Mapping[str, Sequence[int]],
    rounds: int,
    seed: int,
) -> list[dict[str, Any]]:
    """Return seconds and peak memory in MB of each piece of work over its size."""
    X, y = data[0].pair("fprc")
    rows = build("fprc", models, seed).make_features().fit(X).transform(X)
    theta = X[: 2 * LANES * SHORTEST, :1]
    rng = np.random.default_rng(seed)
    how = Judgement(models, folds=5, split="shuffled", seed=seed)
    judge = partial(judge_cell, train=data[0], test=data[1], judgement=how)

    def states(r: int) -> Callable[[], object]:
        # scaled by the circular law, which needs no eigenvalues
        W_r = rng.standard_normal((r, r)) * (models["esn"]["rho"] / np.sqrt(r))
        W_r = W_r.astype(np.float32).astype(float)  # rounded, as the ESN's
        w_in = models["esn"]["f_input"] * rng.standard_normal((r, 1))
        return lambda: echo_states(theta, w_in, W_r, models["esn"]["gamma"])

    def clustered(samples: int, clusters: int) -> Callable[[], object]:
        part = rows[rng.permutation(len(rows))[:samples]]
        return lambda: fuzzy_c_means(part, clusters, random_state=seed)

    def cells(count: int, workers: int = 1) -> Callable[[], object]:
        # cells must differ; alpha does not change the time that one takes
        planned = [{"model": "fprc", "alpha": 1e-3 + 1e-9 * cell} for cell in range(count)]
        return lambda: _judged(judge, planned, workers)

    def rigs(count: int) -> Callable[[], object]:
        return lambda: [
            acquire("sweep", on_rig.signals["sweep"], on_rig.control, on_rig.rig, seed + i)
            for i in range(count)
        ]

    work = {
        "r": ("ESN states, nodes", states),
        "samples": ("c-means, samples", lambda n: clustered(n, 8)),
        "clusters": ("c-means, clusters", lambda k: clustered(len(rows), k)),
        "cells": ("grid, cells", cells),
        "workers": ("grid, workers", lambda workers: cells(16, workers)),
        "rigs": ("ensemble, rigs", rigs),
    }
    measured = []
    for key, (name, make) in work.items():
        for size in sizes[key]:
            run = make(size)
            # each worker has its own memory, and judges one cell at a time
            memory_mb = size * peak_mb(cells(1)) if key == "workers" else peak_mb(run)
            run()
            seconds = interleaved({"it": run}, rounds)["it"]
            measured.append({"work": name, "size": size, "peak_mb": memory_mb, "seconds": seconds})
            log.info("%s: %d", name, size)
    return measured


def _judged(
    judge: Callable[..., Any], cells: Sequence[Mapping[str, Any]], workers: int
) -> list[Any]:
    with (
        tempfile.TemporaryDirectory() as folder,
        judging(workers=workers, checkpoint=Path(folder, "cells.jsonl"), key="benchmark") as run,
    ):
        return run(judge, cells)


def peak_mb(run: Callable[[], object]) -> float:
    """Return the peak memory of Python objects during a call, MB."""
    tracemalloc.start()
    try:
        run()
        return tracemalloc.get_traced_memory()[1] / 1e6
    finally:
        tracemalloc.stop()
