"""Build everything twice under different circumstances and compare every file.

    python tests/twice.py            # the paper, as `make reproduce-twice` does
    python tests/twice.py --smoke    # small settings

Execution times are measured and differ; the second build is therefore given the first
one's measurements, and made again from there. Then every table, figure and page must be
the same, byte by byte. Logs name processes and are not compared.
"""

import argparse
import hashlib
import os
import shutil
import subprocess
import sys
import tempfile
import time
from collections.abc import Mapping, Sequence
from pathlib import Path

ROOT = Path(__file__).parents[1]

#: What is measured, not computed.
MEASURED = ("timing/times.json", "timing/times_over_n_c.json", "timing/steps.json")

#: Cores, time zone and locale of the builds. With four cores the long sweeps have two processes; in
#: the second build text that names no encoding is ASCII.
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
    """Put the first results' measured times among the second's."""
    for name in MEASURED:
        shutil.copyfile(first / name, second / name)


def hashes(results: Path) -> dict[str, str]:
    """Return the SHA-256 of every result but the logs."""
    return {
        str(path.relative_to(results)): hashlib.sha256(path.read_bytes()).hexdigest()
        for path in sorted(results.rglob("*"))
        if path.is_file() and path.relative_to(results).parts[0] not in ("logs", "smoke")
    }


def differences(first: Mapping[str, str], second: Mapping[str, str]) -> list[str]:
    """Return the files that only one has, or that differ."""
    return sorted(
        name for name in first.keys() | second.keys() if first.get(name) != second.get(name)
    )


def table(first: Mapping[str, str], different: Sequence[str]) -> str:
    """Return how many files of each kind are the same."""
    kinds = sorted({Path(name).suffix for name in (*first, *different)})
    lines = ["kind    files  different", "------  -----  ---------"]
    for kind in kinds:
        files = [name for name in first if Path(name).suffix == kind]
        count = sum(Path(name).suffix == kind for name in different)
        lines.append(f"{kind:6}  {len(files):5}  {count:9}")
    return "\n".join([*lines, *(f"different: {name}" for name in different)])


def build(folder: Path, circumstances: tuple[str, Mapping[str, str]], *arguments: str) -> None:
    """Run the workflow of a checkout with its own package."""
    cores, environment = circumstances
    subprocess.run(
        [sys.executable, "-m", "snakemake", "--cores", cores, "all", *arguments],
        cwd=folder,
        env=os.environ | {"PYTHONPATH": str(folder / "src")} | environment,
        check=True,
    )


def main() -> int:
    """Build twice and say what differs; 1 if anything does."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--smoke", action="store_true", help="small settings, minutes")
    small = parser.parse_args().smoke
    arguments = ["--configfile", "config/smoke.yaml"] if small else []
    with tempfile.TemporaryDirectory() as scratch:
        folders = Path(scratch, "one"), Path(scratch, "a folder", "two")
        for folder, circumstances in zip(folders, CIRCUMSTANCES, strict=True):
            clone = ["git", "clone", "--quiet", "--no-hardlinks", str(ROOT), str(folder)]
            subprocess.run(clone, check=True)
            began = time.monotonic()
            build(folder, circumstances, *arguments)
            print(f"{folder}: {time.monotonic() - began:.0f} s, {circumstances}", flush=True)
        results = [folder / ("results/smoke" if small else "results") for folder in folders]
        give_measurements(*results)
        build(folders[1], CIRCUMSTANCES[1], *arguments)
        first, second = map(hashes, results)
        if not small:
            first |= {f"raw/{k}": v for k, v in hashes(folders[0] / "data/raw").items()}
            second |= {f"raw/{k}": v for k, v in hashes(folders[1] / "data/raw").items()}
    different = differences(first, second)
    print(table(first, different))
    return int(bool(different))


if __name__ == "__main__":
    sys.exit(main())
