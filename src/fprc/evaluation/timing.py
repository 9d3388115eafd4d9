"""Execution times of training and test, batch and sample by sample."""

import platform
import time
from collections.abc import Callable, Mapping
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
from threadpoolctl import threadpool_info

from fprc.models import SequenceModel

#: Samples of the warm-up of what goes sample by sample, enough for what is compiled; whole
#: logs at once touch all of their memory first.
WARM_UP = 1000


def time_model(
    model: SequenceModel,
    train: tuple[np.ndarray, np.ndarray],
    test: tuple[np.ndarray, np.ndarray],
    repeats: int,
    modes: tuple[str, ...] = ("sequential", "batch"),
    progress: Callable[[str], None] = lambda what: None,
) -> list[dict[str, Any]]:
    """Time a fitted model, ``repeats`` times in each mode, after a warm-up.

    Sequential is what a controller pays: the features sample by sample, then, in
    training, the fit of the readout. Batch computes whole logs at once. To draw
    the ESN's weights is no part of its training. The model keeps its weights, and
    is left in the midst of a log.

    Returns
    -------
    list of dict
        ``phase`` (train or test), ``mode`` (sequential or batch), ``samples``,
        ``seconds`` (one per repeat).
    """
    work = {
        ("train", "sequential"): lambda X, y: _train_by_step(model, X, y),
        ("train", "batch"): lambda X, y: _train(model, model.features_.transform(X), y),
        ("test", "sequential"): lambda X, y: _steps(model, X),
        ("test", "batch"): lambda X, y: model.predict(X),
    }
    results = []
    for (phase, mode), run in work.items():
        if mode not in modes:
            continue
        progress(f"{phase}, {mode}")
        X, y = train if phase == "train" else test
        warm = slice(WARM_UP if mode == "sequential" else None)
        run(X[warm], y[warm])
        seconds = [_seconds(partial(run, X, y)) for _ in range(repeats)]
        results.append({"phase": phase, "mode": mode, "samples": len(X), "seconds": seconds})
    return results


def time_steps(step: Callable[[int], object], samples: int) -> np.ndarray:
    """Return the seconds that each of ``step(0)`` to ``step(samples - 1)`` takes.

    Each call is timed by itself, since a control loop has to keep its
    deadline at every sample, not in the mean.
    """
    seconds = np.empty(samples)
    for k in range(samples):
        start = time.perf_counter()
        step(k)
        seconds[k] = time.perf_counter() - start
    return seconds


def interleaved(work: Mapping[str, Callable[[], object]], rounds: int) -> dict[str, list[float]]:
    """Return the seconds of each piece of work in each round, one after the other in turn.

    What slows the machine for a while then slows all of them.
    """
    seconds: dict[str, list[float]] = {name: [] for name in work}
    for _ in range(rounds):
        for name, run in work.items():
            seconds[name].append(_seconds(run))
    return seconds


def machine() -> dict[str, Any]:
    """CPU, the largest number of threads of any numerical library, and BLAS's kernels."""
    pools = threadpool_info()
    threads = max((pool["num_threads"] for pool in pools), default=1)
    blas = {
        f"{pool['internal_api']} {pool.get('architecture', '')}".strip()
        for pool in pools
        if pool["user_api"] == "blas"
    }
    return {"cpu": _cpu_name(), "threads": threads, "blas": ", ".join(sorted(blas))}


def _seconds(run: Callable[[], object]) -> float:
    start = time.perf_counter()
    run()
    return time.perf_counter() - start


def _steps(model: SequenceModel, X: np.ndarray) -> np.ndarray:
    model.reset()
    return np.array([model.step(x) for x in X])


def _train_by_step(model: SequenceModel, X: np.ndarray, y: np.ndarray):
    features = model.features_
    features.reset()
    rows = np.empty((len(X), model.readout_.n_features_in_))
    for row, x in zip(rows, X, strict=True):
        row[:] = features.advance(x)  # `step` would copy it first
    return _train(model, rows, y)


def _train(model: SequenceModel, rows: np.ndarray, y: np.ndarray):
    return model.make_readout().fit(rows, y)


def _cpu_name() -> str:
    try:
        lines = Path("/proc/cpuinfo").read_text(encoding="utf-8").splitlines()
    except OSError:
        lines = []
    names = [line.split(":", 1)[1].strip() for line in lines if line.startswith("model name")]
    return names[0] if names else platform.processor() or platform.machine()
