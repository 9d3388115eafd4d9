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
from tools.benchmark.peers import PEERS, Peer

PAGE = Path(__file__).parents[2] / "docs/repeat.md"
#: States that differ by less are the same; what is compared takes so many turns.
SAME, ROUNDS = 1e-12, 5
OURS, LIMIT, PROCESSOR = "fprc", "W_r x alone, by BLAS", "Processor"


def interleaved(work: Mapping[str, Callable[[], object]]) -> dict[str, list[float]]:
    """Return the processor seconds of each piece of work in each round; the pieces take turns."""
    seconds: dict[str, list[float]] = {name: [] for name in work}
    for _ in range(ROUNDS):
        for name, run in work.items():
            begin = process_time()
            run()
            seconds[name].append(process_time() - begin)
    return seconds


def ours(features: EchoStates) -> Peer:
    """Return our network in the form of the others: our rows have x(k) after the taps."""
    last = features.r
    return lambda X: features.transform(np.vstack([X, X[-1:]]))[1:, -last:], features.advance


def limit(features: EchoStates) -> Peer:
    """Return W_r x by BLAS, which is most of the work: of a thousand samples at once, or of one.

    The first is limited by multiplications, the second, in float32, by reading W_r.
    """
    W_r, rows = features.W_r_, np.ones((1000, features.r))
    narrow, x = W_r.astype(np.float32), np.ones(features.r, np.float32)
    return lambda X: [rows @ W_r for _ in range(len(X) // 1000)][-1], lambda theta: narrow @ x


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
    steps = {name: partial(_stepped, step, few) for name, (_, step) in sides.items() if step}
    features.reset(few[0])
    for run in steps.values():  # they compile
        run()
    logs = {name: partial(states, X) for name, (states, _) in sides.items()}
    columns: dict[str, dict[str, str]] = {}
    for what, work, samples in (("log", logs, len(X)), ("step", steps, len(few))):
        seconds = interleaved(work)
        columns[f"{what}, us a sample"] = {
            name: three_digits(1e6 * statistics.median(taken) / samples)
            for name, taken in seconds.items()
        }
        columns[f"{what}, times ours"] = {
            name: _ratio(taken, seconds[OURS]) for name, taken in seconds.items()
        }
    columns["States differ by"] = {name: f"{by:.0e}" for name, by in off.items() if by}
    return (
        pd.DataFrame(columns, index=[*off, LIMIT]).fillna("").rename_axis("Library").reset_index()
    )


def _stepped(step: Callable[[np.ndarray], np.ndarray], X: np.ndarray) -> None:
    for theta in X:
        step(theta)


def _ratio(theirs: Sequence[float], ours: Sequence[float]) -> str:
    """Return the median of the rounds' ratios, with the smallest and the largest."""
    ratios = [a / b for a, b in zip(theirs, ours, strict=True)]
    return within(statistics.median(ratios), min(ratios), max(ratios))


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


def with_others(table: pd.DataFrame, block: str) -> pd.DataFrame:
    """Return a table of this processor, and below it the rows of others that a page has."""
    lines = [line for line in block.splitlines() if line.startswith("|")]
    cells = [[cell.strip() for cell in line.split("|")[1:-1]] for line in lines]
    here = table[PROCESSOR][0]
    kept, ours = [], False
    for row in cells:
        if row[0] == PROCESSOR:
            ours = row == list(table)
        elif ours and row[0].split(",")[:2] != here.split(",")[:2] and row[0][:1].isalpha():
            kept.append(dict(zip(table, row, strict=True)))
    return pd.concat([table, pd.DataFrame(kept)])


def report(block: str) -> str:
    """Measure everything; return it in Markdown, with what ``block`` has of other processors."""
    X, fuzzy = load_hysteresis("sweep").data, FPRC(random_state=1)
    theta = X[:, :1]
    features = EchoStates(washout=0, random_state=1).fit(theta)
    rows = fuzzy.make_features().fit(X).transform(X)
    found, load = machine(), os.getloadavg()[0]  # this process keeps one core busy itself
    busy = f", load {load:.0f}" if load > 1.5 else ""
    here = f"{found['cpu']}, {found['blas']}, {date.today().isoformat()}{busy}"
    tables = []
    for table in (networks(features, theta), clusterings(rows, fuzzy.n_c)):
        table.insert(0, PROCESSOR, here)
        tables.append(with_others(table, block).to_markdown(index=False, disable_numparse=True))
    return (
        f"ESN with {features.r} states, float64, {len(theta)} samples, medians of {ROUNDS} rounds "
        f"in turn; in brackets the smallest and largest ratio of a round:\n\n{tables[0]}\n\n"
        f"Fuzzy c-means of {len(rows)} rows of {rows.shape[1]} features, {fuzzy.n_c} clusters:"
        f"\n\n{tables[1]}"
    )


def main() -> None:
    """Measure, print the tables, and write them to the page."""
    if hasattr(os, "sched_setaffinity"):  # before JAX counts the cores
        os.sched_setaffinity(0, {min(os.sched_getaffinity(0))})
    text = PAGE.read_text(encoding="utf-8")
    with threadpool_limits(1):
        found = report(text.partition("<!-- benchmark: generated")[2].partition("<!-- ")[0])
    print(found)
    write_text(PAGE, replace_block(text, "benchmark", found, str(PAGE)))


if __name__ == "__main__":
    main()
