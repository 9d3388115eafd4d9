"""Compare speed with other libraries: `tools/benchmark.sh`, which installs them.

It writes the tables to docs/repeat.md, and prints them.

Everything runs on one core; times are those of the processor. What is compared takes turns, so that
a disturbance of the machine slows all of it. States are compared first: if they differ, no times
are given.
"""

import os
import statistics
from collections.abc import Callable, Mapping, Sequence
from datetime import date
from functools import partial
from importlib import import_module
from importlib.metadata import version
from pathlib import Path
from time import process_time

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
#: States that differ by less are the same; what is compared takes so many turns.
SAME, ROUNDS = 1e-12, 5
OURS, LIMIT, PROCESSOR = "fprc", "W_r x alone, by BLAS", "Processor"

#: From a log to x(k+1) of each sample k, and from one more sample to x after it, if it can. All
#: networks have the same weights and begin at state 0.
Peer = tuple[Callable[[np.ndarray], np.ndarray], Callable[[np.ndarray], np.ndarray] | None]


def ours(features: EchoStates) -> Peer:
    """Return our network in the form of the others: our rows have x(k) after the taps."""
    last = features.r
    return lambda X: features.transform(np.vstack([X, X[-1:]]))[1:, -last:], features.advance


def reservoirpy(features: EchoStates) -> Peer:
    """Return ReservoirPy's network; its leak is 1 - gamma."""
    network = import_module("reservoirpy.nodes").Reservoir(
        W=features.W_r_, Win=features.w_in_, bias=np.zeros(features.r), lr=1.0 - features.gamma
    )
    network.initialize(np.zeros((1, features.w_in_.shape[1])))

    def states(X: np.ndarray) -> np.ndarray:
        network.reset()
        return np.asarray(network.run(X))

    return states, lambda theta: np.asarray(network.step(theta))


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
    network = import_module("esnfed").EchoStateNetwork(
        inputs,
        1,
        features.W_r_,
        # it scales W_r to this radius: leave it as it is
        spectral_radius=float(np.abs(np.linalg.eigvals(features.W_r_)).max()),
        leaking_rate=1.0 - features.gamma,
        input_weights=np.hstack([np.zeros((features.r, 1)), features.w_in_]),
    )
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
    seconds: dict[str, list[float]] = {name: [] for name in work}
    for _ in range(ROUNDS):
        for name, run in work.items():
            begin = process_time()
            run()
            seconds[name].append(process_time() - begin)
    found = pd.DataFrame(index=pd.Index(seconds, name="Library"))
    found[f"{what}, us a sample"] = [
        three_digits(1e6 * statistics.median(taken) / samples) for taken in seconds.values()
    ]
    ratios = [np.divide(taken, seconds[OURS]) for taken in seconds.values()]
    found[f"{what}, times ours"] = [within(np.median(r), r.min(), r.max()) for r in ratios]
    return found


def networks(features: EchoStates, X: np.ndarray) -> pd.DataFrame:
    """Compare the states of a log and single steps, as in a control loop, of a fitted network."""
    sides = {OURS: ours(features)}
    sides |= {
        f"{name} {version(package)}": make(features) for name, (package, make) in PEERS.items()
    }
    expected = sides[OURS][0](X)
    off = {name: float(np.abs(states(X) - expected).max()) for name, (states, _) in sides.items()}
    sides = {name: peer for name, peer in sides.items() if off[name] <= SAME}
    sides[LIMIT] = limit(features)
    few = X[:1000]

    def stepped(step: Callable[[np.ndarray], np.ndarray]) -> None:
        for theta in few:
            step(theta)

    features.reset(few[0])
    steps = {name: partial(stepped, step) for name, (_, step) in sides.items() if step}
    for run in steps.values():  # they compile
        run()
    logs = {name: partial(states, X) for name, (states, _) in sides.items()}
    differ = {name: f"{by:.0e}" for name, by in off.items() if by}
    parts = [timed(logs, len(X), "log"), timed(steps, len(few), "step")]
    parts.append(pd.DataFrame({"States differ by": differ}))
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
    table = []
    for start in range(5):
        row = {"Start": str(start)}
        centers, _ = kmeans_plusplus(rows[::10], clusters, random_state=start)
        for name in (OURS, "scikit-fuzzy"):
            begin = process_time()
            if name == OURS:
                objective = fuzzy_c_means(rows, clusters, random_state=start).objective
            else:
                objective = scikit_fuzzy(rows, centers)
            row[f"{name}: objective"] = f"{objective:.8g}"
            row[f"{name} [s]"] = three_digits(process_time() - begin)
        table.append(row)
    return pd.DataFrame(table)


def with_others(table: pd.DataFrame, lines: Sequence[str]) -> pd.DataFrame:
    """Return a table of this processor, and below it the rows of others that a page has."""
    here, kept, ours = table[PROCESSOR][0].split(",")[:2], [], False
    for row in ([cell.strip() for cell in line.split("|")[1:-1]] for line in lines if "|" in line):
        if row[0] == PROCESSOR:
            ours = row == list(table)
        elif ours and row[0].split(",")[:2] != here and row[0][:1].isalpha():
            kept.append(dict(zip(table, row, strict=True)))
    return pd.concat([table, pd.DataFrame(kept)])


def report(block: str) -> str:
    """Measure everything; return it in Markdown, with what ``block`` has of other processors."""
    X, fuzzy = load_hysteresis("sweep").data, FPRC(random_state=1)
    features = EchoStates(washout=0, random_state=1).fit(X[:, :1])
    rows = fuzzy.make_features().fit(X).transform(X)
    found, load = machine(), os.getloadavg()[0]  # this process keeps one core busy itself
    busy = f", load {load:.0f}" if load > 1.5 else ""
    tables = []
    for table in (networks(features, X[:, :1]), clusterings(rows, fuzzy.n_c)):
        here = f"{found['cpu']}, {found['blas']}, {date.today().isoformat()}{busy}"
        table.insert(0, PROCESSOR, here)
        whole = with_others(table, block.splitlines())
        tables.append(whole.to_markdown(index=False, disable_numparse=True))
    return (
        f"ESN with {features.r} states, float64, {len(X)} samples, medians of {ROUNDS} rounds "
        f"in turn; in brackets the smallest and largest ratio of a round:\n\n{tables[0]}\n\n"
        f"Fuzzy c-means of {len(rows)} rows of {rows.shape[1]} features, {fuzzy.n_c} clusters:"
        f"\n\n{tables[1]}"
    )


if __name__ == "__main__":
    if hasattr(os, "sched_setaffinity"):  # before JAX counts the cores
        os.sched_setaffinity(0, {min(os.sched_getaffinity(0))})
    text = PAGE.read_text(encoding="utf-8")
    with threadpool_limits(1):
        new = report(text.partition("<!-- benchmark: generated")[2].partition("<!-- ")[0])
    print(new)
    write_text(PAGE, replace_block(text, "benchmark", new, str(PAGE)))
