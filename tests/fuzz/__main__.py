"""Run the commands on damaged and odd files: `make fuzz`.

Each case depends only on the seed and its number, so it can be repeated alone:

    python tests/fuzz --seed 1 --case 4711

The folder given by ``--keep`` gets the files of cases with a forbidden outcome.
"""

import argparse
import json
import os
import subprocess
import sys
import tempfile
import time
from collections import Counter
from collections.abc import Iterator
from pathlib import Path
from typing import Any

os.environ["OPENBLAS_NUM_THREADS"] = "1"  # fork needs a process without threads


def main() -> int:
    """Run the cases; return 1 if one has a forbidden outcome."""
    options = _parser().parse_args()
    if options.worker is not None:
        return _work(options)
    if options.case is not None:
        return _repeat(options)
    begun_s = time.monotonic()
    print(f"seed {options.seed}, {options.cases} cases", flush=True)
    counts: Counter[tuple[str, str, str]] = Counter()
    cases: Counter[str] = Counter()
    seconds: Counter[tuple[str, str]] = Counter()
    for found in _results(options):
        cases[found["kind"]] += 1
        for row, outcome, why, took_s in found["results"]:
            counts[found["kind"], row, outcome] += 1
            seconds[found["kind"], row] += took_s
            if outcome in _faults():
                print(f"case {found['number']}, {row}: {outcome}: {why}", flush=True)
                print(f"    {found['kind']}: {found['what']}", flush=True)
    import page

    for line in page.table(cases, counts):
        print(line)
    if options.times:
        print("\n".join(page.times(counts, seconds)))
    if options.write:
        page.write(options.write, options.seed, cases, counts)
    again = f"--seed {options.seed} --kind {options.kind!r} --case N"
    bad = sum(number for (_, _, outcome), number in counts.items() if outcome in _faults())
    missing = options.cases - sum(cases.values())
    print(f"{time.monotonic() - begun_s:.0f} s; {bad} forbidden outcomes", flush=True)
    if missing:
        print(f"{missing} cases were not run", flush=True)
    if bad:
        print(f"their files are in {options.keep}; repeat one with {again}")
    return int(bool(bad or missing))


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(prog="python tests/fuzz", description=__doc__.split("\n")[0])
    parser.add_argument("--cases", type=int, default=10_000, help="default: %(default)s")
    parser.add_argument("--seed", type=int, default=1, help="default: %(default)s")
    parser.add_argument("--case", type=int, help="run only this case and show its output")
    parser.add_argument("--kind", default="", help="only cases of this module: model_files")
    parser.add_argument("--workers", type=int, default=2, help="default: %(default)s")
    parser.add_argument("--keep", default=".fuzz", help="default: %(default)s")
    parser.add_argument("--write", metavar="PAGE.md", help="write the table there")
    parser.add_argument("--times", action="store_true", help="print the time of each command")
    parser.add_argument("--worker", type=int, help=argparse.SUPPRESS)
    return parser


def _faults() -> tuple[str, ...]:
    from judging import FAULTS

    return FAULTS


def _results(options: argparse.Namespace) -> Iterator[dict[str, Any]]:
    """Yield the results of the workers as they arrive."""
    import selectors

    same = [sys.executable, str(Path(__file__).parent), *sys.argv[1:]]
    with selectors.DefaultSelector() as selector:
        for worker in range(options.workers):
            process = subprocess.Popen(
                [*same, "--worker", str(worker)], stdout=subprocess.PIPE, text=True
            )
            selector.register(process.stdout, selectors.EVENT_READ, process)
        while selector.get_map():
            for key, _ in selector.select():
                line = key.fileobj.readline()
                if line:
                    yield json.loads(line)
                else:
                    selector.unregister(key.fileobj)
                    key.data.communicate()
                    if key.data.returncode:
                        print(f"a worker ended with code {key.data.returncode}", flush=True)


def _work(options: argparse.Namespace) -> int:
    """Run every n-th case and print its result as JSON."""
    import cases

    answer = os.fdopen(os.dup(1), "w", encoding="utf-8")
    os.dup2(2, 1)  # other output must not mix with the answers
    with tempfile.TemporaryDirectory(prefix="fuzz") as folder:
        cases.warm_up(Path(folder))
        numbers = range(options.worker, options.cases, options.workers)
        for found in cases.run(
            options.seed, numbers, Path(folder), Path(options.keep), options.kind
        ):
            print(json.dumps(found), file=answer, flush=True)
    return 0


def _repeat(options: argparse.Namespace) -> int:
    """Run one case again, keep its files, and print the output of each command."""
    import cases

    folder = Path(tempfile.mkdtemp(prefix="fuzz"))
    return cases.show(options.seed, options.case, folder, options.kind)


if __name__ == "__main__":
    sys.exit(main())
