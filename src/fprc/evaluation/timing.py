"""Execution times of training and test, batch and sample by sample."""

import logging
import platform
import time
from collections.abc import Callable, Hashable, Mapping
from pathlib import Path
from typing import Any, TypeVar

import numpy as np
from threadpoolctl import threadpool_info

from fprc.evaluation.operations import multiplications
from fprc.models import SequenceModel
from fprc.models.features import FeatureMap

log = logging.getLogger(__name__)

#: Samples of the untimed run before each timed one: it compiles, and it brings code and weights
#: back into the processor's caches, which the other models have flushed in their turns.
WARM_UP = 500

#: Samples that are timed of a log that runs sample by sample. Each costs the same.
EXCERPT = 4000

Name = TypeVar("Name", bound=Hashable)
Result = TypeVar("Result")
#: A log: inputs and P_exp.
Log = tuple[np.ndarray, np.ndarray]


def time_models(
    fitted: Mapping[Name, tuple[SequenceModel, Log, Log]], repeats: int
) -> dict[Name, list[dict[str, Any]]]:
    """Time fitted models, ``repeats`` times in each mode, each time after a short untimed run.

    Sequential mode is the cost in a controller: the features sample by sample, then,
    in training, the fit of the readout. Its samples are those of an excerpt, in proportion to
    the whole log. Batch mode computes whole logs at once. The training of the ESN excludes drawing
    its weights. The models take turns, so that a slow phase of the machine affects all of them. The
    weights of the models do not change, but their states do: reset a model before another use of
    ``step``.

    Parameters
    ----------
    fitted : Mapping
        By name: the model, its training log and its test log.

    Returns
    -------
    dict of list of dict
        By the same names: ``phase`` (train or test), ``mode`` (sequential or batch),
        ``samples``, ``multiplications`` of the equations, ``seconds`` (one per repeat).
    """
    turns: dict[Name, list[dict[tuple[str, str], float]]] = {name: [] for name in fitted}
    for repeat in range(repeats):
        log.info("repeat %d of %d, all models in turn", repeat + 1, repeats)
        for name, (model, train, test) in fitted.items():
            turns[name].append(_turn(model, train, test))
    results = {}
    for name, (model, train, test) in fitted.items():
        samples = {"train": len(train[0]), "test": len(test[0])}
        results[name] = [
            {
                "phase": phase,
                "mode": mode,
                "samples": samples[phase],
                "multiplications": multiplications(model, phase, samples[phase]),
                "seconds": [turn[phase, mode] for turn in turns[name]],
            }
            for phase, mode in turns[name][0]
        ]
    return results


def _turn(model: SequenceModel, train: Log, test: Log) -> dict[tuple[str, str], float]:
    """Return the seconds of training and of test in each mode."""
    features, readout = model.features_, model.make_readout()
    rows, mapped = _timed(features.transform, train[0])
    _, fit = _timed(readout.fit, rows, train[1])
    return {
        ("train", "sequential"): _stepped(features, train[0]) + fit,
        ("train", "batch"): mapped + fit,
        ("test", "sequential"): _stepped(model, test[0]),
        ("test", "batch"): _timed(model.predict, test[0])[1],
    }


def _timed(work: Callable[..., Result], *log: np.ndarray) -> tuple[Result, float]:
    work(*(part[:WARM_UP] for part in log))
    begin = time.perf_counter()
    result = work(*log)
    return result, time.perf_counter() - begin


def _stepped(stream: SequenceModel | FeatureMap, X: np.ndarray) -> float:
    stream.reset()
    first = min(WARM_UP, len(X) // 2)
    excerpt = X[first : first + EXCERPT]
    for x in X[:first]:
        stream.step(x)
    begin = time.perf_counter()
    kept = [stream.step(x) for x in excerpt]
    return (time.perf_counter() - begin) / len(kept) * len(X)


def machine() -> dict[str, Any]:
    """Return the CPU, the most threads of any numerical library, and the kernels of BLAS."""
    pools = threadpool_info()
    threads = max((pool["num_threads"] for pool in pools), default=1)
    blas = {
        f"{pool['internal_api']} {pool.get('architecture', '')}".strip()
        for pool in pools
        if pool["user_api"] == "blas"
    }
    return {"cpu": _cpu_name(), "threads": threads, "blas": ", ".join(sorted(blas))}


def _cpu_name() -> str:
    try:
        lines = Path("/proc/cpuinfo").read_text(encoding="utf-8").splitlines()
    except OSError:
        lines = []
    names = [line.split(":", 1)[1].strip() for line in lines if line.startswith("model name")]
    return names[0] if names else platform.processor() or platform.machine()
