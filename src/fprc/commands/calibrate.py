"""`fprc calibrate`: fit the simulated rig without a workflow."""

import logging
import os
from collections.abc import Sequence
from pathlib import Path

from threadpoolctl import threadpool_limits

from fprc.config import check, from_files
from fprc.errors import ConfigError
from fprc.fingerprint import fingerprint
from fprc.stages.calibrate import calibrate


def calibrate_from_files(
    files: Sequence[str],
    published: str,
    out: str,
    *,
    minutes: float | None = None,
    workers: int | None = None,
) -> None:
    """Calibrate as configuration files say, without a workflow.

    The report goes beside ``out`` as JSON, and so does the checkpoint of the
    search, with which more generations can be added.

    Raises
    ------
    ConfigError
        The configuration or a limit is wrong; all errors at once.
    """
    settings = from_files(files).model_dump(mode="json")
    if minutes is not None:
        changed = settings["calibration"] | {"minutes": minutes}
        settings = check(settings | {"calibration": changed}).model_dump(mode="json")
    calibration = settings["calibration"]
    if workers is not None and workers < 1:
        raise ConfigError(
            f"--workers {workers}: must be 1 or more; leave it out for all processors"
        )
    if Path(out).suffix not in (".yaml", ".yml"):
        raise ConfigError(f"--out {out}: must end in .yaml; the report goes beside it as .json")
    logging.basicConfig(level=logging.INFO, format="%(message)s")
    stem = Path(out).with_suffix("")
    with threadpool_limits(1):
        calibrate(
            published,
            out,
            f"{stem}.json",
            on_rig={
                "rig": settings["rig"],
                "signals": settings["experiments"],
                "control": settings["control"],
                "target": settings["evaluation"]["target"],
            },
            judgement={
                "models": settings["models"],
                "folds": settings["evaluation"]["folds"],
                "split": settings["evaluation"]["split"],
            },
            calibration=calibration,
            workers=workers or len(os.sched_getaffinity(0)),
            checkpoint=f"{stem}.partial.jsonl",
            version=fingerprint("fprc.stages.calibrate"),
        )
