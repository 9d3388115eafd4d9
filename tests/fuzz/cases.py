"""The kind of each case by its number, and how a case runs."""

import io
import shutil
from collections.abc import Callable, Iterable, Iterator
from contextlib import redirect_stderr, redirect_stdout
from pathlib import Path
from typing import Any

import configs
import csv_files
import dry_runs
import imports
import journals
import judging
import mat_files
import model_files
import numpy as np
import raw_logs
import signals
import supervised
from judging import Case

from fprc.cli import main

Make = Callable[[np.random.Generator, Path], Case]

#: Counts per 500 cases, fewer of the slow kinds: 10,000 cases take 15 minutes on two cores.
MIX: tuple[tuple[Make, int], ...] = (
    (configs.case, 165),
    (model_files.case, 50),
    (journals.case, 75),
    (csv_files.case, 85),
    (mat_files.case, 34),
    (raw_logs.flipped, 45),
    (raw_logs.torn, 16),
    (raw_logs.altered, 29),
)
_TURNS = [make for make, number in MIX for _ in range(number)]
#: Position of the one dry run in 500 cases; `make test` runs the first 200.
_DRY_RUN_AT = 100


def make_case(seed: int, number: int, folder: Path, kind: str = "") -> Case:
    """Write the files of a case into an empty folder.

    Parameters
    ----------
    kind : str, optional
        Module that makes all cases, such as ``model_files``; by default each makes its share.
    """
    if kind:
        ways = [make for make, _ in MIX if make.__module__ == kind]
        return ways[number % len(ways)](np.random.default_rng([seed, number]), folder)
    order = np.random.default_rng(seed).permutation(len(_TURNS))
    turns = [_TURNS[k] for k in order]
    turns.insert(_DRY_RUN_AT, dry_runs.case)
    make = turns[number % len(turns)]
    return make(np.random.default_rng([seed, number]), folder)


def run(
    seed: int, numbers: Iterable[int], folder: Path, keep: Path, kind: str
) -> Iterator[dict[str, Any]]:
    """Yield the result of each case; keep the files of cases with a forbidden outcome."""

    def make(number: int, place: Path) -> Case:
        return make_case(seed, number, place, kind)

    for number, found in supervised.results(numbers, make, folder):
        if any(outcome in judging.FAULTS for _, outcome, *_ in found["results"]):
            place, again = keep / f"seed_{seed}_case_{number}", folder / "again"
            shutil.rmtree(again, ignore_errors=True)
            again.mkdir()
            make(number, again)
            shutil.rmtree(place, ignore_errors=True)
            shutil.copytree(again, place, symlinks=True)
            lines = [f"{found['kind']}: {found['what']}"]
            lines += [f"{row}: {outcome}: {why}" for row, outcome, why, _ in found["results"]]
            (place / "WHAT.txt").write_text("\n".join(lines) + "\n", "utf-8", "backslashreplace")
        yield {"number": number, **found}


def show(seed: int, number: int, folder: Path, kind: str) -> int:
    """Run a case, print the output of its commands, and keep its files."""
    place = folder / "case"
    place.mkdir()
    case = make_case(seed, number, place, kind)
    print(f"{case.kind}: {case.what}\nfiles in {place}", flush=True)
    bad = False
    for step in case.steps:
        print(f"--- {step.row}: {' '.join(step.command)}", flush=True)
        found, ended = judging.run(step, case, place, lambda: None)
        print(f"exit code {ended.code}\n{ended.out[-3000:]}{ended.err[-3000:]}")
        print(f"{found.outcome}: {found.why} ({found.seconds:.1f} s)", flush=True)
        bad |= found.outcome in judging.FAULTS
    return int(bad)


def warm_up(folder: Path) -> None:
    """Run each kind of command once before forking, so imports and compilation are done."""
    place = folder / "warm"
    place.mkdir()
    (place / "log.h5").write_bytes(raw_logs.logs()["sweep"].data)
    (place / configs.NAME).write_text("seed: 3\n")
    channels = signals.hysteresis()
    np.savetxt(
        place / csv_files.NAME, np.column_stack(list(channels.values())), delimiter=",",
        header=",".join(channels), comments="",
    )  # fmt: skip
    columns = {name: name for name in ("theta_deg", "p_exp_kpa", "p_o_kpa")}
    mapping = imports.any_map(np.random.default_rng(0), columns, {"column": "time_s"}, 200.0)
    imports.write_map(place, mapping)
    (place / "run.journal").write_bytes(journals.runs()["closed"].data)
    (place / model_files.NAME).write_bytes(model_files.models()["fprc"].data)
    names = {name: str(place / name) for name in (configs.NAME, csv_files.NAME, imports.MAP)}
    for command in (
        ("log", "check", str(place / "log.h5")),
        ("log", "repair", str(place / "run.journal"), "--out", str(place / "run.h5")),
        ("config", "check", names[configs.NAME]),
        ("export", str(place / model_files.NAME), "--c", str(place / model_files.HEADER)),
        ("import", names[csv_files.NAME], "--list"),
        ("import", names[csv_files.NAME], "--map", names[imports.MAP], "--out", f"{place}/out.h5"),
    ):
        said = io.StringIO()
        with redirect_stdout(said), redirect_stderr(said):
            code = main(command)
        if code:
            raise RuntimeError(f"fprc {' '.join(command)}: exit code {code}\n{said.getvalue()}")
    shutil.rmtree(place)
