"""Fit the simulated rig to published numbers, and write the rig and a report."""

import logging
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from fprc.artifacts import write_json, write_text
from fprc.experiments.settings import RigSettings
from fprc.studies.calibration.fit import fit_rig
from fprc.studies.calibration.rig_file import parameter_file
from fprc.yaml_file import read_yaml

log = logging.getLogger(__name__)


def calibrate(
    published: str, fitted: str, report: str, *, on_rig: Mapping[str, Any], **how: Any
) -> None:
    """Fit the free parameters of the rig, starting from the rig of ``on_rig``.

    Writes the fitted rig (``fitted``, YAML, a file of config/rigs) and a summary of the fit
    (``report``, JSON). ``how`` are the other arguments of ``fit_rig``.
    """
    best, summary = fit_rig(read_yaml(published), RigSettings(**on_rig), **how)
    write_json(report, summary)
    write_text(fitted, parameter_file(best, summary, Path(fitted).stem))
    log.info(
        "loss on seeds outside the fit: %.4f for the starting rig, %.4f for the fitted one",
        summary["check_loss_at_start"], summary["check_loss"],
    )  # fmt: skip
    if summary["check_loss"] > summary["check_loss_at_start"]:
        log.warning(
            "warning: on seeds outside the fit, the starting rig is closer to the paper than the "
            "fitted one; keep the starting rig, or use more calibration.seeds"
        )
    log.info(
        "median deviation %.1f %%, largest %.1f %%; wrote %s",
        100 * summary["median_deviation"], 100 * summary["largest_deviation"], fitted,
    )  # fmt: skip
