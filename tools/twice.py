"""Build the paper twice under different conditions and compare every file.

Execution times differ from build to build, so the second build gets the measurements of the first
and is made again from there. Then every table, figure and page must have the same bytes. Logs
contain process ids and are not compared.
"""

import os
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Mapping
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
    """Put the first results' measured times among the second's."""
    for name in MEASURED:
        shutil.copyfile(first / name, second / name)


def agree(first: Path, second: Path) -> bool:
    """Print the files but logs that only one folder has, or whose bytes differ; True if none."""
    command = ["diff", "--recursive", "--brief", "--exclude", "logs", str(first), str(second)]
    return subprocess.run(command, check=False).returncode == 0


def build(folder: Path, circumstances: tuple[str, Mapping[str, str]], *arguments: str) -> None:
    """Run the workflow of a checkout with the package of that checkout."""
    cores, environment = circumstances
    subprocess.run(
        [sys.executable, "-m", "snakemake", "--cores", cores, "all", *arguments],
        cwd=folder,
        env=os.environ | {"PYTHONPATH": str(folder / "src")} | environment,
        check=True,
    )


def main() -> int:
    """Build twice and print what differs; return 1 if anything does."""
    with tempfile.TemporaryDirectory() as scratch:
        first, second = Path(scratch, "build"), Path(scratch, "build 1")
        for folder, circumstances in zip((first, second), CIRCUMSTANCES, strict=True):
            clone = ["git", "clone", "--quiet", "--no-hardlinks", str(ROOT), str(folder)]
            subprocess.run(clone, check=True)
            build(folder, circumstances)
        give_measurements(first / "results", second / "results")
        build(second, CIRCUMSTANCES[1])
        same = [agree(first / part, second / part) for part in ("data", "results")]
    print("all files have the same bytes" if all(same) else "the files above differ")
    return int(not all(same))


if __name__ == "__main__":
    sys.exit(main())
