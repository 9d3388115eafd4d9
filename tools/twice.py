"""Build everything twice under different conditions and compare every file.

    python tools/twice.py            # the paper, as `make reproduce-twice` does
    python tools/twice.py --smoke    # small settings
    python tools/twice.py --processors --smoke    # as on other processors, `make processors`

Execution times differ from build to build, so the second build gets the measurements of the first
and is made again from there. Then every table, figure and page must have the same bytes. Logs
contain process ids and are not compared.

With ``--processors`` (Linux, x86-64) the first build uses this processor's instructions, and each
further build those of an older processor. The numbers in the results are compared.
"""

import argparse
import json
import math
import os
import shutil
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

import h5py
import numpy as np
import pandas as pd
from PIL import Image

from fprc.studies.stages.check import pixels_apart

ROOT = Path(__file__).parents[1]

#: What is measured, not computed.
MEASURED = ("timing/times.json", "timing/times_over_n_c.json", "timing/steps.json")

#: Cores, time zone and locale of the builds. With four cores the long grids have two processes; in
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

#: What makes the libraries leave out instructions that this processor may have.
PROCESSORS = {
    "OpenBLAS without AVX-512": {"OPENBLAS_CORETYPE": "Haswell"},
    "nothing with AVX or FMA": {
        "OPENBLAS_CORETYPE": "Nehalem",
        "NPY_DISABLE_CPU_FEATURES": ",".join(
            np.show_config(mode="dicts").get("SIMD Extensions", {}).get("found", [])
        ),
        "NUMBA_CPU_NAME": "nehalem",
        "NUMBA_CPU_FEATURES": "",
        "GLIBC_TUNABLES": "glibc.cpu.hwcaps=-AVX2,-FMA,-FMA4,-AVX512F,-AVX512VL",
    },
}

#: Largest relative difference of numbers that still count as the same.
AGREE = 0.01


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


def apart(one: Path, other: Path) -> float:
    """Return by how much the numbers of two files differ, relative to the largest of their list.

    Of pictures, the share of pixels that differ visibly. Infinity: something else differs.
    """
    if one.read_bytes() == other.read_bytes():
        return 0.0
    if one.suffix == ".png":
        with Image.open(one) as picture:
            return pixels_apart(one, other) / math.prod(picture.size)
    first, second = dict(_held(one)), dict(_held(other))
    if first.keys() != second.keys():
        return math.inf
    return max(_apart(np.asarray(first[name]), np.asarray(second[name])) for name in first)


def _held(path: Path) -> Iterator[tuple[str, Any]]:
    """Yield the lists, columns or values of a file by name."""
    if path.suffix == ".h5":
        found = []
        with h5py.File(path) as file:
            file.visit(found.append)
            yield from ((n, file[n][()]) for n in found if isinstance(file[n], h5py.Dataset))
    elif path.suffix == ".csv":
        yield from pd.read_csv(path).items()
    else:
        yield from _leaves(json.loads(path.read_text(encoding="utf-8")))


def _leaves(value: Any, name: str = "") -> Iterator[tuple[str, Any]]:
    if isinstance(value, list) and value and all(isinstance(item, float) for item in value):
        yield name, value
    elif isinstance(value, list | dict):
        for key, item in value.items() if isinstance(value, dict) else enumerate(value):
            yield from _leaves(item, f"{name}.{key}")
    else:
        yield name, value


def _apart(one: np.ndarray, other: np.ndarray) -> float:
    if one.dtype.kind != "f" or other.dtype.kind != "f":
        return 0.0 if np.array_equal(one, other) else math.inf
    if one.shape != other.shape or not np.array_equal(np.isnan(one), np.isnan(other)):
        return math.inf
    largest = np.nanmax(np.abs(one), initial=0.0)
    return float(np.nanmax(np.abs(one - other), initial=0.0) / (largest or 1.0))


def digits(first: Mapping[str, Path], second: Mapping[str, Path]) -> tuple[str, float]:
    """Return a table of how far two builds agree by folder, and by how much they differ at most."""
    folders: dict[str, list[str]] = {}
    for name, path in first.items():
        if name not in MEASURED and _has_numbers(path):
            folders.setdefault(Path(name).parts[0], []).append(name)
    lines = [f"{'results':21}  files  same bytes  apart", f"{'-' * 21}  -----  ----------  -------"]
    largest, different = 0.0, differences(first, second)
    for folder, names in folders.items():
        found = [apart(first[n], second[n]) if n in second else math.inf for n in names]
        same = len(set(names).difference(different))
        largest = max(largest, *found)
        lines.append(f"{folder:21}  {len(names):5}  {same:10}  {max(found):7.1e}")
    return "\n".join(lines), largest


def _has_numbers(path: Path) -> bool:
    """Return whether a result is a picture or has numbers; the JSON beside a picture has hashes."""
    beside_picture = path.suffix == ".json" and path.with_suffix(".png").exists()
    return path.suffix in (".h5", ".csv", ".json", ".png") and not beside_picture


def build(folder: Path, circumstances: tuple[str, Mapping[str, str]], *arguments: str) -> None:
    """Run the workflow of a checkout with the package of that checkout."""
    cores, environment = circumstances
    subprocess.run(
        [sys.executable, "-m", "snakemake", "--cores", cores, "all", *arguments],
        cwd=folder,
        env=os.environ | {"PYTHONPATH": str(folder / "src")} | environment,
        check=True,
    )


def built(scratch: Path, circumstances: Sequence[tuple], small: bool) -> Iterator[Path]:
    """Build in a folder for each of the circumstances, and yield the folders of the results."""
    arguments = ["--configfile", "config/smoke.yaml"] if small else []
    first = None
    for number, circumstance in enumerate(circumstances):
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
    """Build more than once and print what differs; return 1 if anything differs that must not."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--smoke", action="store_true", help="small settings, minutes")
    parser.add_argument("--processors", action="store_true", help="compute as on other processors")
    options = parser.parse_args()
    older = [("1", {}), *(("1", lacking) for lacking in PROCESSORS.values())]
    circumstances = older if options.processors else CIRCUMSTANCES
    names = PROCESSORS if options.processors else ["other circumstances"]
    agree = True
    with tempfile.TemporaryDirectory() as scratch:
        first, *others = map(files, built(Path(scratch), circumstances, options.smoke))
        for name, other in zip(names, others, strict=True):
            shown, largest = digits(first, other)
            print(f"\n{name}:\n{shown}")
            if options.processors:
                agree = agree and largest <= AGREE
            elif different := differences(first, other):
                agree = False
                print("\n".join(f"different: {path}" for path in different))
    return int(not agree)


if __name__ == "__main__":
    sys.exit(main())
