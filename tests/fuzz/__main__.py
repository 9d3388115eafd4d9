"""Run the commands on damaged and odd files: `make fuzz`.

Each case depends only on the seed and its number, so it can be repeated alone:

    python tests/fuzz --seed 1 --case 4711

The folder given by ``--keep`` gets the files of cases with a forbidden outcome.
"""

import argparse
import multiprocessing
import os
import sys
import tempfile
from collections import Counter
from concurrent.futures import ProcessPoolExecutor
from functools import partial
from pathlib import Path

os.environ["OPENBLAS_NUM_THREADS"] = "1"  # fork needs a process without threads


def main() -> int:
    """Run the cases; return 1 if one has a forbidden outcome."""
    import cases
    from judging import FAULTS, GOOD

    options = _parser().parse_args()
    if options.case is not None:
        place = Path(tempfile.mkdtemp(prefix="fuzz"))
        return cases.show(options.seed, options.case, place, options.kind)
    counts: Counter[tuple[str, str, str]] = Counter()
    with tempfile.TemporaryDirectory(prefix="fuzz") as folder:
        cases.warm_up(Path(folder))
        run = partial(
            cases.run, options.seed, folder=Path(folder), keep=Path(options.keep), kind=options.kind
        )
        fork = multiprocessing.get_context("fork")
        with ProcessPoolExecutor(options.workers, mp_context=fork) as pool:
            for number, (case, results) in enumerate(pool.map(run, range(options.cases))):
                for row, outcome, why in results:
                    counts[case.kind, row, outcome] += 1
                    if outcome in FAULTS:
                        print(f"case {number}, {row}: {outcome}: {why}", flush=True)
                        print(f"    {case.kind}: {case.what}", flush=True)
    print(f"seed {options.seed}, {options.cases} cases")
    for kind, row in sorted({each[:2] for each in counts}):
        each = {outcome: counts[kind, row, outcome] for outcome in (*GOOD, *FAULTS)}
        print(f"{kind}, {row}:", *(f"{outcome} {n}," for outcome, n in each.items() if n))
    bad = sum(n for (_, _, outcome), n in counts.items() if outcome in FAULTS)
    print(f"{bad} forbidden outcomes")
    if bad:
        again = f"--seed {options.seed} --kind {options.kind!r} --case N"
        print(f"their files are in {options.keep}; repeat one with {again}")
    return int(bool(bad))


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(prog="python tests/fuzz", description=__doc__.split("\n")[0])
    parser.add_argument("--cases", type=int, default=10_000, help="default: %(default)s")
    parser.add_argument("--seed", type=int, default=1, help="default: %(default)s")
    parser.add_argument("--case", type=int, help="run only this case and show its output")
    parser.add_argument("--kind", default="", help="only cases of this module: model_files")
    parser.add_argument("--workers", type=int, default=2, help="default: %(default)s")
    parser.add_argument("--keep", default=".fuzz", help="default: %(default)s")
    return parser


if __name__ == "__main__":
    sys.exit(main())
