"""Run an experiment on the real rig and write its raw log."""

import logging
from collections.abc import Mapping
from pathlib import Path
from shutil import disk_usage
from typing import Any

from fprc.apparatus.guardian import guard
from fprc.apparatus.programme import plan
from fprc.artifacts import explaining, refuse_output
from fprc.errors import ControlError, OutputError

log = logging.getLogger("fprc.rig")

#: Bytes on the disk for each number of a run: in its journal, in its log, and some to spare.
_BYTES = 32


def record_on_rig(
    raw: str,
    *,
    name: str,
    settings: Mapping[str, Any],
    armed: bool,
    model: str = "",
) -> None:
    """Run one experiment on the real rig and write its raw log.

    Raises
    ------
    OutputError
        The log exists, cannot be written, or is too large for the disk.
    ControlError
        Not armed, or the run was stopped; names the experiment, or the file of its samples.
    """
    refuse_output(raw, ".h5")
    experiment = plan(name, settings, model)
    seconds = experiment.samples / settings["control"]["sample_rate_hz"]
    limits = settings["hardware"]["limits"]
    log.info(
        "%s: %.0f s on the real rig, into %s; stops above %g kPa in the actuator, %g kPa in PAM A",
        name, seconds, raw, limits["p_exp_kpa"][1], limits["p_i_kpa"][1],
    )  # fmt: skip
    if not armed:
        raise ControlError(
            f"{name}: not armed, nothing was moved; inspect the rig, run `fprc rig check --armed`, "
            "then give --armed (fprc rig run) or --config armed=true (snakemake)"
        )
    needed = _BYTES * experiment.samples * (1 + len(experiment.channels))
    with explaining(raw):
        Path(raw).parent.mkdir(parents=True, exist_ok=True)
        free = disk_usage(Path(raw).parent).free
    if free < needed:
        raise OutputError(f"{raw}: needs up to {needed:,} bytes, and its disk has {free:,} left")
    run = {"name": name, "raw": raw, "model": model}
    guard({"what": "run", "settings": dict(settings), "run": run})
