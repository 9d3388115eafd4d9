"""`fprc rig`: check the real rig, or run an experiment on it."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from fprc.apparatus.guardian import guard
from fprc.apparatus.programme import names, plan, refuse_unknown
from fprc.artifacts import refuse_output
from fprc.config import from_files, local_files
from fprc.errors import ControlError
from fprc.registry import model_of_run


def check(*, armed: bool = False, config: Sequence[str] = ()) -> None:
    """Check valves and sensors one by one."""
    guard({"what": "check", "settings": _prepare(config), "armed": armed})


def run(
    name: str,
    *,
    out: str | None = None,
    model: str | None = None,
    armed: bool = False,
    config: Sequence[str] = (),
) -> None:
    """Run one experiment and write its raw log."""
    settings = _prepare(config)
    if name == "list":
        print("\n".join(names(settings)))
        return
    refuse_unknown(name, settings)
    folders = settings["folders"]
    trained = f"{folders['results']}/models/sweep_{model_of_run(name)}.h5"
    model = model or (trained if Path(trained).exists() else "")
    raw = out or f"{folders['raw']}/{name}.h5"
    record(raw, name=name, settings=settings, armed=armed, model=model)


def record(
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
        Not armed, or the run was stopped; names the experiment, or the file of its samples.
    """
    refuse_output(raw, ".h5")
    plan(name, settings, model)  # refuses what the process would refuse, before it starts
    if not armed:
        limits = settings["hardware"]["limits"]
        raise ControlError(
            f"{name}: not armed, nothing was moved; would write {raw}, and stop above "
            f"{limits['p_exp_kpa'][1]:g} kPa in the actuator, {limits['p_i_kpa'][1]:g} kPa in PAM "
            "A; inspect the rig, run `fprc rig check --armed`, then give --armed (fprc rig run) or "
            "--config armed=true (snakemake)"
        )
    run = {"name": name, "raw": raw, "model": model}
    guard({"what": "run", "settings": dict(settings), "run": run})


def _prepare(files: Sequence[str]) -> dict[str, Any]:
    return from_files(files or local_files()).model_dump(mode="json")
