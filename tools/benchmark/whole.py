"""Time `all` against the same rules without compiled code, both from scratch.

    python tests/plain.py results/benchmark/all.json

The last commit is cloned twice. One clone uses no compiled code of ours: scikit-fuzzy's fuzzy
c-means, NumPy line by line for the ESN states and the steps of the models, and
Python numbers for the rig's equations; each fold solves its own ridge. Everything else is the
same, and so is the number of cores. The plain clone takes about half an hour.
"""

import argparse
import csv
import json
import os
import resource
import subprocess
import sys
import tempfile
import time
from importlib.util import find_spec
from pathlib import Path

ROOT = Path(__file__).parents[1]

#: What stands at the end of each module instead of our own.
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
            return SimpleNamespace(**{name: plain(each) for name, each in value.items()})
        return [float(each) for each in value] if isinstance(value, (list, tuple)) else float(value)

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

#: Tables whose errors both must give, and the largest relative difference that is the same.
SAME = ("table2.csv", "table3.csv")
LIMIT = 1e-3


def clone(folder: Path, plain: bool) -> None:
    """Check the last commit out, with the plain implementations or without."""
    subprocess.run(["git", "clone", "--quiet", str(ROOT), str(folder)], check=True)
    if plain:
        make_plain(folder / "src/fprc")


def make_plain(package: Path) -> None:
    """Let a copy of the package compute plainly."""
    for name, code in PLAIN.items():
        module = package / name
        module.write_text(module.read_text(encoding="utf-8") + code, encoding="utf-8")


def build(folder: Path, cores: int, smoke: bool) -> dict[str, float]:
    """Run the workflow and return its seconds, on the clock and of all processors."""
    small = ["--configfile", "config/smoke.yaml"] if smoke else []
    before, began = resource.getrusage(resource.RUSAGE_CHILDREN), time.monotonic()
    subprocess.run(
        [sys.executable, "-m", "snakemake", "--cores", str(cores), "all", *small],
        cwd=folder,
        env=os.environ | {"PYTHONPATH": str(folder / "src")},
        check=True,
    )
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    spent = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
    return {"seconds": time.monotonic() - began, "processor_s": spent}


def errors(tables: Path) -> dict[tuple[str, ...], float]:
    """Return the RMSEs of both tables by what they are of."""
    found = {}
    for name in SAME:
        with (tables / name).open(encoding="utf-8", newline="") as file:
            for row in csv.DictReader(file):
                found[name, row["model"], row["metric"]] = float(row["mean"])
    return found


def main() -> int:
    """Build both, and write what they took and by how much their errors differ."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("report", type=Path)
    parser.add_argument("--cores", type=int, default=2)
    parser.add_argument("--smoke", action="store_true", help="small settings, minutes")
    given = parser.parse_args()
    if not find_spec("skfuzzy"):
        parser.error("scikit-fuzzy is not installed; use `make benchmark-all`")
    found, tables = {}, []
    with tempfile.TemporaryDirectory() as scratch:
        for name in ("ours", "theirs"):
            folder = Path(scratch, name)
            clone(folder, plain=name == "theirs")
            found[name] = build(folder, given.cores, given.smoke)
            print(f"{name}: {found[name]}", flush=True)
            tables.append(
                errors(folder / ("results/smoke" if given.smoke else "results") / "tables")
            )
    ours, theirs = tables
    found["difference"] = max(abs(ours[key] / theirs[key] - 1.0) for key in ours)
    found |= {"limit": LIMIT, "cores": given.cores}
    given.report.parent.mkdir(parents=True, exist_ok=True)
    given.report.write_text(json.dumps(found, indent=1) + "\n", encoding="utf-8")
    if found["difference"] > LIMIT:
        print(f"the errors differ by {found['difference']:.1%}: no ratio will be given")
    return 0


if __name__ == "__main__":
    sys.exit(main())
