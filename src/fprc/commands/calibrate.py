"""`fprc calibrate`: fit the simulated rig, outside the workflow."""

import logging
import re
from collections.abc import Sequence
from pathlib import Path

from joblib import effective_n_jobs
from threadpoolctl import threadpool_limits

from fprc.artifacts import is_json_with, refuse_output, write_json, write_text
from fprc.config import PUBLISHED, from_files, local_files
from fprc.errors import ConfigError
from fprc.experiments.settings import RigSettings
from fprc.fingerprint import fingerprint
from fprc.given import read_given
from fprc.paper import MODELS
from fprc.plan.arguments import judgement, on_rig
from fprc.registry import class_module
from fprc.studies.calibration.fit import fit_rig
from fprc.studies.calibration.rig_file import WRITTEN, parameter_file
from fprc.yaml_file import read_yaml

log = logging.getLogger(__name__)


def calibrate_from_files(
    files: Sequence[str] = (),
    *,
    out: str = "config/rigs/fitted.yaml",
    published: str | None = None,
    workers: int | None = None,
) -> None:
    """Fit the simulated rig to what the paper prints and claims."""
    settings = from_files(files or local_files()).model_dump(mode="json")
    count = effective_n_jobs(workers or -1)
    if not re.fullmatch(r"[\w.-]+\.yaml", Path(out).name):
        raise ConfigError(
            f"--out {out}: must end in .yaml, after letters, digits, -, _ and . only: it names the "
            "rig; the report has the same name, .json"
        )
    if settings["control"]["feedforward"]["adapt"]:
        raise ConfigError(
            "control.feedforward.adapt: a fit compares with the paper, whose models do not learn "
            "while they run; set it to false"
        )
    stem = Path(out).with_suffix("")
    refuse_output(out, ".yaml", ours=lambda old: WRITTEN.encode() in read_given(old))
    refuse_output(
        f"{stem}.json", ".json", ours=lambda old: is_json_with(old, "loss_at_start", "fit")
    )
    with threadpool_limits(1):
        rig, summary = fit_rig(
            read_yaml(PUBLISHED if published is None else published),
            RigSettings(**on_rig(settings)),
            judgement=judgement(settings, without="seed"),
            calibration=settings["calibration"],
            grids=settings["grids"],
            tracking=settings["tracking"],
            workers=count,
            checkpoint=f"{stem}.partial.jsonl",
            version=fingerprint("fprc.studies.calibration.fit", *map(class_module, MODELS)),
        )
    write_json(f"{stem}.json", summary)
    write_text(out, parameter_file(rig, summary, stem.name, settings["fitted"]))
    log.info("wrote %s", out)
