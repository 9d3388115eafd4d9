"""The kind of each case by its number, and how a case runs."""

import io
import shutil
from collections.abc import Callable
from contextlib import redirect_stderr, redirect_stdout
from pathlib import Path

import configs
import csv_files
import imports
import journals
import judging
import mat_files
import model_files
import numpy as np
import raw_logs
import running
import signals
from judging import Case, Result

from fprc.cli import main

Make = Callable[[np.random.Generator, Path], Case]

#: Counts per 500 cases, fewer of the slow kinds: 10,000 cases take 15 minutes on two cores.
MIX: tuple[tuple[Make, int], ...] = (
    (configs.case, 165),
    (model_files.case, 50),
    (journals.case, 75),
    (csv_files.case, 85),
    (mat_files.case, 34),
    (raw_logs.flipped, 60),
    (raw_logs.torn, 30),
)
_TURNS = [make for make, number in MIX for _ in range(number)]


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
    make = _TURNS[order[number % len(order)]]
    return make(np.random.default_rng([seed, number]), folder)


def run(seed: int, number: int, folder: Path, keep: Path, kind: str) -> tuple[Case, list[Result]]:
    """Run a case and return its results; keep its files if one of them is forbidden."""
    place = folder / f"case{number}"
    place.mkdir()
    case = make_case(seed, number, place, kind)
    results = [running.attempt(step, case, place)[0] for step in case.steps]
    shutil.rmtree(place)
    if any(result.outcome in judging.FAULTS for result in results):
        kept = keep / f"seed_{seed}_case_{number}"
        shutil.rmtree(kept, ignore_errors=True)
        kept.mkdir(parents=True)
        make_case(seed, number, kept, kind)
        lines = [f"{case.kind}: {case.what}", *(": ".join(result) for result in results)]
        (kept / "WHAT.txt").write_text("\n".join(lines) + "\n", "utf-8", "backslashreplace")
    return case._replace(steps=[]), results


def show(seed: int, number: int, folder: Path, kind: str) -> int:
    """Run a case, print the output of its commands, and keep its files."""
    case = make_case(seed, number, folder, kind)
    print(f"{case.kind}: {case.what}\nfiles in {folder}", flush=True)
    bad = False
    for step in case.steps:
        print(f"--- {step.row}: {' '.join(step.command)}", flush=True)
        found, ended = running.attempt(step, case, folder)
        if ended:
            print(f"exit code {ended.code}\n{ended.out[-3000:]}{ended.err[-3000:]}")
        print(f"{found.outcome}: {found.why}", flush=True)
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
