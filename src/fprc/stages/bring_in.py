"""Bring in a recording that another program made."""

import json
from pathlib import Path
from typing import Any

import numpy as np

from fprc import __version__
from fprc.artifacts import write_json
from fprc.config.importing import ImportMap, read_map
from fprc.errors import ConfigError, LogError
from fprc.figures import style
from fprc.figures.diagnosis import draw_diagnosis
from fprc.logs import read_columns, write_raw
from fprc.logs.columns import unit_of
from fprc.logs.diagnosis import describe, diagnose
from fprc.logs.importers import gather
from fprc.logs.quality import something_else
from fprc.logs.resample import resample
from fprc.logs.sources import columns_of, read_source
from fprc.provenance import sha256

#: Rates of a log that a guess takes for likely, Hz.
_LIKELY_HZ = (10.0, 20000.0)


def bring_in(source: str, map_file: str, raw: str) -> None:
    """Write a raw log from a foreign file, say what was found in it, and draw it.

    Beside ``raw`` it writes ``*.diagnosis.json`` and ``*.diagnosis.png``. What is
    diagnosed is the recording before it is resampled.

    Raises
    ------
    ConfigError
        The map is wrong.
    LogError
        The file cannot be used so, or ``raw`` is a log that was not imported.
    """
    told = read_map(map_file)
    if told.experiment is None:
        raise ConfigError(
            f"{map_file}: test_from_s is for `fprc readout`; give experiment (sweep or complex) "
            "instead, and start_s or end_s"
        )
    bring_in_as(told, source, raw)


def bring_in_as(told: ImportMap, source: str, raw: str) -> None:
    """Do as ``bring_in`` with a map that was read."""
    if Path(raw).suffix != ".h5":
        raise LogError(f"{raw}: a raw log's name ends in .h5; write --out {Path(raw).stem}.h5")
    _refuse_to_overwrite(raw)
    columns = told.channels.model_dump(exclude_none=True)
    recording = gather(
        read_source(source, **told.csv.model_dump()),
        time=told.time.model_dump(),
        channels=columns,
        start_s=told.start_s,
        end_s=told.end_s,
    )
    units = {name: "" if spec["unit"] == "1" else unit_of(name) for name, spec in columns.items()}
    found = diagnose(recording.time_s, recording.channels)
    words = describe(found, units)
    time_s, channels = resample(recording.time_s, recording.channels, told.sample_rate_hz)
    if len(time_s) < 2:
        raise LogError(
            f"{source}: {found['duration_s']:g} s are less than a sample at "
            f"{told.sample_rate_hz:g} Hz; cut less off"
        )
    write_raw(
        raw,
        {"time_s": time_s, **channels},
        experiment=told.experiment,
        source="import",
        sample_rate_hz=told.sample_rate_hz,
        seed=0,
        software=f"fprc {__version__}",
        rig={},
        imported_from=Path(source).name,
        imported_sha256=sha256(source),
        imported_start_s=recording.start_s,
        map=json.dumps(told.model_dump(exclude_none=True)),
        notes=json.dumps(_notes(columns)),
    )
    stem = Path(raw).with_suffix("")
    file = {"source": Path(source).name, "log": Path(raw).name, "words": words}
    write_json(f"{stem}.diagnosis.json", file | found)
    titles = {
        name: f"{name} from {spec['column']}" + (f": {spec['note']}" if spec["note"] else "")
        for name, spec in columns.items()
    }
    fig = draw_diagnosis(recording.time_s, recording.channels, found, titles=titles, units=units)
    style.save_png(fig, {"source": "import"}, f"{stem}.diagnosis.png")
    same = all(np.array_equal(channels[name], recording.channels[name]) for name in channels)
    _report(source, raw, told, found, words, len(time_s), same)


def _notes(columns: dict[str, dict[str, Any]]) -> dict[str, str]:
    notes = {}
    for name, spec in columns.items():
        if spec["unit"] == "1":
            notes[name] = something_else(name) + spec["note"]
        elif spec["note"]:
            notes[name] = spec["note"]
    return notes


def _refuse_to_overwrite(raw: str) -> None:
    if Path(raw).exists() and read_columns(raw, ()).attributes.get("source") != "import":
        raise LogError(f"{raw}: is a log that was not imported; choose another name for --out")


def _report(
    source: str,
    raw: str,
    told: ImportMap,
    found: dict[str, Any],
    words: list[str],
    samples: int,
    same: bool,
) -> None:
    print(f"{source}:")
    for line in words:
        print(f"  {line}")
    rate_hz = told.sample_rate_hz
    if same:
        how = "as they were"
    elif found["clock"]["running_hz"] > 1.01 * rate_hz:
        how = f"low-passed below {0.5 * rate_hz:g} Hz and resampled"
    else:
        how = "interpolated"
    print(f"{raw}: {samples} samples at {rate_hz:g} Hz, {how}; beside it .diagnosis.json and .png")


def list_source(source: str, map_file: str | None = None) -> None:
    """Print the columns of a foreign file: samples, range, new values, a guess of the rate.

    Parameters
    ----------
    map_file : str, optional
        Only its ``csv`` section is used.
    """
    csv = read_map(map_file).csv.model_dump() if map_file else {}
    content = read_source(source, **csv)
    columns = columns_of(content)
    print(f"{source}: {content.kind}, {len(columns)} columns")
    width = max(map(len, [*columns, "column"]))
    print(f"  {'column':{width}}  {'samples':>8}  {'lowest':>10}  {'highest':>10}  remark")
    for name, values in columns.items():
        finite = values[np.isfinite(values)]
        low, high = (f"{v:.4g}" for v in (finite.min(), finite.max())) if finite.size else "--"
        print(
            f"  {name:{width}}  {len(values):8}  {low:>10}  {high:>10}  {_remark(values)}".rstrip()
        )
    for name, why in content.others.items():
        print(f"  {name}: cannot be a channel: {why}")
    if not any(_rate(values) for values in columns.values()):
        print("no column looks like a clock; give time.rate_hz in the map")


def _remark(values: np.ndarray) -> str:
    missing = int((~np.isfinite(values)).sum())
    if missing:
        return f"{missing} values are not finite"
    guess = _rate(values)
    if guess:
        return f"a clock? {guess[0]:.4g} Hz if in {guess[1]}"
    fresh = np.count_nonzero(np.diff(values)) / max(len(values) - 1, 1)
    return "constant" if fresh == 0.0 else f"{fresh:.0%} new values" if fresh < 0.9 else ""


def _rate(values: np.ndarray) -> tuple[float, str] | None:
    """Return the likely rate and unit of a column that increases as a clock does."""
    steps = np.diff(values)
    if len(steps) < 2 or not np.isfinite(values).all() or not (steps > 0.0).all():
        return None
    step = float(np.median(steps))
    if not (np.abs(steps - step) < 0.5 * step).mean() > 0.9:
        return None
    for unit, factor in (("s", 1.0), ("ms", 1e-3), ("us", 1e-6)):
        if _LIKELY_HZ[0] <= 1.0 / (step * factor) <= _LIKELY_HZ[1]:
            return 1.0 / (step * factor), unit
    return None
