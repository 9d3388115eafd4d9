"""Raw logs of experiments, as the rig gave them."""

from collections.abc import Container, Mapping
from pathlib import Path
from typing import Any

import numpy as np

from fprc.errors import LogError
from fprc.logs.columns import Columns, gather_columns, write_columns

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

#: What the log of a closed-loop run has besides: reference, feedforward and feedback.
TRACKING_CHANNELS = ("theta_d_deg", "p_ff_kpa", "p_fb_kpa")

#: How the experiment of a closed-loop run begins.
RUNS = ("track_", "identify_")

#: What an imported log must have; further one of ``_TARGETS``. The others may be absent.
_IMPORTED = ("time_s", "theta_deg")
_TARGETS = ("p_exp_command_kpa", "p_exp_kpa")

#: Source of a log whose reservoir was simulated afterwards, by its own.
SIMULATED_RESERVOIR = {"rig": "rig+sim", "import": "import+sim"}

#: Where a log can come from: simulated, recorded here, brought in.
SOURCES = ("sim", "rig", "import", *SIMULATED_RESERVOIR.values())

#: Attributes that a raw log must have, and those that a closed-loop run must have besides.
RAW_ATTRIBUTES = (
    "experiment",
    "source",
    "simulated",
    "sample_rate_hz",
    "seed",
    "software",
    "rig",
)
RUN_ATTRIBUTES = ("controller", "gain", "reference", "settle_s")

#: No clock, sensor or command gives a number beyond this, and squares of it are numbers still.
_BEYOND = 1e10


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
        "rig": rig,
        **more,
    }
    missing = missing_channels(attributes, channels)
    if missing:
        raise LogError(f"{path}: not written, channels {', '.join(missing)} are missing")
    write_columns(path, channels, attributes)


def missing_channels(told: Mapping[str, Any], channels: Container[str]) -> list[str]:
    """Return the channels that a log with these attributes must have and has not."""
    missing = [name for name in _needed(told) if name not in channels]
    if _is_imported(told) and not any(name in channels for name in _TARGETS):
        missing.append(" or ".join(_TARGETS))
    return missing


def _needed(told: Mapping[str, Any]) -> tuple[str, ...]:
    names: tuple[str, ...] = RAW_CHANNELS
    if _is_imported(told):
        names = _IMPORTED
    elif str(told.get("source")).startswith("rig"):  # there may be no angle sensor on the reservoir
        names = tuple(name for name in RAW_CHANNELS if name != "phi_deg")
    return (*names, *(TRACKING_CHANNELS if _is_run(told) else ()))


def _is_imported(told: Mapping[str, Any]) -> bool:
    return str(told.get("source")).startswith("import")


def _is_run(told: Mapping[str, Any]) -> bool:
    return str(told.get("experiment")).startswith(RUNS)


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
        See ``read_columns``; further an attribute is missing, time does not increase, a
        number is beyond all measuring, or the rate is not the expected one. Of an
        imported log only time, angle and one of the two P_exp must be there, of
        a real rig's all but ``phi_deg``; of a closed-loop run ``TRACKING_CHANNELS`` and
        ``RUN_ATTRIBUTES`` besides.
    """
    log, problems = _gather(path)
    told = log.attributes
    if experiment is not None and told.get("experiment", experiment) != experiment:
        problems.append(
            f"{path}: attribute experiment = {told['experiment']}; must be {experiment}, "
            "the file has another experiment's name"
        )
    declared = told.get("sample_rate_hz", 0.0)
    expected = sample_rate_hz or declared
    if expected > 0.0 and _is_clock(log.channels.get("time_s")):
        problems += _wrong_rate(path, log.channels["time_s"], expected, rate_tolerance)
    if sample_rate_hz and declared > 0.0 and abs(declared / sample_rate_hz - 1.0) > rate_tolerance:
        problems.append(
            f"{path}: attribute sample_rate_hz = {declared:g}; must be {sample_rate_hz:g}, "
            "resample the log or change control.sample_rate_hz"
        )
    if problems:
        raise LogError("\n".join(problems))
    return log


def read_run(path: Path | str, names: tuple[str, ...] | None = None) -> Columns:
    """Read channels of a closed-loop run; the whole log is checked as ``read_raw`` does.

    Parameters
    ----------
    names : tuple of str, optional
        By default all that a raw log has.

    Raises
    ------
    LogError
        See ``read_raw``, but for the rate; further it is no log of a closed-loop run.
    """
    log, problems = _gather(path, names or (), RUN_ATTRIBUTES)
    told = log.attributes
    if "experiment" in told and not _is_run(told):
        problems.append(
            f"{path}: attribute experiment = {told['experiment']}; that of a closed-loop run "
            f"begins with {' or '.join(RUNS)}"
        )
    if problems:
        raise LogError("\n".join(problems))
    if names is None:
        return log
    return log._replace(channels={name: log.channels[name] for name in names})


def _gather(
    path: Path | str, also: tuple[str, ...] = (), attributes: tuple[str, ...] = ()
) -> tuple[Columns, list[str]]:
    """Read a raw log by what its attributes say it is."""
    told = gather_columns(path, ())[0].attributes
    needed = tuple(dict.fromkeys([*_needed(told), *also]))
    if _is_run(told):
        attributes = RUN_ATTRIBUTES
    log, problems = gather_columns(
        path,
        needed,
        tuple(name for name in RAW_CHANNELS if name not in needed),
        (*RAW_ATTRIBUTES, *attributes),
    )
    if _is_imported(told) and not any(name in log.channels for name in _TARGETS):
        problems.append(f"{path}: channel {' or '.join(_TARGETS)}: missing; import one of them")
    more = [*contradictions(told), *_far_away(log.channels)]
    if _is_clock(log.channels.get("time_s")):
        more += _wrong_times(log.channels["time_s"], told.get("settle_s"))
    return log, problems + [f"{path}: {problem}" for problem in more]


def contradictions(told: Mapping[str, Any]) -> list[str]:
    """Return what attributes say that cannot be, each of them being of its kind."""
    problems = []
    source, simulated = told.get("source"), told.get("simulated")
    if source is not None and source not in SOURCES:
        problems.append(f"attribute source = {source}; must be {', '.join(SOURCES)}")
    elif source and simulated is not None and simulated != source.endswith("sim"):
        problems.append(
            f"attribute simulated = {simulated} contradicts source = {source}; correct the wrong "
            "one"
        )
    if not told.get("sample_rate_hz", 1.0) > 0.0:
        problems.append(f"attribute sample_rate_hz = {told['sample_rate_hz']}; must be above 0")
    if told.get("experiment") == "":
        problems.append("attribute experiment: is empty; must be sweep, complex or a run's name")
    if told.get("lost_samples", 0) < 0:
        problems.append(f"attribute lost_samples = {told['lost_samples']}; must not be below 0")
    return problems


def _far_away(channels: Mapping[str, np.ndarray]) -> list[str]:
    problems = []
    for name, values in channels.items():
        far = np.flatnonzero(np.isfinite(values) & (np.abs(values) > _BEYOND))
        if far.size:
            problems.append(
                f"channel {name}: sample {far[0]} is {values[far[0]]:g}, and {far.size - 1} more "
                f"are beyond {_BEYOND:g}, which nothing measures; restore the file or record again"
            )
    return problems


def _is_clock(time_s: np.ndarray | None) -> bool:
    return time_s is not None and time_s.size > 0 and bool((np.abs(time_s) <= _BEYOND).all())


def _wrong_times(time_s: np.ndarray, settle_s: float | None) -> list[str]:
    back = np.flatnonzero(time_s[1:] <= time_s[:-1])
    if back.size:
        k = int(back[0]) + 1
        return [
            f"channel time_s: sample {k} at {time_s[k]:.6f} s does not come after "
            f"{time_s[k - 1]:.6f} s; sort or cut the log"
        ]
    if settle_s is not None and settle_s > time_s[-1]:
        return [
            f"attribute settle_s = {settle_s:g}; the log ends at {time_s[-1]:g} s, so that nothing "
            "is judged"
        ]
    return []


def _wrong_rate(
    path: Path | str, time_s: np.ndarray, expected_hz: float, tolerance: float
) -> list[str]:
    if len(time_s) < 2 or (time_s[1:] <= time_s[:-1]).any():
        return []
    period_s = float(time_s[-1] - time_s[0]) / (len(time_s) - 1)
    if abs(period_s * expected_hz - 1.0) <= tolerance:
        return []
    return [
        f"{path}: channel time_s: sample {len(time_s) - 1}: the mean rate up to here is "
        f"{1.0 / period_s:.4g} Hz, must be {expected_hz:g} Hz; resample the log"
    ]
