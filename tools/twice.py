"""Build everything twice under different conditions and compare every file.

    python tools/twice.py            # the paper, as `make reproduce-twice` does
    python tools/twice.py --smoke    # small settings

Execution times differ from build to build, so the second build gets the measurements of the first
and is made again from there. Then every table, figure and page must have the same bytes. Logs
contain process ids and are not compared.
"""

import argparse
import os
import shutil
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator, Mapping
from pathlib import Path

ROOT = Path(__file__).parents[1]

#: What is measured, not computed.
MEASURED = ("timing/times.json", "timing/times_over_n_c.json")

#: Cores, time zone and locale of the builds. In the second build text that names no
#: encoding is ASCII.
CIRCUMSTANCES = (
    ("4", {"TZ": "America/St_Johns", "LC_ALL": "C.UTF-8"}),
    (
        "1",
        {
            "TZ": "Pacific/Kiritimati",
            "LC_ALL": "C",
            "PYTHONUTF8": "0",
            "PYTHONCOERCECLOCALE": "0",
            "PYTHONHASHSEED": "4711",
        },
    ),
)


def give_measurements(first: Path, second: Path) -> None:
    """Put the first results' measured times among the second's, with their digests."""
    for name in MEASURED:
        for file in (name, f"digests/{name}.sha256"):
            shutil.copyfile(first / file, second / file)


def files(results: Path) -> dict[str, Path]:
    """Return every result but the logs, by name."""
    return {
        str(path.relative_to(results)): path
        for path in sorted(results.rglob("*"))
        if path.is_file() and path.relative_to(results).parts[0] not in ("logs", "smoke")
    }


def differences(first: Mapping[str, Path], second: Mapping[str, Path]) -> list[str]:
    """Return the files that only one has, or whose bytes differ."""
    shared = first.keys() & second.keys()
    same = {name for name in shared if first[name].read_bytes() == second[name].read_bytes()}
    return sorted((first.keys() | second.keys()) - same)


def build(folder: Path, circumstances: tuple[str, Mapping[str, str]], *arguments: str) -> None:
    """Run the workflow of a checkout with the package of that checkout."""
    cores, environment = circumstances
    subprocess.run(
        [sys.executable, "-m", "snakemake", "--cores", cores, "all", *arguments],
        cwd=folder,
        env=os.environ | {"PYTHONPATH": str(folder / "src")} | environment,
        check=True,
    )


def built(scratch: Path, small: bool) -> Iterator[Path]:
    """Build in a folder for each of the circumstances, and yield the folders of the results."""
    arguments = ["--configfile", "config/smoke.yaml"] if small else []
    first = None
    for number, circumstance in enumerate(CIRCUMSTANCES):
        folder = scratch / f"build {number}" if number else scratch / "build"
        clone = ["git", "clone", "--quiet", "--no-hardlinks", str(ROOT), str(folder)]
        subprocess.run(clone, check=True)
        began = time.monotonic()
        build(folder, circumstance, *arguments)
        print(f"{folder}: {time.monotonic() - began:.0f} s, {circumstance}", flush=True)
        results = folder / ("results/smoke" if small else "results")
        if first:
            give_measurements(first, results)
            build(folder, circumstance, *arguments)
        first = first or results
        if not small:
            (folder / "data/raw").rename(results / "raw")
        yield results


def main() -> int:
    """Build twice and print what differs; return 1 if anything does."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--smoke", action="store_true", help="small settings, minutes")
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as scratch:
        first, second = map(files, built(Path(scratch), options.smoke))
        different = differences(first, second)
        same = len(first) - len(different)
        print("\n".join([f"same bytes: {same}", *(f"different: {path}" for path in different)]))
    return int(bool(different))


if __name__ == "__main__":
    sys.exit(main())
