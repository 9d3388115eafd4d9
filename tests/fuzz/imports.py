"""Maps of an import, the expected log, and the commands to run."""

import json
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

import h5py
import numpy as np
import yaml
from judging import SAME, SILENT, Ended, Step, Verdict

MAP = "map.yaml"
_FACTORS = {
    "kPa": 1.0, "Pa": 1e-3, "bar": 100.0, "MPa": 1e3, "deg": 1.0, "rad": 180.0 / np.pi, "1": 1.0,
    "s": 1.0, "ms": 1e-3, "us": 1e-6, "min": 60.0,
}  # fmt: skip

#: Columns of a file by name; None for anything but a column of numbers.
Reading = Callable[[Path], Mapping[str, np.ndarray | None]]


class WrongError(Exception):
    """The import must refuse the file with this map."""


def steps(
    rng: np.random.Generator, source: str, mapping: dict[str, Any], read: Reading, *, draw: float
) -> list[Step]:
    """Return the commands on a recording: listing it, importing it, or both.

    Parameters
    ----------
    draw : float
        Probability of an import; drawing its picture takes as long as ten listings.
    """

    def listed(folder: Path, ended: Ended) -> Verdict:
        return (SAME, "") if source in ended.out else (SILENT, "the file is not named")

    def imported(folder: Path, ended: Ended) -> Verdict:
        return compare(folder, mapping, lambda: read(folder / source), ended)

    imports = rng.random() < draw
    found = []
    if not imports or rng.random() < 0.3:
        command = ("import", source, "--list")
        found.append(Step(command, "fprc import --list", (source,), listed))
    if imports:
        found.append(
            Step(
                ("import", source, "--map", MAP, "--out", "out.h5"), "fprc import --map --out",
                (source, MAP), imported,
                ("out.h5", "out.diagnosis.json", "out.diagnosis.png"),
            )
        )  # fmt: skip
    return found


def write_map(folder: Path, mapping: Mapping[str, Any]) -> None:
    """Write a map."""
    text = yaml.safe_dump(dict(mapping), allow_unicode=True, sort_keys=False)
    (folder / MAP).write_text(text, encoding="utf-8")


def any_map(
    rng: np.random.Generator, columns: Mapping[str, str], time: dict[str, Any], rate_hz: float
) -> dict[str, Any]:
    """Return a map of these columns by channel."""
    channels = {}
    for channel, column in columns.items():
        pressures, angles = ["kPa", "bar", "Pa"], ["deg", "rad"]
        unit = str(rng.choice(angles if channel.endswith("deg") else pressures))
        channels[channel] = {"column": column, "unit": unit}
        if rng.random() < 0.3:
            channels[channel] |= {"scale": 2.0, "offset": -1.0}
    mapping = {"experiment": "sweep", "sample_rate_hz": rate_hz, "time": time, "channels": channels}
    if rng.random() < 0.2:
        mapping |= {"start_s": 0.2}
    if rng.random() < 0.1:
        mapping |= {"end_s": 1.0}
    return mapping


def spoil(rng: np.random.Generator, mapping: dict[str, Any]) -> str:
    """Put an error into a map and return its description."""
    ways = [
        ("channels", "theta_deg", "unit", ["grad", "kPa", 5, None, "\x1b[31m"]),
        ("channels", "theta_deg", "column", ["nothing", "", "angle[:, 7]", "\x1b[31mx", "(.*", 99]),
        ("channels", "theta_deg", "scale", [0.0, np.nan, np.inf, 1e308, "x", None]),
        ("channels", "theta_deg", "offset", [1e308, np.nan, "x", [1]]),
        ("channels", "theta_deg", "note", [5, "\x1b[31m", "$\\frac{$", "x" * 5000]),
        ("channels", "theta_deg", "colum", ["x"]),
        ("time", "column", None, ["nothing", 5, []]),
        ("time", "unit", None, ["us", "min", "h", 5]),
        ("time", "repeated", None, ["first", "mean", "last", 5]),
        ("sample_rate_hz", None, None, [0, -1, 1e5, 1e9, "x", np.inf]),
        ("end_s", None, None, [0.0, -1.0, 1e-9, 1e300, "x"]),
        ("start_s", None, None, [5e3, -1.0, np.nan]),
        ("baar", None, None, [5]),
        ("csv", None, None, [{"separator": ";;"}, {"header_line": 0}, {"header_line": 10**9}, 5]),
        ("experiment", None, None, ["banana", None, 5]),
    ]
    *way, values = ways[rng.integers(len(ways))]
    value = values[rng.integers(len(values))]
    way = [part for part in way if part is not None]
    inner = mapping
    for part in way[:-1]:
        inner = inner[part]
    if isinstance(inner, dict):
        inner[way[-1]] = value
    return f"{'.'.join(way)} = {str(value)[:30]!r}"


def compare(
    folder: Path,
    mapping: Mapping[str, Any],
    read: Callable[[], Mapping[str, np.ndarray | None]],
    ended: Ended,
) -> Verdict:
    """Compare the log that an import wrote with the expected one."""
    for name in ("out.h5", "out.diagnosis.json", "out.diagnosis.png"):
        if not (folder / name).exists():
            return SILENT, f"no {name}"
    json.loads((folder / "out.diagnosis.json").read_text(encoding="utf-8"), parse_constant=_refuse)
    with h5py.File(folder / "out.h5") as file:
        found = {name: file[name][()] for name in file}
    if not all(np.isfinite(values).all() for values in found.values()):
        return SILENT, "no numbers in the log"
    try:
        expected, gaps = expect(mapping, read())
    except WrongError as error:
        return SILENT, f"accepted: {error}"
    if gaps and "gap" not in ended.out:
        return SILENT, f"{gaps} gaps are not reported"
    if expected is None:
        return SAME, ""
    other = [
        name
        for name, values in expected.items()
        if name not in found
        or found[name].shape != values.shape
        or not np.allclose(found[name], values, rtol=1e-9, atol=1e-9 * (1.0 + np.ptp(values)))
    ]
    return (SILENT, f"differ: {', '.join(other)}") if other else (SAME, "")


def _refuse(text: str) -> None:
    raise ValueError(f"{text} in the diagnosis")


def expect(
    mapping: Mapping[str, Any], columns: Mapping[str, np.ndarray | None]
) -> tuple[dict[str, np.ndarray] | None, int]:
    """Return the expected channels of a log, and the number of gaps in its recording.

    The channels are None if the import applies a low-pass, which other tests check.

    Raises
    ------
    WrongError
        The recording does not have what the map needs.
    """
    picked = {name: _column(columns, spec["column"]) for name, spec in mapping["channels"].items()}
    length = len(next(iter(picked.values())))
    time = mapping["time"]
    if time.get("column") is None:
        since = np.arange(length) / time["rate_hz"]
    else:
        instants = _column(columns, time["column"])
        since = (instants - instants[0]) * _FACTORS[time["unit"]]
    if any(len(values) != len(since) for values in picked.values()):
        raise WrongError("columns of unequal lengths")
    if not np.isfinite(since).all():
        raise WrongError("no clock")
    since, picked = _once(since, picked, time.get("repeated"))
    if not (np.diff(since) > 0.0).all():
        raise WrongError("the clock does not increase")
    end_s = mapping.get("end_s", np.inf)
    kept = (since >= mapping.get("start_s", 0.0) - 1e-9) & (since <= end_s + 1e-9)
    since = since[kept] - since[kept][0]
    channels = {}
    for name, spec in mapping["channels"].items():
        with np.errstate(over="ignore"):
            values = picked[name][kept] * spec.get("scale", 1.0) + spec.get("offset", 0.0)
            channels[name] = values * _FACTORS[str(spec["unit"])]
        if not np.isfinite(channels[name]).all():
            raise WrongError(f"{name}: no numbers")
    steps_s = np.diff(since)
    gaps = int((steps_s > 1.5 * np.median(steps_s)).sum())
    return _on_grid(since, channels, mapping.get("sample_rate_hz", 200.0)), gaps


def _once(
    since: np.ndarray, picked: Mapping[str, np.ndarray], how: str | None
) -> tuple[np.ndarray, Mapping[str, np.ndarray]]:
    """Merge samples with the same time stamp, if the map says how."""
    if how not in ("first", "mean") or not len(since):
        return since, picked
    order = np.argsort(since, kind="stable")
    times, first, place = np.unique(since[order], return_index=True, return_inverse=True)
    merged = {}
    for name, values in picked.items():
        ordered = values[order]
        count = np.bincount(place)
        merged[name] = ordered[first] if how == "first" else np.bincount(place, ordered) / count
    return times, merged


def _column(columns: Mapping[str, np.ndarray | None], name: Any) -> np.ndarray:
    found = columns.get(str(name))
    if found is None:
        raise WrongError(f"{name}: no column of numbers")
    return np.asarray(found, np.float64)


def _on_grid(
    since: np.ndarray, channels: Mapping[str, np.ndarray], rate_hz: float
) -> dict[str, np.ndarray] | None:
    steps_s = np.diff(since)
    usual = steps_s[steps_s <= 3.0 * np.median(steps_s)].mean()
    if 1.0 / usual > 1.01 * rate_hz:
        return None
    samples = int(np.floor(since[-1] * rate_hz + 1e-6)) + 1
    grid = np.arange(samples) / rate_hz
    as_they_were = samples <= len(since) and (
        np.abs(since[:samples] - grid).max() <= 1e-3 / rate_hz
    )
    return {"time_s": grid} | {
        name: values[:samples] if as_they_were else np.interp(grid, since, values)
        for name, values in channels.items()
    }
