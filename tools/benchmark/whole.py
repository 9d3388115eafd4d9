"""Time `all` against the same rules without compiled code: `make benchmark-all`.

    python -m tools.benchmark.whole --page docs/running.md

The last commit is cloned twice. One clone uses no compiled code of ours: scikit-fuzzy's fuzzy
c-means, NumPy line by line for the ESN states and the steps of the models, and
Python numbers for the rig's equations; each fold solves a separate ridge. Everything else is the
same, and so is the number of cores. The plain clone takes about half an hour, in which nothing else
should run.
"""

import argparse
import csv
import os
import subprocess
import sys
import tempfile
import time
from datetime import date
from pathlib import Path

from fprc.evaluation.timing import machine
from tools.benchmark import refuse_other_kernels, show

ROOT = Path(__file__).parents[2]

#: What is appended to each module to replace our functions.
PLAIN = {
    "compiled.py": """
def kernel(function, **options):
    return function
""",
    "rig/parameters.py": """
def record(settings):
    from types import SimpleNamespace

    def plain(value):
        if isinstance(value, Mapping):
            return SimpleNamespace(**{name: plain(part) for name, part in value.items()})
        return [float(x) for x in value] if isinstance(value, (list, tuple)) else float(value)

    return [plain(settings)]
""",
    "rig/simulator.py": """
_of_numbers = advance

def advance(states, rigs, instruments, valve_v, push_kpa, noise, *rest):
    # Python is slow on the numbers of an array
    return _of_numbers(
        states, rigs, instruments, valve_v.tolist(), push_kpa, noise.tolist(), *rest
    )
""",
    "models/fcm.py": """
_extrapolating = fuzzy_c_means

def fuzzy_c_means(X, n_clusters, **options):
    return _extrapolating(X, n_clusters, **{**options, "clustering": "scikit-fuzzy"})
""",
    "models/echo.py": """
def echo_states(X, w_in, W_r, gamma, free=0):
    rows, x = np.empty((len(X), free + len(W_r))), np.zeros(len(W_r))
    for k, theta in enumerate(X):
        rows[k, free:] = x
        x = gamma * x + (1.0 - gamma) * np.tanh(w_in @ theta + W_r @ x)
    return rows
""",
    "models/echo_features.py": """
def _update(self, u):
    self._state = self.gamma * self._state + (1.0 - self.gamma) * self._target
    self._target = np.tanh(self.w_in_ @ u + self.W_r_ @ self._state)

EchoStates._update = _update
""",
    "models/features.py": """
def _step(self, x):
    split, filtered = self._split, self._filtered
    filtered[:split] = x[:split]
    filtered[split:] += self.epsilon * (x[split:] - filtered[split:])
    self._row[1:] = self._row[:-1]
    self._row[self._first] = filtered
    return self._row

TapFeatures._step = _step
""",
    "models/takagi_sugeno.py": """
def _output(self, x):
    away = x - self.centers_
    distance2 = (away * away).sum(axis=1)
    beta = np.exp((distance2.min() - distance2) / (2.0 * self.sigma**2))
    return float(beta @ (self.W_out_[:, 0] + self.W_out_[:, 1:] @ x) / beta.sum())

TakagiSugenoReadout.output = _output
""",
    "evaluation/crossval.py": """
def _is_partition(folds, samples):
    return False
""",
}

#: Tables whose errors both must give, and the largest relative difference of the same errors.
SAME = ("table2.csv", "table3.csv")
LIMIT = 1e-3


def clone(folder: Path, plain: bool) -> None:
    """Check the last commit out, with the plain implementations or without."""
    subprocess.run(["git", "clone", "--quiet", str(ROOT), str(folder)], check=True)
    if plain:
        make_plain(folder / "src/fprc")


def make_plain(package: Path) -> None:
    """Replace the compiled functions in a copy of the package by plain ones."""
    for name, code in PLAIN.items():
        module = package / name
        module.write_text(module.read_text(encoding="utf-8") + code, encoding="utf-8")


def build(folder: Path, cores: int, smoke: bool) -> float:
    """Run the workflow and return its seconds."""
    small = ["--configfile", "config/smoke.yaml"] if smoke else []
    began = time.monotonic()
    subprocess.run(
        [sys.executable, "-m", "snakemake", "--cores", str(cores), "all", *small],
        cwd=folder,
        env=os.environ | {"PYTHONPATH": str(folder / "src")},
        check=True,
    )
    return time.monotonic() - began


def errors(tables: Path) -> dict[tuple[str, ...], float]:
    """Return the RMSEs of both tables by what they are of."""
    found = {}
    for name in SAME:
        with (tables / name).open(encoding="utf-8", newline="") as file:
            for row in csv.DictReader(file):
                found[name, row["model"], row["metric"]] = float(row["mean"])
    return found


def report(cores: int, smoke: bool) -> str:
    """Build both; report their times and by how much their errors differ."""
    seconds, tables = [], []
    with tempfile.TemporaryDirectory() as scratch:
        for name in ("ours", "plain"):
            folder = Path(scratch, name)
            clone(folder, plain=name == "plain")
            seconds.append(build(folder, cores, smoke))
            tables.append(errors(folder / ("results/smoke" if smoke else "results") / "tables"))
    ours, plain = tables
    apart = max(abs(ours[key] / plain[key] - 1.0) for key in ours)
    where = f"Measured on {date.today().isoformat()} on {cores} cores of {machine()['cpu']}"
    if apart > LIMIT:
        return f"{where}: errors differ by {apart:.1%}, so the times cannot be compared."
    return (
        f"{where}: `all` from scratch takes {seconds[0]:.0f} s, and {seconds[1]:.0f} s without "
        f"compiled code, {seconds[1] / seconds[0]:.1f} times as long. The errors of Tables II and "
        f"III differ by at most {apart:.0e}."
    )


def main() -> None:
    """Run the command line."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--page", type=Path, help="write the result there too")
    parser.add_argument("--cores", type=int, default=2)
    parser.add_argument("--smoke", action="store_true", help="small settings, minutes")
    given = parser.parse_args()
    refuse_other_kernels()
    show({"all": report(given.cores, given.smoke)}, given.page)


if __name__ == "__main__":
    main()
