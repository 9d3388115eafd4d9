"""`fprc rig`: check the real rig, or run an experiment on it."""

from collections.abc import Sequence
from typing import Any

from fprc.apparatus.guardian import guard
from fprc.apparatus.programme import names, refuse_unknown
from fprc.apparatus.record import record_on_rig
from fprc.commands.terminal import messages_on_terminal
from fprc.config import from_files, local_files
from fprc.registry import model_of_run


@messages_on_terminal()
def check(files: Sequence[str], *, armed: bool) -> None:
    """Check the sensors of the real rig and, if armed, its valves.

    Raises
    ------
    ControlError
        The check found a problem.
    """
    guard({"what": "check", "settings": _prepare(files), "armed": armed})


@messages_on_terminal()
def run_by_name(
    name: str,
    files: Sequence[str],
    *,
    armed: bool,
    raw: str | None = None,
    model: str | None = None,
) -> None:
    """Run one experiment on the real rig; unless armed, print what would be run.

    Parameters
    ----------
    name : str
        Experiment; ``list`` prints all names.
    raw, model : str, optional
        Log to write, and fitted model; by default the workflow's files.

    Raises
    ------
    ConfigError
        There is no such experiment.
    ControlError
        The run was refused or stopped.
    """
    settings = _prepare(files)
    if name == "list":
        print("\n".join(names(settings)))
        return
    refuse_unknown(name, settings)
    results, folder = settings["folders"]["results"], settings["folders"]["raw"]
    record_on_rig(
        raw or f"{folder}/{name}.h5",
        name=name,
        settings=settings,
        armed=armed,
        model=model or f"{results}/models/sweep_{model_of_run(name)}.h5",
    )


def _prepare(files: Sequence[str]) -> dict[str, Any]:
    return from_files(files or local_files()).model_dump(mode="json")
