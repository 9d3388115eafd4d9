"""`fprc calibrate`: fit the simulated rig, outside the workflow."""

import logging
from collections.abc import Sequence
from pathlib import Path

from joblib import effective_n_jobs
from threadpoolctl import threadpool_limits

from fprc.artifacts import refuse_output, write_json, write_text
from fprc.config import PUBLISHED, from_files
from fprc.experiments.data import RigSettings
from fprc.given import read_yaml
from fprc.plan import on_rig, validation
from fprc.studies.calibration.ensemble import ensemble_around
from fprc.studies.calibration.fit import fit_rig
from fprc.studies.calibration.rig_file import WRITTEN, parameter_file

log = logging.getLogger(__name__)

#: Rigs of an ensemble.
MEMBERS = 40


def calibrate_from_files(
    files: Sequence[str] = (),
    *,
    out: str = "config/rigs/fitted.yaml",
    ensemble: str | None = None,
) -> None:
    """Fit the simulated rig to what the paper prints and claims."""
    settings = from_files(files).model_dump(mode="json")
    refuse_output(ensemble or out, ".json" if ensemble else ".yaml")
    printed, rig = read_yaml(PUBLISHED), RigSettings(**on_rig(settings))
    how = {
        "validation": validation(settings),
        "calibration": settings["calibration"],
        "tracking": settings["tracking"],
        "workers": effective_n_jobs(-1),
    }
    with threadpool_limits(1):
        if ensemble:
            found = ensemble_around(printed, rig, MEMBERS, **how)
            write_json(ensemble, {"note": f"{WRITTEN} --ensemble", **found})
        else:
            fitted, summary = fit_rig(printed, rig, **how)
            write_text(out, parameter_file(fitted, summary, Path(out).stem))
    log.info("wrote %s", ensemble or out)
