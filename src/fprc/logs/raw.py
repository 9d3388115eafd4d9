"""Raw logs of experiments, as recorded."""

import math
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

import numpy as np

from fprc import __version__
from fprc.channels import RAW_CHANNELS, TARGETS, needed_by
from fprc.errors import LogError
from fprc.escape import in_words
from fprc.logs.columns import Columns, read_attributes, read_columns, write_columns
from fprc.paper import SOURCES

#: Prefix of the experiment names of closed-loop runs.
RUN_PREFIX = "track_"

#: Required attributes of a raw log, and those that a closed-loop run needs too.
RAW_ATTRIBUTES = ("experiment", "source", "sample_rate_hz", "seed", "software", "rig")
RUN_ATTRIBUTES = ("controller", "reference", "settle_s")


def write_raw(path: Path | str, channels: Mapping[str, np.ndarray], /, **attributes: Any) -> None:
    """Write a raw log; it may have channels besides ``RAW_CHANNELS``.

    A channel that is NaN throughout belongs to a sensor that the rig lacks, and is left out. The
    attributes are ``RAW_ATTRIBUTES`` (LogError if one is missing; ``software`` is this version
    unless it is given, ``rig`` the configuration of rig and control), and further ones of the run.
    """
    described = {"software": f"fprc {__version__}", **attributes}
    if missing := [name for name in RAW_ATTRIBUTES if name not in described]:
        raise LogError(f"{path}: a raw log needs {in_words(missing)}; give each as an argument")
    described = {name: described[name] for name in RAW_ATTRIBUTES} | described
    measured = {k: v for k, v in channels.items() if not (len(v) and np.isnan(v).all())}
    write_columns(path, measured, described)


def read_raw(
    path: Path | str, *, experiment: str | None, sample_rate_hz: float | None, rate_tolerance: float
) -> Columns:
    """Read a raw log and check it; None accepts any experiment, and the rate that the log gives.

    Raises
    ------
    LogError
        Lists every problem, one per line: the file cannot be opened, or is cut short; a channel
        or an attribute is missing or wrong. Without such problems: time does not increase, or the
        rate is not the expected one. An imported log requires time, angle and one of the two
        P_exp; a log of the real rig all channels but ``phi_deg``; a closed-loop run also
        ``TRACKING_CHANNELS`` and ``RUN_ATTRIBUTES``.
    """
    attributes = read_attributes(path)
    if attributes.keys().isdisjoint(RAW_ATTRIBUTES):
        raise LogError(
            f"{path}: is no raw log, see data/raw/README.md; `fprc import` makes one from a "
            "recording of another program"
        )
    if "p_target_unit" in attributes:
        raise LogError(
            f"{path}: is preprocessed; give the raw log of the same name, which `fprc readout` and "
            "the workflow keep in the folder raw"
        )
    source = attributes.get("source")
    is_run = str(attributes.get("experiment")).startswith(RUN_PREFIX)
    needed = needed_by(source if source in SOURCES else "sim", tracking=is_run)
    optional = tuple(name for name in RAW_CHANNELS if name not in needed)
    required = RAW_ATTRIBUTES + (RUN_ATTRIBUTES if is_run else ())
    log = read_columns(path, needed, optional, required)
    if problems := [*_impossible(log, experiment, sample_rate_hz, rate_tolerance)]:
        raise LogError("\n".join(f"{path}: {problem}" for problem in problems))
    return log


def read_run(path: Path | str) -> Columns:
    """Read the log of a closed-loop run, as ``read_raw``, at any rate; LogError for another."""
    log = read_raw(path, experiment=None, sample_rate_hz=None, rate_tolerance=math.inf)
    if not log.attributes["experiment"].startswith(RUN_PREFIX):
        raise LogError(
            f"{path}: attribute experiment = {log.attributes['experiment']}; must begin with "
            f"{RUN_PREFIX}, as of a closed-loop run"
        )
    return log


def _impossible(
    log: Columns, experiment: str | None, expected_hz: float | None, tolerance: float
) -> Iterator[str]:
    """Yield what is impossible about attributes and clock, or is not as it is expected."""
    attributes, time_s = log.attributes, log.channels["time_s"]
    found, source = attributes["experiment"], attributes["source"]
    if experiment not in (None, found):
        yield (
            f"attribute experiment = {found}; must be {experiment}, or the file has the wrong name"
        )
    if source not in SOURCES:
        yield f"attribute source = {source}; must be {', '.join(SOURCES)}"
    if source == "import" and log.channels.keys().isdisjoint(TARGETS.values()):
        yield f"channel {in_words(TARGETS.values(), 'or')}: missing; import one of them"
    if (settle_s := attributes.get("settle_s", -math.inf)) > time_s.max():
        yield (
            f"attribute settle_s = {settle_s:g}; must be at most {time_s.max():g}, the end of the "
            "log, or nothing is left to evaluate"
        )
    back = np.flatnonzero(time_s[1:] <= time_s[:-1])
    declared_hz = attributes["sample_rate_hz"]
    if back.size:
        k = int(back[0]) + 1
        yield (
            f"channel time_s: sample {k} at {time_s[k]:.6f} s does not come after "
            f"{time_s[k - 1]:.6f} s; sort or cut the log"
        )
        return
    expected_hz = expected_hz or declared_hz
    mean_hz = (len(time_s) - 1) / np.ptp(time_s) if len(time_s) > 1 else expected_hz
    for what, hz, remedy in (
        ("attribute sample_rate_hz", declared_hz, "change control.sample_rate_hz and all settings "
         "in samples, or import the recording again with that sample_rate_hz in the map"),
        ("channel time_s: the mean rate", mean_hz, "resample the log"),
    ):  # fmt: skip
        if abs(expected_hz / hz - 1.0) > tolerance:
            yield f"{what} = {hz:.6g} Hz; must be {expected_hz:g} Hz; {remedy}"
            return
