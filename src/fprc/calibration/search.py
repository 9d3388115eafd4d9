"""CMA-ES over the unit cube; after a kill it resumes from a checkpoint."""

import json
import logging
import time
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any, NamedTuple

import cma
import numpy as np
from joblib import Parallel, delayed, parallel_config

from fprc.artifacts import appending, write_text

log = logging.getLogger(__name__)


class SearchResult(NamedTuple):
    """Result of a search."""

    point: np.ndarray  #: the best point
    loss: float
    generations: int
    evaluations: int
    finished: bool  #: False if the time limit ended the search


def search(
    loss: Callable[[np.ndarray], float],
    start: np.ndarray,
    *,
    step: float,
    population: int,
    generations: int,
    seed: int,
    workers: int,
    checkpoint: Path | str,
    key: str,
    seconds: float = np.inf,
    progress: Callable[[int, int, float, float], None] = lambda done, total, best, elapsed: None,
) -> SearchResult:
    """Minimise ``loss`` in the unit cube by CMA-ES (Hansen 2016), in a pool of processes.

    The optimiser is deterministic, so the checkpoint holds only the losses of
    each generation; a resumed search replays them.

    Parameters
    ----------
    loss : callable
        Picklable; takes a point and returns a finite number.
    step : float
        First standard deviation, in units of the cube.
    checkpoint : path
        JSON lines: first ``key``, then the losses of each generation. A file with
        another key is renamed and the search starts afresh; an incomplete last
        line is dropped.
    key : str
        Hash of everything that the loss depends on.
    seconds : float
        No generation starts after this time.
    progress : callable
        Called after each generation with generations done and planned, least
        loss, and seconds.
    """
    settings = {"start": list(start), "step": step, "population": population, "seed": seed}
    losses_before = _resume(Path(checkpoint), {"key": key} | settings)
    optimiser = cma.CMAEvolutionStrategy(
        list(start),
        step,
        {"bounds": [0.0, 1.0], "popsize": population, "seed": seed + 1, "verbose": -9},
    )
    for losses in losses_before:
        optimiser.tell(optimiser.ask(), losses)
    begun = time.monotonic()
    done = len(losses_before)
    with (
        appending(checkpoint) as append,
        parallel_config("loky", inner_max_num_threads=1),
        Parallel(n_jobs=workers) as pool,
    ):
        while done < generations and time.monotonic() - begun < seconds:
            points = optimiser.ask()
            losses = pool(delayed(loss)(np.asarray(point)) for point in points)
            optimiser.tell(points, losses)
            append(json.dumps(losses, allow_nan=False))
            done += 1
            progress(done, generations, optimiser.best.f, time.monotonic() - begun)
    best = optimiser.best
    if not done:
        return SearchResult(np.asarray(start, dtype=float), np.inf, 0, 0, False)
    return SearchResult(
        np.asarray(best.x), float(best.f), done, done * population, done >= generations
    )


def _resume(checkpoint: Path, head: Mapping[str, Any]) -> list[list[float]]:
    """Return the losses of the finished generations; rewrite the file for further ones."""
    text = checkpoint.read_text(encoding="utf-8", errors="replace") if checkpoint.exists() else ""
    first, *lines = text.splitlines() or [""]
    losses_before = []
    if first and first != json.dumps(head):
        old = checkpoint.with_name(f"{checkpoint.name}.old")
        checkpoint.replace(old)
        log.warning(
            "warning: %s has other settings or code; it is kept as %s and the search starts afresh",
            checkpoint,
            old,
        )
    if first == json.dumps(head):
        for line in lines:
            try:
                losses_before.append(json.loads(line))
            except json.JSONDecodeError:
                break
    entries = [head, *losses_before]
    write_text(checkpoint, "".join(json.dumps(entry) + "\n" for entry in entries))
    return losses_before
