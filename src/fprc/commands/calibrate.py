"""`fprc calibrate`: fit the simulated rig, outside the workflow."""

import re
from collections.abc import Sequence
from pathlib import Path

from threadpoolctl import threadpool_limits

from fprc.artifacts import is_json_with, refuse_output
from fprc.calibration.rig_file import WRITTEN
from fprc.commands.processes import processes
from fprc.commands.terminal import messages_on_terminal
from fprc.config import PUBLISHED, check, from_files, local_files
from fprc.errors import ConfigError
from fprc.fingerprint import fingerprint
from fprc.given import read_given
from fprc.paper import MODELS
from fprc.plan.arguments import judgement, on_rig
from fprc.registry import class_module
from fprc.stages.calibrate import calibrate


@messages_on_terminal()
def calibrate_from_files(
    files: Sequence[str],
    published: str | None,
    out: str,
    *,
    minutes: float | None = None,
    workers: int | None = None,
) -> None:
    """Calibrate with the settings of configuration files, outside the workflow.

    The report is written beside ``out`` as JSON, and so are the checkpoints of the
    searches, from which they can be continued.

    Parameters
    ----------
    files : sequence of str
        By default ``config/config.yaml`` of the current folder, or else the defaults.
    published : str or None
        Published numbers; None takes those of this package.
    out : str
        File of the rig to write, YAML; its name becomes that of the rig.
    minutes : float, optional
        Time limit; by default the configuration's.
    workers : int, optional
        Processes; by default one per processor.

    Raises
    ------
    ConfigError
        The configuration or an option is wrong; lists all errors.
    OutputError
        ``out`` or the report exists and no fit wrote it, or they cannot be written.
    """
    settings = from_files(files or local_files()).model_dump(mode="json")
    if minutes is not None:
        changed = settings["calibration"] | {"minutes": minutes}
        settings = check(settings | {"calibration": changed}).model_dump(mode="json")
    count = processes(workers)
    if not re.fullmatch(r"[\w.-]+\.yaml", Path(out).name):
        raise ConfigError(
            f"--out {out}: must end in .yaml, after letters, digits, -, _ and . only: it names the "
            "rig; the report has the same name, .json"
        )
    stem = Path(out).with_suffix("")
    refuse_output(out, ".yaml", ours=lambda old: WRITTEN.encode() in read_given(old))
    refuse_output(f"{stem}.json", ".json", ours=lambda old: is_json_with(old, "check_loss", "fit"))
    with threadpool_limits(1):
        calibrate(
            str(PUBLISHED) if published is None else published,
            out,
            f"{stem}.json",
            on_rig=on_rig(settings),
            judgement=judgement(settings, without="seed"),
            calibration=settings["calibration"],
            grids=settings["grids"],
            tracking=settings["tracking"],
            workers=count,
            checkpoint=f"{stem}.partial.jsonl",
            version=fingerprint("fprc.stages.calibrate", *map(class_module, MODELS)),
        )
