"""The real rig: check it, run an experiment on it."""

import logging
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from fprc.apparatus.guardian import guard
from fprc.apparatus.programme import names, plan
from fprc.config import from_files
from fprc.errors import ControlError

log = logging.getLogger("fprc.rig")


def check(files: Sequence[str], *, armed: bool) -> None:
    """Look at the sensors of the real rig, and if armed at its valves.

    Raises
    ------
    ControlError
        Something is not as it should be.
    """
    _show_messages()
    settings = _settings(files)
    guard({"what": "check", "settings": settings, "armed": armed}, settings["hardware"])


def run_by_name(
    name: str,
    files: Sequence[str],
    *,
    armed: bool,
    raw: str | None = None,
    model: str | None = None,
    gains: str | None = None,
) -> None:
    """Run one experiment on the real rig; unless armed, say what would be run.

    Parameters
    ----------
    name : str
        Experiment; ``list`` prints those that there are.
    raw, model, gains : str, optional
        Log to write, fitted FPRC and gains; the workflow's own if left out.
    """
    _show_messages()
    settings = _settings(files)
    if name == "list":
        print("\n".join(names(settings)))
        return
    results, folder = settings["folders"]["results"], settings["folders"]["raw"]
    record_on_rig(
        raw or f"{folder}/{name}.h5",
        name=name,
        settings=settings,
        armed=armed,
        model=model or f"{results}/models/sweep_fprc.h5",
        gains=gains or f"{results}/control/gains.json",
    )


def record_on_rig(
    raw: str,
    *,
    name: str,
    settings: Mapping[str, Any],
    armed: bool,
    model: str = "",
    gains: str = "",
) -> None:
    """Run one experiment on the real rig and write its raw log.

    Raises
    ------
    ControlError
        Not armed, or the run was stopped; says what would be run, or where the
        samples are.
    """
    experiment = plan(name, settings, model, gains)
    seconds = experiment.samples / settings["control"]["sample_rate_hz"]
    limits = settings["hardware"]["limits"]
    log.info(
        "%s: %.0f s on the real rig, into %s; stops above %g kPa in the actuator, %g kPa in PAM A",
        name, seconds, raw, limits["p_exp_kpa"][1], limits["p_i_kpa"][1],
    )  # fmt: skip
    if not armed:
        raise ControlError(
            f"{name}: not armed, nothing was moved; look at the rig, run `fprc rig check --armed`, "
            "then give --armed (fprc rig run) or --config armed=true (snakemake)"
        )
    Path(raw).parent.mkdir(parents=True, exist_ok=True)
    run = {"name": name, "raw": raw, "model": model, "gains": gains}
    guard({"what": "run", "settings": dict(settings), "run": run}, settings["hardware"])


def _show_messages() -> None:
    logging.basicConfig(level=logging.INFO, format="%(message)s")


def _settings(files: Sequence[str]) -> dict[str, Any]:
    return from_files(files).model_dump(mode="json")
