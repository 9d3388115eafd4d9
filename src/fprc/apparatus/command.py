"""`fprc rig`: check the real rig, or run an experiment on it."""

from collections.abc import Sequence
from pathlib import Path
from typing import Any

from fprc.apparatus.guardian import guard
from fprc.apparatus.programme import names, refuse_unknown
from fprc.apparatus.record_on_rig import record_on_rig
from fprc.config import from_files, local_files
from fprc.errors import ConfigError
from fprc.paper import EXPERIMENTS, reference_and_controller
from fprc.registry import feedforward_of, model_of_run


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
    if model and (name in EXPERIMENTS or not feedforward_of(reference_and_controller(name)[1])):
        raise ConfigError(f"{name} uses no model; leave out --model, or choose another experiment")
    folders = settings["folders"]
    trained = f"{folders['results']}/models/sweep_{model_of_run(name)}.h5"
    model = model or (trained if Path(trained).exists() else "")
    raw = out or f"{folders['raw']}/{name}.h5"
    record_on_rig(raw, name=name, settings=settings, armed=armed, model=model)


def _prepare(files: Sequence[str]) -> dict[str, Any]:
    return from_files(files or local_files()).model_dump(mode="json")
