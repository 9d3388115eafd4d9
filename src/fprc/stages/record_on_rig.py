"""Run an experiment on the real rig and write its raw log."""

import logging
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from fprc.apparatus.guardian import guard
from fprc.apparatus.programme import plan
from fprc.artifacts import refuse_output
from fprc.errors import ControlError

log = logging.getLogger("fprc.rig")


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
        The log exists, or cannot be written.
    ControlError
        Not armed, or the run was stopped; names the experiment, or the journal.
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
    Path(raw).parent.mkdir(parents=True, exist_ok=True)
    run = {"name": name, "raw": raw, "model": model}
    guard({"what": "run", "settings": dict(settings), "run": run})
