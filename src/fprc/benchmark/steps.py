"""Time of a step, of a simulated second of the rig, and of the start of a process."""

import subprocess
import sys
from collections.abc import Callable, Mapping
from typing import Any

import numpy as np

from fprc.benchmark.growth import peak_mb
from fprc.evaluation.timing import interleaved, stepped, time_steps
from fprc.experiments.data import Data
from fprc.experiments.hysteresis import acquire
from fprc.experiments.settings import RigSettings
from fprc.experiments.tracking import Track
from fprc.models.echo import aligned
from fprc.registry import build

#: Module that a job of each kind imports.
_JOBS = {
    "fits models": "fprc.stages.judge",
    "runs the rig": "fprc.stages.track",
    "draws": "fprc.stages.draw",
    "writes a table": "fprc.stages.tabulate",
}


def memory_bound(models: Mapping[str, Any], data: Data, rounds: int, seed: int) -> dict[str, float]:
    """Time the product W_r x alone, by BLAS, with 8-byte and with 4-byte numbers."""
    features = build("esn", models, seed).make_features().fit(data.pair("esn")[0])
    x, W_r = np.full(features.r, 0.5), features.W_r_

    def products(dtype: Any) -> Callable[[], object]:
        matrix: np.ndarray = aligned(W_r.astype(dtype))
        vector: np.ndarray = x.astype(dtype)
        return lambda: [matrix @ vector for _ in range(1000)]

    seconds = interleaved({"8": products(np.float64), "4": products(np.float32)}, rounds)
    bytes_8_us, bytes_4_us = (1e3 * float(np.median(each)) for each in seconds.values())
    return {
        "bytes_8_us": bytes_8_us,
        "bytes_4_us": bytes_4_us,
        "gb_per_s": 1e-3 * W_r.nbytes / bytes_8_us,
    }


def single_steps(models: Mapping[str, Any], data: Data, seed: int) -> dict[str, Any]:
    """Time each step of the FPRC by itself, since a control loop waits for each of them."""
    X, y = data.pair("fprc")
    model = build("fprc", models, seed).fit(X, y)
    stepped(model, X)
    seconds = time_steps(lambda k: model.step(X[k]), len(X))
    median_s, most_s = np.percentile(seconds, [50.0, 99.9]).tolist()

    def again() -> None:
        for x in X[:1000]:
            model.step(x)

    return {
        "samples": len(X),
        "median_us": 1e6 * median_s,
        "p99_9_us": 1e6 * most_s,
        "peak_bytes": round(1e6 * peak_mb(again)),
        "array_bytes": model.readout_.centers_.nbytes,
    }


def real_time(
    models: Mapping[str, Any],
    on_rig: RigSettings,
    tracking: Mapping[str, Any],
    data: Data,
    rounds: int,
    seed: int,
) -> list[dict[str, Any]]:
    """Time an open and a closed loop of the simulated rig."""
    model = build("fprc", models, seed).fit(*data.pair("fprc"))
    sweep = on_rig.signals["sweep"]
    bench = Track(tracking, on_rig.control, on_rig.rig, seed)
    reference = next(iter(tracking["references"]))
    described = tracking["references"][reference]
    work: dict[str, Callable[[], object]] = {
        "open loop": lambda: acquire("sweep", sweep, on_rig.control, on_rig.rig, seed),
        "closed loop": lambda: bench.follow(reference, "fprc_pd", model),
    }
    for run in work.values():
        run()
    simulated_s = sweep["duration_s"], described["duration_s"] + described["settle_s"]
    return [
        {"loop": name, "simulated_s": length_s, "aim": aim, "seconds": seconds}
        for (name, seconds), length_s, aim in zip(
            interleaved(work, rounds).items(), simulated_s, (1000, 100), strict=True
        )
    ]


def starts(rounds: int) -> dict[str, list[float]]:
    """Time the start of a process that only imports, for each kind of job."""

    def start(module: str) -> Callable[[], object]:
        command = [sys.executable, "-c", f"from snakemake import script\nimport {module}"]
        return lambda: subprocess.run(command, check=True)

    return interleaved({name: start(module) for name, module in _JOBS.items()}, rounds)
