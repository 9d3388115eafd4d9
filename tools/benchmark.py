"""Compare speed with other libraries: `tools/benchmark.sh`, which installs them.

It writes this processor's rows of the tables in docs/repeat.md, and prints the tables.

Everything runs on one core; times are those of the processor. What is compared takes turns, so that
a disturbance of the machine slows all of it. States are compared first: if they differ, it stops.
"""

import os
from collections.abc import Callable, Mapping
from datetime import date
from functools import partial
from importlib import import_module
from importlib.metadata import version
from io import StringIO
from pathlib import Path
from time import process_time
from timeit import timeit

import numpy as np
import pandas as pd
from scipy.spatial.distance import cdist
from skfuzzy import cmeans
from sklearn.cluster import kmeans_plusplus
from threadpoolctl import threadpool_limits

from fprc.artifacts import write_text
from fprc.datasets import load_hysteresis
from fprc.evaluation.timing import machine
from fprc.models import FPRC, EchoStates
from fprc.models.fcm import fuzzy_c_means
from fprc.studies.pages import replace_block
from fprc.tables.text import three_digits, within

PAGE = Path(__file__).parents[1] / "docs/repeat.md"
#: By how much states may differ; what is compared takes so many turns.
SAME, ROUNDS = 1e-12, 5
OURS, PROCESSOR = "fprc", "Processor"

#: From a log to x(k+1) of each sample k, and from one more sample to x after it, if it can. All
#: networks have the same weights and begin at state 0.
Peer = tuple[Callable[[np.ndarray], np.ndarray], Callable[[np.ndarray], np.ndarray] | None]


def ours(features: EchoStates) -> Peer:
    """Return our network in the form of the others: our rows have x(k) after the taps."""
    last = features.r
    return lambda X: features.transform(np.vstack([X, X[-1:]]))[1:, -last:], features.step


def reservoirpy(features: EchoStates) -> Peer:
    """Return ReservoirPy's network; its leak is 1 - gamma."""
    network = import_module("reservoirpy.nodes").Reservoir(
        W=features.W_r_, Win=features.w_in_, bias=np.zeros(features.r), lr=1.0 - features.gamma
    )
    network.initialize(np.zeros((1, features.w_in_.shape[1])))

    def states(X: np.ndarray) -> np.ndarray:
        network.reset()
        return np.asarray(network.run(X))

    return states, network.step


def jax_scan(features: EchoStates) -> Peer:
    """Return Eq. (3) under ``jax.lax.scan``, in float64."""
    import jax

    jax.config.update("jax_enable_x64", True)
    w_in, W_r = jax.numpy.asarray(features.w_in_), jax.numpy.asarray(features.W_r_)
    gamma, x = features.gamma, jax.numpy.zeros(features.r)

    @jax.jit
    def advance(x: jax.Array, theta: jax.Array) -> tuple[jax.Array, jax.Array]:
        x = gamma * x + (1.0 - gamma) * jax.numpy.tanh(w_in @ theta + W_r @ x)
        return x, x

    run = jax.jit(lambda X: jax.lax.scan(advance, jax.numpy.zeros(features.r), X)[1])

    def step(theta: np.ndarray) -> np.ndarray:
        nonlocal x
        x, _ = advance(x, theta)
        return np.asarray(x)

    return lambda X: np.asarray(run(X)), step


def esnfed(features: EchoStates) -> Peer:
    """Return esnfed's network, which has no single step; its leak is 1 - gamma."""
    inputs = features.w_in_.shape[1]
    radius = float(np.abs(np.linalg.eigvals(features.W_r_)).max())  # it scales W_r to this
    network = import_module("esnfed").EchoStateNetwork(
        inputs, 1, features.W_r_, spectral_radius=radius, leaking_rate=1.0 - features.gamma,
        input_weights=np.hstack([np.zeros((features.r, 1)), features.w_in_]),
    )  # fmt: skip
    return lambda X: network.harvest(X)[:, 1 + inputs :], None


#: By label in the table: its package, and how to make the peer.
PEERS = {
    "ReservoirPy": ("reservoirpy", reservoirpy),
    "lax.scan in JAX": ("jax", jax_scan),
    "esnfed": ("esnfed", esnfed),
}


def limit(features: EchoStates) -> Peer:
    """Return W_r x by BLAS, which is most of the work: of a thousand samples at once, or of one.

    The first is limited by multiplications, the second, in float32, by reading W_r.
    """
    W_r, rows = features.W_r_, np.ones((1000, features.r))
    narrow, x = W_r.astype(np.float32), np.ones(features.r, np.float32)
    return lambda X: [rows @ W_r for _ in range(len(X) // 1000)][-1], lambda theta: narrow @ x


def timed(work: Mapping[str, Callable[[], object]], samples: int, what: str) -> pd.DataFrame:
    """Return the processor time of each piece of work, which take turns, and its ratio to ours."""
    taken = pd.DataFrame(
        {name: timeit(run, timer=process_time, number=1) for name, run in work.items()}
        for _ in range(ROUNDS)
    )
    ratios = taken.div(taken[OURS], axis="index").agg(["median", "min", "max"])
    each = (1e6 * taken.median() / samples).map(three_digits)
    times = ratios.apply(lambda ratio: within(*ratio))
    return pd.DataFrame({f"{what}, us a sample": each, f"{what}, times ours": times})


def networks(features: EchoStates, X: np.ndarray) -> pd.DataFrame:
    """Compare the times of a log and of single steps, as in a control loop, of a fitted network."""
    sides, few = {OURS: ours(features)}, X[:1000]
    for name, (package, make) in PEERS.items():
        sides[f"{name} {version(package)}"] = make(features)
    expected = sides[OURS][0](X)
    for states, _ in sides.values():
        np.testing.assert_allclose(states(X), expected, rtol=0.0, atol=SAME)
    sides["W_r x alone, by BLAS"] = limit(features)
    features.reset(few[0])
    steps = {name: lambda step=step: [*map(step, few)] for name, (_, step) in sides.items() if step}
    for run in steps.values():  # they compile
        run()
    logs = {name: partial(states, X) for name, (states, _) in sides.items()}
    parts = timed(logs, len(X), "log"), timed(steps, len(few), "step")
    return pd.concat(parts, axis=1).fillna("").rename_axis("Library").reset_index()


def scikit_fuzzy(rows: np.ndarray, centers: np.ndarray) -> float:
    """Return the objective that scikit-fuzzy's fuzzy c-means reaches from these centres."""
    # cmeans starts from memberships, not from centres
    closeness = 1.0 / np.maximum(cdist(centers, rows, "sqeuclidean"), np.finfo(float).eps)
    begin = closeness / closeness.sum(axis=0)
    # as in its examples: the root of the sum of squared changes is below 0.005
    found = cmeans(rows.T, len(centers), m=2, error=0.005, maxiter=10_000, init=begin)
    _, memberships, _, distances, *_ = found
    return float(np.sum((memberships * distances) ** 2))


def clusterings(rows: np.ndarray, clusters: int) -> pd.DataFrame:
    """Compare fuzzy c-means by the objective that is reached, and the time to it.

    Both begin at the same k-means++ centres; ours first converges on every tenth row.
    """
    fuzzy_c_means(rows, clusters, random_state=0)  # compiles
    table, names = [], (OURS, "scikit-fuzzy")
    for start in range(5):
        centers, _ = kmeans_plusplus(rows[::10], clusters, random_state=start)
        begin = process_time()
        reached = fuzzy_c_means(rows, clusters, random_state=start).objective
        between = process_time()
        other = scikit_fuzzy(rows, centers)
        seconds = between - begin, process_time() - between
        row: dict[str, str] = {"Start": str(start)}
        for name, objective, taken in zip(names, (reached, other), seconds, strict=True):
            row |= {f"{name}: objective": f"{objective:.8g}", f"{name} [s]": three_digits(taken)}
        table.append(row)
    return pd.DataFrame(table)


def with_rows(text: str, name: str, table: pd.DataFrame, processor: str) -> str:
    """Return a page with a table between its markers, which keeps the rows of other processors."""
    found, load = f"{processor}, {date.today().isoformat()}", os.getloadavg()[0]
    # this process keeps one core busy itself
    table.insert(0, PROCESSOR, found + (f", load {load:.0f}" if load > 1.5 else ""))
    block = text.partition(f"<!-- {name}: generated -->")[2].partition("<!--")[0].strip()
    bars = {"sep": r"\s*\|\s*", "engine": "python", "dtype": str, "keep_default_na": False}
    old = pd.read_csv(StringIO(block), **bars).iloc[1:, 1:-1]
    whole = pd.concat([table, old[~old[PROCESSOR].str.startswith(f"{processor},")]])
    shown = whole.to_markdown(index=False, disable_numparse=True)
    print(f"{shown}\n")
    return replace_block(text, name, shown, str(PAGE))


if __name__ == "__main__":
    if hasattr(os, "sched_setaffinity"):  # before JAX counts the cores
        os.sched_setaffinity(0, {min(os.sched_getaffinity(0))})
    X, fuzzy = load_hysteresis("sweep").data, FPRC(random_state=1)
    text = PAGE.read_text(encoding="utf-8")
    with threadpool_limits(1):
        features = EchoStates(washout=0, random_state=1).fit(X[:, :1])
        rows = fuzzy.make_features().fit(X).transform(X)
        tables = {"esn": networks(features, X[:, :1]), "fcm": clusterings(rows, fuzzy.n_c)}
        processor = "{cpu}, {blas}".format(**machine())
    for name, table in tables.items():
        text = with_rows(text, name, table, processor)
    write_text(PAGE, text)
