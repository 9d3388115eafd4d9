"""Raw logs of experiments, as the rig gave them."""

import json
from collections.abc import Container, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from fprc.errors import LogError
from fprc.logs.columns import Columns, gather_columns, read_columns, write_columns

#: The two hysteresis experiments: in Table II the first trains and the second tests, in Table III
#: the other way round.
EXPERIMENTS = ("sweep", "complex")

#: Every channel of a raw log. ``command`` is what was asked, the rest measured.
RAW_CHANNELS = (
    "time_s",
    "p_exp_command_kpa",
    "p_exp_kpa",
    "theta_deg",
    "p_i_command_kpa",
    "p_i_kpa",
    "p_o_kpa",
    "phi_deg",
    "valve_main_v",
    "valve_reservoir_v",
)

#: What an imported log must have; further one of ``_TARGETS``. The others may be absent.
_IMPORTED = ("time_s", "theta_deg")
_TARGETS = ("p_exp_command_kpa", "p_exp_kpa")

#: Source of a log whose reservoir was simulated afterwards, by its own.
SIMULATED_RESERVOIR = {"rig": "rig+sim", "import": "import+sim"}

#: Where a log can come from: simulated, recorded here, brought in.
SOURCES = ("sim", "rig", "import", *SIMULATED_RESERVOIR.values())

#: Attributes that a raw log must have, and their kinds.
RAW_ATTRIBUTES = {
    "experiment": str,
    "source": str,
    "simulated": bool,
    "sample_rate_hz": (int, float),
    "seed": int,
    "software": str,
    "rig": str,
}
_OPTIONAL_ATTRIBUTES = {"complete": bool, "incomplete_reason": str, "lost_samples": int}


def write_raw(
    path: Path | str,
    channels: Mapping[str, np.ndarray],
    *,
    experiment: str,
    source: str,
    sample_rate_hz: float,
    seed: int,
    software: str,
    rig: Mapping[str, Any],
    **more: Any,
) -> None:
    """Write a raw log; channels beyond ``RAW_CHANNELS`` are kept too.

    Parameters
    ----------
    source : str
        ``sim``, ``rig`` or ``import``: simulated, recorded here, brought in.
    rig : Mapping
        Configuration of rig and control, kept as JSON.
    **more
        Further attributes of the run.
    """
    attributes = {
        "experiment": experiment,
        "source": source,
        "simulated": source.endswith("sim"),
        "sample_rate_hz": sample_rate_hz,
        "seed": seed,
        "software": software,
        "rig": json.dumps(rig),
        **more,
    }
    missing = missing_channels(source, channels)
    if missing:
        raise LogError(f"{path}: not written, channels {', '.join(missing)} are missing")
    write_columns(path, channels, attributes)


def missing_channels(source: str, channels: Container[str]) -> list[str]:
    """Return the channels that a log of this source must have and has not."""
    missing = [name for name in _needed(source) if name not in channels]
    if source.startswith("import") and not any(name in channels for name in _TARGETS):
        missing.append(" or ".join(_TARGETS))
    return missing


def _needed(source: str) -> tuple[str, ...]:
    if source.startswith("import"):
        return _IMPORTED
    if source.startswith("rig"):  # it may have no angle sensor on the reservoir
        return tuple(name for name in RAW_CHANNELS if name != "phi_deg")
    return RAW_CHANNELS


def refuse_to_overwrite(paths: Sequence[Path | str]) -> None:
    """Check that no log which the simulated rig would replace is anything else.

    Raises
    ------
    LogError
        A file exists that is not a simulated log, or cannot be read.
    """
    problems = []
    for path in filter(Path.exists, map(Path, paths)):
        try:
            if read_columns(path, ()).attributes.get("source") != "sim":
                problems.append(
                    f"{path}: is not a log of the simulated rig and will not be overwritten; "
                    "set source: recorded to use it, or move it away"
                )
        except LogError as error:
            problems.append(str(error))
    if problems:
        raise LogError("\n".join(problems))


def refuse_simulated(paths: Sequence[Path | str]) -> None:
    """Check that no log in the place of a real rig's is a simulated one.

    Raises
    ------
    LogError
        Lists those that are.
    """
    problems = [
        f"{path}: is a log of the simulated rig, not of the real one; set folders.raw (and "
        "folders.results) to folders of their own"
        for path in filter(Path.exists, map(Path, paths))
        if gather_columns(path, ())[0].attributes.get("source") == "sim"
    ]
    if problems:
        raise LogError("\n".join(problems))


def read_raw(
    path: Path | str,
    *,
    experiment: str | None,
    sample_rate_hz: float | None,
    rate_tolerance: float,
) -> Columns:
    """Read a raw log and check that it can be used at all.

    Parameters
    ----------
    experiment : str or None
        Expected experiment; None takes any.
    sample_rate_hz : float or None
        Expected rate; None takes the one that the log declares.

    Raises
    ------
    LogError
        See ``read_columns``; further an attribute is missing or of the wrong
        kind, time does not increase, or the rate is not the expected one. Of an
        imported log only time, angle and one of the two P_exp must be there, of
        a real rig's all but ``phi_deg``.
    """
    source = gather_columns(path, ())[0].attributes.get("source")
    brought_in = str(source).startswith("import")
    needed = _needed(str(source))
    log, problems = gather_columns(path, needed, tuple(n for n in RAW_CHANNELS if n not in needed))
    if brought_in and not any(name in log.channels for name in _TARGETS):
        problems.append(f"{path}: channel {' or '.join(_TARGETS)}: missing; import one of them")
    wrong = _wrong_attributes(path, log.attributes, experiment)
    declared = 0.0 if wrong else log.attributes["sample_rate_hz"]
    problems += wrong
    if "time_s" in log.channels:
        expected = sample_rate_hz or declared
        problems += _wrong_times(path, log.channels["time_s"], expected, rate_tolerance)
    if sample_rate_hz and declared and abs(declared / sample_rate_hz - 1.0) > rate_tolerance:
        problems.append(
            f"{path}: attribute sample_rate_hz = {declared:g}; must be {sample_rate_hz:g}, "
            "resample the log or change control.sample_rate_hz"
        )
    if problems:
        raise LogError("\n".join(problems))
    return log


#: What a log of a closed-loop run says further.
_OF_A_RUN = ("controller", "gain", "reference", "settle_s", "source", "seed")


def read_run(path: Path | str, names: tuple[str, ...]) -> Columns:
    """Read channels of a closed-loop run.

    Raises
    ------
    LogError
        See ``read_columns``; further an attribute of a run is missing.
    """
    log, problems = gather_columns(path, names)
    problems += [
        f"{path}: attribute {name}: missing; closed-loop logs are described in data/raw/README.md"
        for name in _OF_A_RUN
        if name not in log.attributes
    ]
    if problems:
        raise LogError("\n".join(problems))
    return log


def _wrong_attributes(
    path: Path | str, attributes: Mapping[str, Any], experiment: str | None
) -> list[str]:
    problems = []
    for name, kind in (RAW_ATTRIBUTES | _OPTIONAL_ATTRIBUTES).items():
        if name not in attributes:
            if name in RAW_ATTRIBUTES:
                problems.append(f"{path}: attribute {name}: missing; see data/raw/README.md")
        elif not isinstance(attributes[name], kind):
            value = attributes[name]
            problems.append(
                f"{path}: attribute {name} = {value!r}: is a {type(value).__name__}; "
                "see data/raw/README.md"
            )
    if problems:
        return problems
    source, rate_hz = attributes["source"], attributes["sample_rate_hz"]
    if source not in SOURCES:
        problems.append(f"{path}: attribute source = {source}; must be {', '.join(SOURCES)}")
    elif attributes["simulated"] != source.endswith("sim"):
        problems.append(
            f"{path}: attribute simulated = {attributes['simulated']} contradicts "
            f"source = {source}; correct the wrong one"
        )
    if experiment is not None and attributes["experiment"] != experiment:
        problems.append(
            f"{path}: attribute experiment = {attributes['experiment']}; must be {experiment}, "
            "the file has another experiment's name"
        )
    if not rate_hz > 0.0:
        problems.append(f"{path}: attribute sample_rate_hz = {rate_hz}; must be above 0")
    return problems


def _wrong_times(
    path: Path | str, time_s: np.ndarray, expected_hz: float, tolerance: float
) -> list[str]:
    steps = np.diff(time_s)
    back = np.flatnonzero(steps <= 0.0)
    if back.size:
        k = int(back[0]) + 1
        return [
            f"{path}: channel time_s: sample {k} at {time_s[k]:.6f} s does not come after "
            f"{time_s[k - 1]:.6f} s; sort or cut the log"
        ]
    if expected_hz and steps.size and abs(steps.mean() * expected_hz - 1.0) > tolerance:
        return [
            f"{path}: channel time_s: sample {len(time_s) - 1}: the mean rate up to here is "
            f"{1.0 / steps.mean():.4g} Hz, must be {expected_hz:g} Hz; resample the log"
        ]
    return []
