"""Fit the simulated rig to published numbers, and write the rig and a report."""

import logging
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from fprc.artifacts import write_json, write_text
from fprc.errors import ConfigError
from fprc.experiments.settings import RigSettings
from fprc.studies.calibration.fit import fit_rig
from fprc.studies.calibration.rig_file import parameter_file
from fprc.yaml_file import read_yaml

log = logging.getLogger(__name__)


def calibrate(
    published: str,
    fitted: str,
    report: str,
    *,
    on_rig: Mapping[str, Any],
    began: Mapping[str, Any],
    **how: Any,
) -> None:
    """Fit the free parameters of the rig, starting from the rig of ``on_rig``.

    Writes the fitted rig (``fitted``, YAML, a file of config/rigs) and a summary of the fit
    (``report``, JSON). ``began`` is what that rig was fitted to, the section ``fitted`` of the
    configuration; ``how`` are the other arguments of ``fit_rig``. Raises ConfigError if the models
    of ``on_rig`` learn while they run: the printed ones did not.
    """
    if on_rig["control"]["feedforward"]["adapt"]:
        raise ConfigError(
            "control.feedforward.adapt: a fit compares with the paper, whose models do not learn "
            "while they run; set it to false"
        )
    models_of_rigs = logging.getLogger("fprc.experiments")
    level = models_of_rigs.level
    models_of_rigs.setLevel(logging.WARNING)  # lines on hundreds of rigs would hide the search's
    try:
        best, summary = fit_rig(read_yaml(published), RigSettings(**on_rig), **how)
    finally:
        models_of_rigs.setLevel(level)
    write_json(report, summary)
    start = list(dict.fromkeys([*began["to"], *began["start"]]))
    write_text(fitted, parameter_file(best, summary, Path(fitted).stem, start, began["seeds"]))
    before, after = summary["median_deviation_at_start"], summary["median_deviation"]
    if after > before:
        log.warning(
            "warning: with the full models the starting rig is closer to Tables II and III than "
            "the fitted one (median %.1f %%, %.1f %%); keep it, or use more calibration.seeds",
            100 * before, 100 * after,
        )  # fmt: skip
    log.info(
        "median deviation %.1f %%, largest %.1f %%; wrote %s",
        100 * after, 100 * summary["largest_deviation"], fitted,
    )  # fmt: skip
