"""Raw logs of experiments, as the rig gave them."""

import json
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from fprc.errors import LogError
from fprc.logs.columns import Columns, read_columns, write_columns

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

_ATTRIBUTES = ("experiment", "source", "sample_rate_hz", "seed", "software", "rig")


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
        "simulated": source == "sim",
        "sample_rate_hz": sample_rate_hz,
        "seed": seed,
        "software": software,
        "rig": json.dumps(rig),
        **more,
    }
    missing = [name for name in RAW_CHANNELS if name not in channels]
    if missing:
        raise LogError(f"{path}: not written, channels {', '.join(missing)} are missing")
    write_columns(path, channels, attributes)


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


def read_raw(path: Path | str, *, sample_rate_hz: float | None, rate_tolerance: float) -> Columns:
    """Read a raw log and check that it can be used at all.

    Parameters
    ----------
    sample_rate_hz : float or None
        Expected rate; None takes the one that the log declares.

    Raises
    ------
    LogError
        See ``read_columns``; further an attribute is missing, time does not
        increase, or the rate is not the expected one.
    """
    log = read_columns(path, RAW_CHANNELS)
    problems = [
        f"{path}: attribute {name}: missing; record the log again"
        for name in _ATTRIBUTES
        if name not in log.attributes
    ]
    declared = log.attributes.get("sample_rate_hz", sample_rate_hz or 1.0)
    sample_rate_hz = sample_rate_hz or declared
    time_s = log.channels["time_s"]
    steps = np.diff(time_s)
    back = np.flatnonzero(steps <= 0.0)
    if back.size:
        k = int(back[0]) + 1
        problems.append(
            f"{path}: channel time_s: sample {k} at {time_s[k]:.6f} s does not come after "
            f"{time_s[k - 1]:.6f} s; sort or cut the log"
        )
    elif steps.size and abs(steps.mean() * sample_rate_hz - 1.0) > rate_tolerance:
        problems.append(
            f"{path}: channel time_s: sample {len(time_s) - 1}: the mean rate up to here is "
            f"{1.0 / steps.mean():.4g} Hz, must be {sample_rate_hz:g} Hz; resample the log"
        )
    if abs(declared / sample_rate_hz - 1.0) > rate_tolerance:
        problems.append(
            f"{path}: attribute sample_rate_hz = {declared:g}; must be {sample_rate_hz:g}, "
            "resample the log or change control.sample_rate_hz"
        )
    if problems:
        raise LogError("\n".join(problems))
    return log
