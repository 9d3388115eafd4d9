"""Execution times of training and test, batch and sample by sample."""

import logging
import platform
import time
from collections.abc import Callable, Hashable, Mapping
from pathlib import Path
from typing import Any, TypeVar

import numpy as np
from threadpoolctl import threadpool_info

from fprc.models import SequenceModel

log = logging.getLogger(__name__)

#: Samples of the untimed run before each timed one: it compiles, and it brings code and weights
#: back into the processor's caches, which the other models have flushed in their turns.
WARM_UP = 1000

Name = TypeVar("Name", bound=Hashable)
#: A log: inputs and P_exp.
Log = tuple[np.ndarray, np.ndarray]


def time_models(
    fitted: Mapping[Name, tuple[SequenceModel, Log, Log]], repeats: int
) -> dict[Name, list[dict[str, Any]]]:
    """Time fitted models, ``repeats`` times in each mode, each time after a short untimed run.

    Sequential mode is the cost in a controller: the features sample by sample, then,
    in training, the fit of the readout. Batch mode computes whole logs at once. The
    training of the ESN excludes drawing its weights. The models take turns, so that
    a slow phase of the machine affects all of them. The weights of the models do not
    change, but their states do: reset a model before another use of ``step``.

    Parameters
    ----------
    fitted : Mapping
        By name: the model, its training log and its test log.

    Returns
    -------
    dict of list of dict
        By the same names: ``phase`` (train or test), ``mode`` (sequential or batch),
        ``samples``, ``seconds`` (one per repeat).
    """
    results: dict[Name, list[dict[str, Any]]] = {name: [] for name in fitted}
    for (phase, mode), run in _WORK.items():
        log.info("%s, %s, %d repeats in turn", phase, mode, repeats)
        logs = {
            name: train if phase == "train" else test for name, (_, train, test) in fitted.items()
        }
        for name, (X, _) in logs.items():
            described = {"phase": phase, "mode": mode, "samples": len(X)}
            results[name].append({**described, "seconds": []})
        for _ in range(repeats):
            for name, (X, y) in logs.items():
                model = fitted[name][0]
                run(model, X[:WARM_UP], y[:WARM_UP])
                start = time.perf_counter()
                run(model, X, y)
                results[name][-1]["seconds"].append(time.perf_counter() - start)
    return results


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


def _train_by_step(model: SequenceModel, X: np.ndarray, y: np.ndarray) -> object:
    features = model.features_
    features.reset()
    rows = np.empty((len(X), model.readout_.n_features_in_))
    for row, x in zip(rows, X, strict=True):
        row[:] = features.advance(x)  # `step` would copy it first
    return model.make_readout().fit(rows, y)


def _test_by_step(model: SequenceModel, X: np.ndarray, y: np.ndarray) -> object:
    model.reset()
    return np.array([model.step(x) for x in X])


_WORK: dict[tuple[str, str], Callable[[SequenceModel, np.ndarray, np.ndarray], object]] = {
    ("train", "sequential"): _train_by_step,
    ("train", "batch"): lambda model, X, y: model.make_readout().fit(
        model.features_.transform(X), y
    ),
    ("test", "sequential"): _test_by_step,
    ("test", "batch"): lambda model, X, y: model.predict(X),
}


def _cpu_name() -> str:
    try:
        lines = Path("/proc/cpuinfo").read_text(encoding="utf-8").splitlines()
    except OSError:
        lines = []
    names = [line.split(":", 1)[1].strip() for line in lines if line.startswith("model name")]
    return names[0] if names else platform.processor() or platform.machine()
