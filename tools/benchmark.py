"""Compare speed with other libraries: `tools/benchmark.sh`, which installs them.

It prints the rows of this processor for the tables in docs/repeat.md. Everything runs on one core;
times are those of the processor. What is compared takes turns, so that a disturbance of the machine
slows all of it. States are compared first: if they differ, it stops.
"""

import os
from datetime import date
from functools import partial
from importlib.metadata import version
from time import process_time
from timeit import timeit

import numpy as np
import pandas as pd
from scipy.spatial.distance import cdist
from skfuzzy import cmeans
from sklearn.cluster import kmeans_plusplus
from threadpoolctl import threadpool_limits

from fprc.datasets import load_hysteresis
from fprc.evaluation.timing import machine
from fprc.models import FPRC, EchoStates
from fprc.models.fcm import fuzzy_c_means
from fprc.tables.text import three_digits, within

# Networks with the weights of ours: a name, a function from a log to x(k+1) of each sample k that
# begins at state 0, and one from a sample to x after it. Leaks of other libraries are 1 - gamma.


def _fprc(ours):
    # our rows have x(k) after the taps
    return "fprc", lambda X: ours.transform(np.vstack([X, X[-1:]]))[1:, -ours.r :], ours.step


def _reservoirpy(ours):
    from reservoirpy.nodes import Reservoir

    bias, leak = np.zeros(ours.r), 1.0 - ours.gamma
    network = Reservoir(W=ours.W_r_, Win=ours.w_in_, bias=bias, lr=leak)
    network.initialize(ours.w_in_[:1])

    def log(X):
        network.reset()
        return network.run(X)

    return f"ReservoirPy {version('reservoirpy')}", log, network.step


def _jax(ours):
    import jax

    jax.config.update("jax_enable_x64", True)
    w_in, W_r = jax.numpy.asarray(ours.w_in_), jax.numpy.asarray(ours.W_r_)
    gamma, rest = ours.gamma, jax.numpy.zeros(ours.r)

    @jax.jit
    def advance(x, theta):  # Eq. (3)
        x = gamma * x + (1.0 - gamma) * jax.numpy.tanh(w_in @ theta + W_r @ x)
        return x, x

    def step(theta):  # takes as long from any state
        return np.asarray(advance(rest, theta)[0])

    run = jax.jit(lambda X: jax.lax.scan(advance, rest, X)[1])
    return f"lax.scan in JAX {jax.__version__}", lambda X: np.asarray(run(X)), step


def _esnfed(ours):
    from esnfed import EchoStateNetwork

    inputs, leak = ours.w_in_.shape[1], 1.0 - ours.gamma
    radius = float(np.abs(np.linalg.eigvals(ours.W_r_)).max())  # it scales W_r to this
    w_in = np.hstack([np.zeros((ours.r, 1)), ours.w_in_])
    network = EchoStateNetwork(
        inputs, 1, ours.W_r_, spectral_radius=radius, leaking_rate=leak, input_weights=w_in
    )
    # it has no single step
    return f"esnfed {version('esnfed')}", lambda X: network.harvest(X)[:, 1 + inputs :], None


NETWORKS = (_fprc, _reservoirpy, _jax, _esnfed)


def timed(work, samples, what):
    """Return the processor time of each piece of work, which take turns, and its ratio to ours."""
    taken = pd.DataFrame(
        {name: timeit(run, timer=process_time, number=1) for name, run in work.items()}
        for _ in range(5)
    )
    ratios = taken.div(taken["fprc"], axis="index").agg(["median", "min", "max"])
    each = (1e6 * taken.median() / samples).map(three_digits)
    times = ratios.apply(lambda ratio: within(*ratio))
    return pd.DataFrame({f"{what}, us a sample": each, f"{what}, times ours": times})


def networks(ours, X):
    """Compare the times of a log and of single steps, as in a control loop, of a fitted network."""
    _, expected, _ = _fprc(ours)
    few, logs, steps = X[:1000], {}, {}
    for name, log, step in (make(ours) for make in NETWORKS):
        np.testing.assert_allclose(log(X), expected(X), rtol=0.0, atol=1e-12)
        logs[name] = partial(log, X)
        if step:
            step(X[0])  # compiles
            steps[name] = lambda step=step: [*map(step, few)]
    # most of the work: of a thousand samples, limited by multiplications, or of one in float32,
    # limited by reading W_r
    rows, W_r = np.ones((1000, ours.r)), ours.W_r_.astype(np.float32)
    logs["W_r x alone, by BLAS"] = lambda: [rows @ ours.W_r_ for _ in range(len(X) // 1000)]
    steps["W_r x alone, by BLAS"] = lambda: [W_r @ W_r[0] for _ in few]
    parts = timed(logs, len(X), "log"), timed(steps, len(few), "step")
    return pd.concat(parts, axis=1).fillna("").rename_axis("Library").reset_index()


def scikit_fuzzy(rows, centers):
    """Return the objective that scikit-fuzzy's fuzzy c-means reaches from these centres."""
    # cmeans starts from memberships, not from centres
    closeness = 1.0 / np.maximum(cdist(centers, rows, "sqeuclidean"), np.finfo(float).eps)
    begin = closeness / closeness.sum(axis=0)
    # as in its examples: the root of the sum of squared changes is below 0.005
    found = cmeans(rows.T, len(centers), m=2, error=0.005, maxiter=10_000, init=begin)
    _, memberships, _, distances, *_ = found
    return float(np.sum((memberships * distances) ** 2))


def clusterings(rows, clusters):
    """Compare what fuzzy c-means reach from the same k-means++ centres, and their times."""
    fuzzy_c_means(rows, clusters, random_state=0)  # compiles
    table = []
    for start in range(5):
        # ours first converges on every tenth row
        centers, _ = kmeans_plusplus(rows[::10], clusters, random_state=start)
        begin = process_time()
        ours = fuzzy_c_means(rows, clusters, random_state=start).objective
        between = process_time()
        theirs = scikit_fuzzy(rows, centers)
        times = three_digits(between - begin), three_digits(process_time() - between)
        table.append([str(start), f"{ours:.8g}", times[0], f"{theirs:.8g}", times[1]])
    columns = "Start", "fprc: objective", "fprc [s]", "scikit-fuzzy: objective", "scikit-fuzzy [s]"
    return pd.DataFrame(table, columns=columns)


if __name__ == "__main__":
    os.sched_setaffinity(0, {min(os.sched_getaffinity(0))})  # before JAX counts the cores
    X, fuzzy = load_hysteresis("sweep").data, FPRC(random_state=1)
    with threadpool_limits(1):
        ours = EchoStates(washout=0, random_state=1).fit(X[:, :1])
        rows = fuzzy.make_features().fit(X).transform(X)
        processor = "{cpu}, {blas}".format(**machine()) + f", {date.today()}"
        for table in networks(ours, X[:, :1]), clusterings(rows, fuzzy.n_c):
            table.insert(0, "Processor", processor)
            print(table.to_markdown(index=False, disable_numparse=True), end="\n\n")
