"""Dry runs of the workflow on damaged configurations and logs; few, since each takes seconds."""

import os
import shutil
import sys
from pathlib import Path

import configs
import damage
import numpy as np
import raw_logs
from judging import SAME, Case, Ended, Step, Verdict

ROOT = Path(__file__).parents[2]
_ROW = "snakemake -n"
#: Errors of Snakemake when it cannot read a configuration. It reads the file before it runs our
#: code, and does not name it.
_BY_ITSELF = (
    "Config file is not valid JSON or YAML",
    "Config file must be given as JSON or YAML",
    ", in load_configfile",  # an uncaught error of the YAML library
)


def project(folder: Path) -> Path:
    """Return a copy of the workflow for this process, in its own folder."""
    copy = folder / f"project{os.getpid()}"
    if copy.exists():  # of an earlier case
        return copy
    copy.mkdir()
    for name in ("config", "workflow"):
        shutil.copytree(ROOT / name, copy / name)
    return copy


def case(rng: np.random.Generator, folder: Path) -> Case:
    """Make a case with a configuration or a log for the dry run."""
    return (_config if rng.random() < 0.5 else _log)(rng, folder)


def _config(rng: np.random.Generator, folder: Path) -> Case:
    made = configs.case(rng, folder)
    (step,) = made.steps

    def planned(folder: Path, ended: Ended) -> Verdict:
        return step.judge(folder, ended)

    return Case("dry run", made.what, [step, config_step(folder, step.names, planned)])


def config_step(folder: Path, names: tuple[str, ...], judge) -> Step:
    """Return the dry run of the configuration in a folder."""
    command = ["--configfile", str(folder / configs.NAME)]
    return _step(folder, command, (*names, *_BY_ITSELF), judge)


def _log(rng: np.random.Generator, folder: Path) -> Case:
    raw = folder / "raw"
    raw.mkdir()
    log = raw_logs.logs()["sweep"]
    if rng.random() < 0.7:
        data, change = damage.flip(rng, log.data, log.rest)
    else:
        data, change = damage.ROUGH[rng.integers(len(damage.ROUGH))](rng, log.data)
    (raw / "sweep.h5").write_bytes(data)
    folders = f"folders={{raw: {raw}, results: {folder / 'results'}}}"
    command = ["table2", "--config", "source=recorded", folders]

    # a dry run does not read the samples
    def planned(folder: Path, ended: Ended) -> Verdict:
        return SAME, ""

    return Case("dry run", change, [_step(folder, command, ("sweep.h5", "complex.h5"), planned)])


def _step(folder: Path, more: list[str], names: tuple[str, ...], judge) -> Step:
    command = (sys.executable, "-m", "snakemake", "-n", "--cores", "1", *more)
    return Step(command, _ROW, names, judge, folder=str(project(folder.parent)), limit_s=60.0)
