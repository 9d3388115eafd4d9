"""Check a raw log and select the channels of the models."""

import logging
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from fprc.artifacts import write_json
from fprc.config.settings import Quality
from fprc.experiments.data import Data, join, select_channels
from fprc.logs import assess, read_raw, write_columns
from fprc.logs.columns import read_each
from fprc.logs.quality import warnings

log = logging.getLogger(__name__)


def preprocess(
    raw: str | Sequence[str],
    data: str,
    quality: str,
    *,
    experiment: str,
    target: str,
    sample_rate_hz: float,
    limits: Quality,
) -> None:
    """Check a raw log, write its quality record, and select the channels.

    Nothing is filtered here: filter and taps are parts of the models, since the control loop
    needs the same ones. If an imported log has only one of the two P_exp, commanded or
    measured, that one is used. Several raw logs become one preprocessed log, whose attribute
    ``recordings`` has their lengths.

    Raises
    ------
    LogError
        A raw log cannot be read, or several logs differ in source, target, units or channels.
    """
    paths = [raw] if isinstance(raw, str) else list(raw)
    recordings, reports = read_recordings(
        paths, experiment=experiment, target=target, sample_rate_hz=sample_rate_hz,
        limits=limits,
    )  # fmt: skip
    whole, report = recordings[0], reports[0]
    if len(paths) > 1:
        names = [Path(path).name for path in paths]
        whole = join(dict(zip(names, recordings, strict=True)), 1.0 / sample_rate_hz)
        report = {"recordings": reports}
    write_json(quality, report)
    write_columns(data, whole.channels, whole.attributes)


def read_recordings(
    paths: Sequence[str],
    *,
    experiment: str | None,
    target: str,
    sample_rate_hz: float,
    limits: Quality,
    inputs: Sequence[str] = ("theta_deg", "p_o_kpa"),
) -> tuple[list[Data], list[dict[str, Any]]]:
    """Return the models' channels of raw logs, and their quality records.

    ``experiment`` is that which is expected, or None; ``inputs`` are as ``select_channels`` takes
    them.

    Raises
    ------
    LogError
        Lists every log that cannot be read.
    """
    asked = {"sample_rate_hz": sample_rate_hz, "rate_tolerance": limits.rate_tolerance}
    sources = read_each(read_raw, paths, experiment=experiment, **asked)
    recordings, reports = [], []
    for source in sources:
        report = assess(source, limits, sample_rate_hz)
        for warning in warnings(report):
            log.warning("warning: %s", warning)
        reports.append(report)
        recordings.append(select_channels(source, target, inputs))
        passed = sum(check["passed"] for check in report["checks"].values())
        log.info("%d of %d quality checks passed", passed, len(report["checks"]))
    return recordings, reports
