"""Columns of a foreign file as channels of a raw log."""

from collections.abc import Mapping
from typing import Any, NamedTuple

import numpy as np

from fprc.errors import LogError
from fprc.logs.sources import Source, pick

#: What a number in a unit is multiplied by; ``1`` is something else, taken as it is.
FACTORS = {
    "kPa": 1.0, "Pa": 1e-3, "mbar": 0.1, "bar": 100.0, "psi": 6.894757293168361, "MPa": 1e3,
    "deg": 1.0, "rad": 180.0 / np.pi, "V": 1.0, "mV": 1e-3, "1": 1.0,
    "s": 1.0, "ms": 1e-3, "us": 1e-6, "min": 60.0,
}  # fmt: skip


class Recording(NamedTuple):
    """Channels as they were sampled, in the units of a raw log.

    Attributes
    ----------
    time_s : ndarray
        Instants, from 0 at the first sample that is kept.
    start_s : float
        That sample's instant on the clock of the file.
    """

    time_s: np.ndarray
    channels: dict[str, np.ndarray]
    start_s: float


def gather(
    source: Source,
    *,
    time: Mapping[str, Any],
    channels: Mapping[str, Mapping[str, Any]],
    start_s: float = 0.0,
    end_s: float | None = None,
) -> Recording:
    """Pick, convert and cut the channels of a file.

    Parameters
    ----------
    time : Mapping
        ``column`` and ``unit``, or ``rate_hz``.
    channels : Mapping
        By channel: ``column``, ``unit``, ``scale``, ``offset``.
    start_s, end_s : float
        What is kept, counted from the first sample.

    Raises
    ------
    LogError
        Every problem at once: a column is not there, lengths differ, time does
        not increase or a value that is kept is not finite (with its sample in
        the file, from 0).
    """
    problems: list[str] = []
    picked: dict[str, np.ndarray] = {}
    wanted = {name: spec["column"] for name, spec in channels.items()}
    if time.get("column") is not None:
        wanted = {"time": time["column"]} | wanted
    for name, column in wanted.items():
        try:
            picked[name] = pick(source, column)
        except LogError as error:
            problems.append(f"{source.path}: {name}: {error}")
    if problems:
        raise LogError("\n".join(problems))
    _refuse_unequal(source, wanted, {name: len(values) for name, values in picked.items()})

    begin, since = _instants(source, time, picked)
    last = np.inf if end_s is None else end_s
    # the clock's last digit decides nothing
    kept = np.flatnonzero((since >= start_s - 1e-9) & (since <= last + 1e-9))
    if len(kept) < 2:
        raise LogError(
            f"{source.path}: {len(kept)} samples lie between start_s = {start_s:g} and end_s = "
            f"{last:g}; the file has {len(since)}, over {since[-1]:g} s"
        )
    converted = {}
    for name, spec in channels.items():
        values = picked[name][kept]
        problems += _not_finite(source, wanted[name], name, values, int(kept[0]))
        scaled = values * spec["scale"] + spec["offset"]
        converted[name] = scaled * FACTORS[spec["unit"]]
    if problems:
        raise LogError("\n".join(problems))
    cut = since[kept[0]]
    return Recording(since[kept] - cut, converted, float(begin + cut))


def _refuse_unequal(source: Source, wanted: Mapping[str, str], lengths: Mapping[str, int]) -> None:
    if len(set(lengths.values())) > 1:
        each = ", ".join(f"{wanted[name]} {length}" for name, length in lengths.items())
        raise LogError(
            f"{source.path}: columns have unequal numbers of samples ({each}); bring them to one "
            "clock first"
        )


def _instants(
    source: Source, time: Mapping[str, Any], picked: Mapping[str, np.ndarray]
) -> tuple[float, np.ndarray]:
    """Return the first instant, and every one since: clocks that count from 1970 lose digits."""
    if "time" not in picked:
        return 0.0, np.arange(len(next(iter(picked.values())))) / time["rate_hz"]
    instants = picked["time"]
    bad = np.flatnonzero(~np.isfinite(instants))
    if bad.size:
        raise LogError(
            f"{source.path}: time: {time['column']}: sample {bad[0]} is {instants[bad[0]]}, and "
            f"{bad.size - 1} more are not finite; fill them in, delete those rows, or give "
            "time.rate_hz"
        )
    back = np.flatnonzero(np.diff(instants) <= 0.0)
    if back.size:
        k = int(back[0]) + 1
        raise LogError(
            f"{source.path}: time: {time['column']}: sample {k} at {instants[k]:.16g} does not "
            f"come after {instants[k - 1]:.16g}, and {back.size - 1} more do not; sort, cut or "
            "repair the clock, or give time.rate_hz"
        )
    factor = FACTORS[time["unit"]]
    return instants[0] * factor, (instants - instants[0]) * factor


def _not_finite(
    source: Source, column: str, name: str, values: np.ndarray, first: int
) -> list[str]:
    bad = np.flatnonzero(~np.isfinite(values))
    if not bad.size:
        return []
    return [
        f"{source.path}: {name}: {column}: sample {first + bad[0]} is {values[bad[0]]}, and "
        f"{bad.size - 1} more are not finite; cut them off by start_s and end_s, or fill them in"
    ]
