"""Execution times of training and test, and the multiplications, which no processor changes."""

import platform
import re
import time
from collections.abc import Callable, Iterator, Mapping
from pathlib import Path
from typing import Any

import numpy as np
from threadpoolctl import threadpool_info

from fprc.models import EchoStates, RidgeReadout, SequenceModel, TakagiSugenoReadout, TapFeatures
from fprc.models.features import FeatureMap

#: Samples of the untimed run before each timed one: it compiles, and it brings code and weights
#: back into the processor's caches, which the other models have flushed in their turns.
WARM_UP = 500
#: Samples that are timed of a log that runs sample by sample. Each costs the same.
EXCERPT = 3000
#: Whole logs, which take most of the time and spread little, are timed in every second turn.
WHOLE_EVERY = 2

#: A log: inputs and P_exp.
Log = tuple[np.ndarray, np.ndarray]


def time_models(
    fitted: Mapping[Any, tuple[SequenceModel, Log, Log]], repeats: int, *, sequential: bool = True
) -> dict[Any, list[dict[str, Any]]]:
    """Time fitted models in ``repeats`` turns, each time after a short untimed run.

    Batch mode computes whole logs at once, in every second turn. Sequential mode is the cost in a
    controller: the features sample by sample, of an excerpt and in proportion to the whole log,
    then, in training, the fit of the readout. The training of the ESN excludes drawing its weights.
    The models take turns, so that a slow phase of the machine affects all of them. The weights of
    the models do not change, but their states do: reset a model before another use of ``step``.

    ``fitted`` has by name a model, its training log and its test log. By the same names, the result
    has of each ``phase`` (train or test) and ``mode`` (sequential or batch) its ``samples``,
    ``multiplications`` of the equations, and ``seconds``, one per repeat.
    """
    taken: dict[Any, dict[tuple[str, str], list[float]]] = {name: {} for name in fitted}
    for turn in range(repeats):
        for name, (model, train, test) in fitted.items():
            for phase, mode, seconds in _turn(model, train, test, turn, sequential):
                taken[name].setdefault((phase, mode), []).append(seconds)
    found: dict[Any, list[dict[str, Any]]] = {name: [] for name in fitted}
    for name, (model, *logs) in fitted.items():
        for (phase, mode), times in taken[name].items():
            samples = len(logs[phase == "test"][0])
            made = multiplications(model, phase, samples)
            found[name].append({"phase": phase, "mode": mode, "samples": samples,
                                "multiplications": made, "seconds": times})  # fmt: skip
    return found


def _turn(
    model: SequenceModel, train: Log, test: Log, turn: int, sequential: bool
) -> Iterator[tuple[str, str, float]]:
    """Yield phase, mode and seconds of what is timed in a turn."""
    whole = turn % WHOLE_EVERY == 0
    if whole:
        rows, mapped = _timed(model.features_.transform, train[0])
        _, fit = _timed(model.make_readout().fit, rows, train[1])
        if sequential:
            yield "train", "sequential", _stepped(model.features_, train[0]) + fit
        yield "train", "batch", mapped + fit
    if sequential:
        yield "test", "sequential", _stepped(model, test[0])
    if whole:
        yield "test", "batch", _timed(model.predict, test[0])[1]


def _timed(work: Callable[..., Any], *log: np.ndarray) -> tuple[Any, float]:
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


def multiplications(model: SequenceModel, phase: str, samples: int) -> int | None:
    """Return how many multiplications a log takes in training or test, by the equations.

    Divisions and exponentials count too. Fuzzy c-means counts with the iterations that it took.
    Drawing the ESN's weights does not count. Other features or another readout than those of the
    paper's models give None.
    """
    features, readout = model.features_, model.readout_
    inputs, size = features.n_features_in_, readout.n_features_in_
    if isinstance(features, EchoStates):
        mapped = features.r * (features.r + inputs + 2)  # W_r x, w_in theta, leak
    elif isinstance(features, TapFeatures):
        mapped = inputs - features.count_references()  # low-passes
    else:
        return None
    weights = 1 + size
    # X^T X is symmetric, and solved by Cholesky's method
    sums, solution = weights * (weights + 1) // 2 + weights, weights**3 // 6
    if isinstance(readout, RidgeReadout):
        output, fit = size, samples * sums + solution
    elif isinstance(readout, TakagiSugenoReadout):
        rules = readout.n_c
        output = rules * (2 * size + 3) + 1  # distances, memberships, rules, their mean
        passes = round(readout.passes_ * samples) * rules * (2 * size + 3)
        fit = passes + rules * (samples * (weights + sums) + solution)
    else:
        return None
    return samples * mapped + (fit if phase == "train" else samples * output)


def machine() -> dict[str, Any]:
    """Return the CPU, the most threads of any numerical library, and the kernels of BLAS."""
    pools, info = threadpool_info(), Path("/proc/cpuinfo")
    blas = {
        f"{pool['internal_api']} {pool.get('architecture', '')}".strip()
        for pool in pools
        if pool["user_api"] == "blas"
    }
    text = info.read_text(encoding="utf-8") if info.exists() else ""
    found = re.search(r"model name\s*:\s*(.+)", text)
    cpu = found[1] if found else platform.processor() or platform.machine()
    threads = max((pool["num_threads"] for pool in pools), default=1)
    return {"cpu": cpu, "threads": threads, "blas": ", ".join(sorted(blas))}
