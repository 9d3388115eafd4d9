"""`fprc import`: convert a recording of another program to a raw log."""

import json
import os
from functools import lru_cache
from pathlib import Path
from typing import Any

import numpy as np

from fprc.artifacts import is_json_with, read_json, refuse_output, replacing, write_json
from fprc.channels import unit_of
from fprc.config import Settings
from fprc.errors import ConfigError, LogError
from fprc.escape import visible
from fprc.figures import style
from fprc.logs import read_columns, write_raw
from fprc.logs.quality import other_quantity
from fprc.provenance import sha256
from fprc.recordings.clock import LIKELY_HZ, rate_of
from fprc.recordings.diagnosis import describe, diagnose
from fprc.recordings.diagnosis_figure import draw_diagnosis
from fprc.recordings.draft import doubts, draft_map
from fprc.recordings.gather import Recording, gather, refuse_length
from fprc.recordings.importing import ImportMap, read_csv, read_map
from fprc.recordings.resample import resample
from fprc.recordings.table import Table, read_table


def import_or_draft(
    source: str,
    *,
    draft: bool = False,
    map_: str | None = None,
    out: str | None = None,
) -> None:
    """Turn a recording of another program into a raw log."""
    if draft:
        # a map that is not complete may already say how the text is to be read
        layout = read_csv(map_).model_dump() if map_ else {}
        print(draft_map(read_table(source, **layout), layout))
    elif map_ and out:
        mapping = read_map(map_)
        if mapping.experiment is None:
            raise ConfigError(
                f"{map_}: test_from_s is for `fprc readout`; give experiment (sweep or complex) "
                "instead, and start_s or end_s"
            )
        import_mapped(mapping, source, out)
    else:
        raise ConfigError("give --draft, or both --map and --out")


def own_rate(mapping: ImportMap, source: str) -> tuple[float, float]:
    """Return the sample rate of a recording by its clock, Hz, and its duration, s.

    Raises
    ------
    LogError
        The file cannot be used with this map; or the rate is implausible, and the map does not
        give it.
    """
    _, recording = read_recording(mapping, source)
    rate_hz = rate_of(recording.time_s)
    if mapping.sample_rate_hz is None and not 1.0 <= rate_hz <= LIKELY_HZ[1]:
        raise LogError(
            f"{source}: time: {rate_hz:.4g} Hz are unusual: check time.unit = {mapping.time.unit}; "
            "if it is right, give sample_rate_hz"
        )
    return rate_hz, float(recording.time_s[-1])


def read_recording(mapping: ImportMap, source: str) -> tuple[Table, Recording]:
    """Return a file, and of it what the map selects."""
    known = os.stat(source) if os.path.exists(source) else None
    stamp = known and (known.st_mtime_ns, known.st_size)
    table = _table(source, stamp, tuple(mapping.csv.model_dump().items()))
    recording = gather(
        table,
        time=mapping.time.model_dump(),
        channels=mapping.channels.model_dump(exclude_none=True),
        start_s=mapping.start_s,
        end_s=mapping.end_s,
        skip_unusable=mapping.skip_unusable,
    )
    return table, recording


@lru_cache(maxsize=1)
def _table(source: str, stamp: object, layout: tuple[tuple[str, Any], ...]) -> Table:
    """Return a file; `fprc readout` takes several parts of the same."""
    return read_table(source, **dict(layout))


def import_mapped(mapping: ImportMap, source: str, raw: str) -> None:
    """Convert a foreign file to a raw log, diagnose it, and draw it.

    Writes ``*.diagnosis.json`` and ``*.diagnosis.png`` beside ``raw``: all three
    or none. The diagnosis describes the recording before resampling.

    Raises
    ------
    LogError
        The file cannot be used with this map; lists all columns that it lacks.
    OutputError
        One of the three files exists and was not written by an import to ``raw``, or cannot be
        written.
    """
    diagnosed, picture = _outputs_beside(raw)
    columns, rate_hz = mapping.channels.model_dump(exclude_none=True), mapping.rate_hz
    table, recording = read_recording(mapping, source)
    refuse_length(source, recording.time_s, rate_hz)
    units = {name: "" if spec["unit"] == "1" else unit_of(name) for name, spec in columns.items()}
    diagnosis = diagnose(recording, quality=Settings().quality.model_dump())
    taken = [f"{name} from {spec['column']} ({spec['unit']})" for name, spec in columns.items()]
    if mapping.time.column:
        taken.insert(0, f"time from {mapping.time.column} ({mapping.time.unit})")
    lines = [*describe(diagnosis, units), f"taken: {'; '.join(taken)}"]
    lines += [f"doubtful: {doubt}" for doubt in doubts(mapping, table, recording)]
    lines += [*table.notes, *recording.notes]
    time_s, channels = resample(recording.time_s, recording.channels, rate_hz)
    notes = {
        name: (other_quantity(name) if spec["unit"] == "1" else "") + spec["note"]
        for name, spec in columns.items()
    }
    filled = [line.removeprefix("clock: ") for line in lines if line.startswith("clock: gaps")]
    notes["time_s"] = "; ".join([*filled, *recording.notes])
    attributes: dict[str, Any] = {
        "experiment": mapping.experiment,
        "source": "import",
        "sample_rate_hz": rate_hz,
        "seed": 0,
        "rig": {},
        "imported_from": visible(Path(source).name),
        "imported_sha256": sha256(source),
        "imported_start_s": recording.start_s,
        "map": json.dumps(mapping.model_dump(exclude_none=True)),
        "notes": json.dumps({name: note for name, note in notes.items() if note}),
    }
    titles = {
        name: f"{name} from {spec['column']}" + (f": {spec['note']}" if spec["note"] else "")
        for name, spec in columns.items()
    }
    with replacing(raw) as log, replacing(diagnosed) as page:
        file = {"source": Path(source).name, "log": Path(raw).name, "words": lines}
        write_json(page, file | diagnosis)
        write_raw(log, {"time_s": time_s, **channels}, **attributes)
    drawn = ".png"
    try:
        fig = draw_diagnosis(recording, diagnosis, titles=titles, units=units)
        style.save(fig, {"source": "import"}, picture)
    except Exception as error:  # of Matplotlib with a user's fonts, of any type; the log is kept
        Path(picture).unlink(missing_ok=True)  # of an earlier import
        drawn = f"no picture ({type(error).__name__}: {error})"
    if all(np.array_equal(channels[name], recording.channels[name]) for name in channels):
        how = "unchanged"
    elif diagnosis["clock"]["running_hz"] > 1.01 * rate_hz:
        how = f"low-passed below {0.5 * rate_hz:g} Hz and resampled"
    else:
        how = "interpolated"
    report = [
        f"{source}:",
        *(f"  {line}" for line in lines),
        f"{raw}: {len(time_s)} samples at {rate_hz:g} Hz, {how}; beside it .diagnosis.json and "
        f"{drawn}",
    ]
    print("\n".join(report))


def _outputs_beside(raw: str) -> tuple[str, str]:
    """Return the names of diagnosis and picture; only an earlier import may be overwritten."""
    stem = Path(raw).with_suffix("")
    diagnosed, picture = f"{stem}.diagnosis.json", f"{stem}.diagnosis.png"

    def is_ours(old: Path) -> bool:
        # the picture does not name its log: it was written with the diagnosis
        known = is_json_with(diagnosed, "source", "log", "words")
        return known and read_json(diagnosed)["log"] == Path(raw).name

    refuse_output(raw, ".h5", ours=_is_imported)
    refuse_output(diagnosed, ".json", ours=is_ours)
    refuse_output(picture, ".png", ours=is_ours)
    return diagnosed, picture


def _is_imported(old: Path) -> bool:
    try:
        return bool(read_columns(old, ()).attributes.get("source") == "import")
    except LogError:
        return False
