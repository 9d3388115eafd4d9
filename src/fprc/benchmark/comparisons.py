"""How fast we are beside what a user would pick instead, and how the cost grows."""

import itertools
import logging
import os
import subprocess
import sys
import tempfile
import tracemalloc
from collections.abc import Callable, Mapping, Sequence
from functools import partial
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from fprc.artifacts import write_json
from fprc.benchmark import peers
from fprc.evaluation import split_rows
from fprc.evaluation.crossval import fit_folds
from fprc.evaluation.sweeps import run_cells
from fprc.evaluation.timing import interleaved, machine, time_steps
from fprc.experiments.comparison import Data, build, read_data
from fprc.experiments.hysteresis import acquire
from fprc.experiments.sweeps import judge_cell
from fprc.experiments.tracking import Track
from fprc.models import EchoStates, SequenceModel
from fprc.models.echo import LANES, SHORTEST, aligned, echo_states
from fprc.models.fcm import fuzzy_c_means

log = logging.getLogger(__name__)


#: At which scikit-fuzzy comes as near to the optimum as is compared; at its documentation's
#: tolerance the objective is 1e-7 above.
TIGHT = 5e-4

#: What jobs of each kind import.
_JOBS = {
    "fits models": "fprc.experiments.comparison",
    "runs the rig": "fprc.experiments.tracking",
    "draws": "fprc.stages.draw",
    "writes a table": "fprc.stages.tabulate",
}


class Comparison(NamedTuple):
    """One piece of work, done by us and by another."""

    work: str
    against: str
    aim: float  #: times faster
    ours: Callable[[], Any]
    theirs: Callable[[], Any]
    difference: Callable[[Any, Any], float]
    limit: float  #: the largest difference at which a ratio is given
    samples: int = 0  #: that the time is given for, 0 for all of it


def measure_benchmark(
    train: str,
    test: str,
    report: str,
    *,
    models: Mapping[str, Any],
    signals: Mapping[str, Any],
    tracking: Mapping[str, Any],
    control: Mapping[str, Any],
    rig: Mapping[str, Any],
    sizes: Mapping[str, Sequence[int]],
    rounds: int,
    seed: int,
) -> None:
    """Compare with other libraries, and measure the growth of the cost.

    Parameters
    ----------
    sizes : Mapping
        ``r``, ``samples``, ``clusters``, ``cells``, ``workers`` and ``rigs`` of the growth;
        ``taps``, n_u and n_y of the cells that stand for the tap grid.
    """
    peers.refuse_missing()
    data = [read_data(path) for path in (train, test)]
    compared = [
        compare(each, rounds)
        for each in [
            *network_comparisons(models, data, seed),
            *fuzzy_comparisons(models, data[0], sizes["taps"], seed),
        ]
    ]
    content = {
        "source": data[0].attributes["source"],
        "seed": seed,
        "rounds": rounds,
        "cores": os.cpu_count(),
        **machine(),
        "comparisons": compared,
        "bound": memory_bound(models, data[0], rounds, seed),
        "step": single_steps(models, data[0], seed),
        "real_time": real_time(models, signals, tracking, control, rig, data[0], rounds, seed),
        "starts": starts(rounds),
        "growth": growth(models, signals, control, rig, data, sizes, rounds, seed),
    }
    write_json(report, content)


def compare(each: Comparison, rounds: int) -> dict[str, Any]:
    """Check that both give the same, then time them in turn; no times where they differ."""
    difference = float(each.difference(each.ours(), each.theirs()))
    agrees = difference <= each.limit
    work = {"ours": each.ours, "theirs": each.theirs}
    seconds = interleaved(work, rounds) if agrees else {"ours": [], "theirs": []}
    log.info("%s, against %s: differ by %.1e", each.work, each.against, difference)
    fields = ("work", "against", "aim", "limit", "samples")
    named = {field: getattr(each, field) for field in fields}
    return {**named, "difference": difference, "agrees": agrees, "seconds": seconds}


def network_comparisons(
    models: Mapping[str, Any], data: Sequence[Data], seed: int
) -> list[Comparison]:
    """Return the work of the ESN: states of both logs, a step, and the cross-validation."""
    logs = [each.pair("esn")[0] for each in data]
    y = data[0].pair("esn")[1]
    model = build("esn", models, seed).set_params(washout=0)
    features = model.make_features().fit(logs[0])
    few = logs[0][:2000]
    folds = split_rows(len(y), 5, "shuffled", seed)

    def of_both(states: Callable[[EchoStates, np.ndarray], np.ndarray]) -> Callable:
        return lambda: [states(features, X) for X in logs]

    def single(features: EchoStates, X: np.ndarray) -> np.ndarray:
        arrays = (X, features.w_in_, features.W_r_)
        return echo_states(*(each.astype(np.float32) for each in arrays), features.gamma)

    def our_states(features: EchoStates, X: np.ndarray) -> np.ndarray:
        return echo_states(X, features.w_in_, features.W_r_, features.gamma)

    def our_steps() -> np.ndarray:
        features.reset(few[0])
        for theta in few:
            features.advance(theta)
        return features.step(few[-1])[features.n_y :]

    name = f"ESN states, r = {model.r}, {len(logs[0])} + {len(logs[1])} steps"
    ours = of_both(our_states)
    return [
        Comparison(
            name, "ReservoirPy", 5, ours, of_both(peers.reservoirpy_states), _a_step_apart, 1e-12
        ),
        Comparison(name, "NumPy loop", 5, ours, of_both(peers.numpy_states), _apart, 1e-12),
        Comparison(
            f"{name}, float32", "ReservoirPy, float32", 5,
            of_both(single), of_both(partial(peers.reservoirpy_states, dtype=np.float32)),
            _a_step_apart, 1e-4,
        ),
        Comparison(
            "ESN step in a control loop", "ReservoirPy's step", 2,
            our_steps, lambda: peers.reservoirpy_steps(features, few), _apart, 1e-12,
            len(few),
        ),
        Comparison(
            f"Cross-validation of the ESN, {len(y)} samples, 5 folds",
            "five fits that recompute states", 5,
            lambda: fit_folds(
                model.make_readout(), features.transform(logs[0]), y, folds
            ).validation_rmse,
            lambda: peers.recomputed_folds(features, logs[0], y, folds, model.alpha),
            _relative, 1e-6,
        ),
    ]  # fmt: skip


def fuzzy_comparisons(
    models: Mapping[str, Any], data: Data, taps: Sequence[int], seed: int
) -> list[Comparison]:
    """Return the work of the FPRC: a step, the clustering, and the tap grid by some cells."""
    X, y = data.pair("fprc")
    model = build("fprc", models, seed).fit(X, y)
    rows = model.features_.transform(X)
    few = X[:4000]
    folds = split_rows(len(y), 5, "shuffled", seed)
    cells = list(itertools.product(taps, taps))

    def clusters() -> float:
        return fuzzy_c_means(rows, model.n_c, random_state=seed).objective

    def grid(make: Callable[[SequenceModel], Any]) -> list[float]:
        errors = []
        for n_u, n_y in cells:
            cell = build("fprc", models, seed).set_params(n_u=n_u, n_y=n_y)
            its_rows = cell.make_features().fit(X).transform(X)
            errors.append(np.mean(fit_folds(make(cell), its_rows, y, folds).validation_rmse))
        return errors

    def theirs(cell: SequenceModel) -> peers.SkfuzzyReadout:
        return peers.SkfuzzyReadout(**cell.make_readout().get_params())

    return [
        Comparison(
            "FPRC step in a control loop", "vectorised NumPy on one row", 2,
            lambda: _stepped(model, few), lambda: peers.numpy_fprc_steps(model, few),
            _relative, 1e-9, len(few),
        ),
        Comparison(
            f"Fuzzy c-means, {len(rows)} x {rows.shape[1]}, {model.n_c} clusters",
            "skfuzzy.cmeans", 10, clusters,
            lambda: peers.skfuzzy_clusters(rows, model.n_c, seed, TIGHT)[2], _relative, 1e-8,
        ),
        Comparison(
            f"Tap grid, by {len(cells)} of its cells, 5 folds",
            "the same with skfuzzy, random starts", 20,
            lambda: grid(lambda cell: cell.make_readout()), lambda: grid(theirs), _relative, 2e-2,
        ),
    ]  # fmt: skip


def _stepped(model: SequenceModel, X: np.ndarray) -> np.ndarray:
    model.reset()
    return np.array([model.step(x) for x in X])


def _apart(ours: Any, theirs: Any) -> float:
    return max(np.abs(a - b).max() for a, b in zip(_each(ours), _each(theirs), strict=True))


def _a_step_apart(ours: list[np.ndarray], theirs: list[np.ndarray]) -> float:
    """Compare x(k) with x(k+1), which ReservoirPy gives upon sample k."""
    return _apart([states[1:] for states in ours], [states[:-1] for states in theirs])


def _each(result: Any) -> list[np.ndarray]:
    return result if isinstance(result, list) else [np.ravel(result)]


def _relative(ours: Any, theirs: Any) -> float:
    return float(np.abs(np.divide(ours, theirs) - 1.0).max())


def memory_bound(models: Mapping[str, Any], data: Data, rounds: int, seed: int) -> dict[str, float]:
    """Return what W_r x alone takes by BLAS, whose numbers have 8 bytes or 4."""
    features = build("esn", models, seed).make_features().fit(data.pair("esn")[0])
    x, W_r = np.full(features.r, 0.5), features.W_r_

    def products(dtype: type) -> Callable[[], object]:
        matrix, vector = aligned(W_r.astype(dtype)), x.astype(dtype)
        return lambda: [matrix @ vector for _ in range(1000)]

    seconds = interleaved({"8": products(np.float64), "4": products(np.float32)}, rounds)
    bytes_8_us, bytes_4_us = (1e3 * float(np.median(each)) for each in seconds.values())
    return {
        "bytes_8_us": bytes_8_us,
        "bytes_4_us": bytes_4_us,
        "gb_per_s": 1e-3 * W_r.nbytes / bytes_8_us,
    }


def single_steps(models: Mapping[str, Any], data: Data, seed: int) -> dict[str, Any]:
    """Time each step of the FPRC by itself, as a control loop would have to wait for it."""
    X, y = data.pair("fprc")
    model = build("fprc", models, seed).fit(X, y)
    _stepped(model, X)
    seconds = time_steps(lambda k: model.step(X[k]), len(X))
    median_s, most_s = np.percentile(seconds, [50.0, 99.9]).tolist()

    def again() -> None:
        for x in X[:1000]:
            model.step(x)

    return {
        "samples": len(X),
        "median_us": 1e6 * median_s,
        "p99_9_us": 1e6 * most_s,
        "peak_bytes": round(1e6 * _peak_mb(again)),
        "array_bytes": model.readout_.centers_.nbytes,
    }


def real_time(
    models: Mapping[str, Any],
    signals: Mapping[str, Any],
    tracking: Mapping[str, Any],
    control: Mapping[str, Any],
    rig: Mapping[str, Any],
    data: Data,
    rounds: int,
    seed: int,
) -> list[dict[str, Any]]:
    """Time an open and a closed loop of the simulated rig."""
    model = build("fprc", models, seed).fit(*data.pair("fprc"))
    bench = Track(tracking, control, rig, seed)
    gains = {"identified": tracking["printed_gains"], "printed": tracking["printed_gains"]}
    reference = next(iter(tracking["references"]))
    described = tracking["references"][reference]
    work = {
        "open loop": lambda: acquire("sweep", signals["sweep"], control, rig, seed),
        "closed loop": lambda: bench.follow(reference, "fprc_pd_printed", model, gains),
    }
    for run in work.values():
        run()
    simulated = {
        "open loop": signals["sweep"]["duration_s"],
        "closed loop": described["duration_s"] + described["settle_s"],
    }
    timed = interleaved(work, rounds)
    aims = {"open loop": 1000, "closed loop": 100}
    return [
        {"loop": name, "simulated_s": simulated[name], "aim": aims[name], "seconds": timed[name]}
        for name in work
    ]


def starts(rounds: int) -> dict[str, list[float]]:
    """Return what the start of a process takes that only imports, for each kind of job."""

    def start(module: str) -> Callable[[], object]:
        command = [sys.executable, "-c", f"from snakemake import script\nimport {module}"]
        return lambda: subprocess.run(command, check=True)

    return interleaved({name: start(module) for name, module in _JOBS.items()}, rounds)


def growth(
    models: Mapping[str, Any],
    signals: Mapping[str, Any],
    control: Mapping[str, Any],
    rig: Mapping[str, Any],
    data: Sequence[Data],
    sizes: Mapping[str, Sequence[int]],
    rounds: int,
    seed: int,
) -> list[dict[str, Any]]:
    """Return seconds and peak memory of each piece of work over its size."""
    X, y = data[0].pair("fprc")
    rows = build("fprc", models, seed).make_features().fit(X).transform(X)
    theta = X[: 2 * LANES * SHORTEST, :1]
    rng = np.random.default_rng(seed)
    judge = partial(
        judge_cell, train=data[0], test=data[1], models=models, folds=5, split="shuffled", seed=seed
    )

    def states(r: int) -> Callable[[], object]:
        # the circle law gives the spectral radius without the eigenvalues
        W_r = rng.standard_normal((r, r)) * (models["esn"]["rho"] / np.sqrt(r))
        W_r = W_r.astype(np.float32).astype(float)  # as the ESN's own
        w_in = models["esn"]["f_input"] * rng.standard_normal((r, 1))
        return lambda: echo_states(theta, w_in, W_r, models["esn"]["gamma"])

    def clustered(samples: int, clusters: int) -> Callable[[], object]:
        part = rows[rng.permutation(len(rows))[:samples]]
        return lambda: fuzzy_c_means(part, clusters, random_state=seed)

    def cells(count: int, workers: int = 1) -> Callable[[], object]:
        # what is swept is of no matter here: all cells are the same work
        planned = [{"model": "fprc", "alpha": 1e-3 + 1e-9 * cell} for cell in range(count)]
        return lambda: _swept(judge, planned, workers)

    def rigs(count: int) -> Callable[[], object]:
        return lambda: [
            acquire("sweep", signals["sweep"], control, rig, seed + i) for i in range(count)
        ]

    work = {
        "r": ("ESN states, nodes", states),
        "samples": ("c-means, samples", lambda n: clustered(n, 8)),
        "clusters": ("c-means, clusters", lambda k: clustered(len(rows), k)),
        "cells": ("sweep, cells", cells),
        "workers": ("sweep, workers", lambda workers: cells(16, workers)),
        "rigs": ("ensemble, rigs", rigs),
    }
    found = []
    for key, (name, make) in work.items():
        for size in sizes[key]:
            run = make(size)
            # each worker has memory of its own, and judges a cell at a time
            peak_mb = size * _peak_mb(cells(1)) if key == "workers" else _peak_mb(run)
            run()
            seconds = interleaved({"it": run}, rounds)["it"]
            found.append({"work": name, "size": size, "peak_mb": peak_mb, "seconds": seconds})
            log.info("%s: %d", name, size)
    return found


def _swept(judge: Callable, cells: Sequence[Mapping[str, Any]], workers: int) -> list[Any]:
    with tempfile.TemporaryDirectory() as folder:
        checkpoint = Path(folder, "cells.jsonl")
        return run_cells(judge, cells, workers=workers, checkpoint=checkpoint, key="benchmark")


def _peak_mb(run: Callable[[], object]) -> float:
    tracemalloc.start()
    try:
        run()
        return tracemalloc.get_traced_memory()[1] / 1e6
    finally:
        tracemalloc.stop()
