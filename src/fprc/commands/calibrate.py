"""`fprc calibrate`: fit the simulated rig, outside the workflow."""

import logging
from collections.abc import Sequence
from pathlib import Path

from joblib import Parallel, parallel_config
from threadpoolctl import threadpool_limits

from fprc.artifacts import refuse_output, write_json, write_text
from fprc.config import PUBLISHED, from_files
from fprc.experiments.data import RigSettings
from fprc.given import read_yaml
from fprc.plan import on_rig, validation
from fprc.studies.calibration.fit import Fit

log = logging.getLogger(__name__)

#: Rigs of an ensemble.
MEMBERS = 40


def calibrate_from_files(
    files: Sequence[str] = (), *, out: str = "config/rigs/fitted.yaml", ensemble: str | None = None
) -> None:
    """Fit the simulated rig to what the paper prints and claims."""
    settings = from_files(files).model_dump(mode="json")
    refuse_output(ensemble or out, ".json" if ensemble else ".yaml")
    alone = parallel_config("loky", n_jobs=-1, inner_max_num_threads=1)
    with threadpool_limits(1), alone, Parallel() as pool:
        fit = Fit(
            read_yaml(PUBLISHED), RigSettings(**on_rig(settings)), settings["calibration"], pool,
            validation=validation(settings), tracking=settings["tracking"],
        )  # fmt: skip
        if ensemble:
            note = "Written by `fprc calibrate` --ensemble"
            write_json(ensemble, {"note": note, **fit.ensemble(MEMBERS)})
        else:
            write_text(out, fit.rig_file(Path(out).stem))
    log.info("wrote %s", ensemble or out)
