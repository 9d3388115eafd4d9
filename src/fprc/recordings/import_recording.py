"""`fprc import`: convert a recording of another program to a raw log."""

import json
from pathlib import Path
from typing import Any

import numpy as np

from fprc.artifacts import refuse_output, replacing
from fprc.config import Settings
from fprc.errors import ConfigError, LogError
from fprc.escape import visible
from fprc.logs import read_columns, write_raw
from fprc.provenance import sha256
from fprc.recordings.draft import draft_map
from fprc.recordings.gather import Recording, gather
from fprc.recordings.importing import ImportMap, read_csv, read_map
from fprc.recordings.judge import judge
from fprc.recordings.picture import draw_recording
from fprc.recordings.resample import resample
from fprc.recordings.table import read_table

#: Rate of a raw log unless its map gives one, Hz.
RATE_HZ = 200.0


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
            raise ConfigError(f"{map_}: experiment is missing; give sweep or complex")
        import_mapped(mapping, source, out)
    else:
        raise ConfigError("give --draft, or both --map and --out")


def import_mapped(mapping: ImportMap, source: str, raw: str) -> None:
    """Convert a foreign file to a raw log, and draw it as ``*.png`` beside the log.

    Raises
    ------
    LogError
        The file cannot be used with this map; lists all columns that it lacks.
    OutputError
        One of the files exists and was not written by an import, or cannot be written.
    """
    picture = str(Path(raw).with_suffix(".png"))
    refuse_output(raw, ".h5", ours=is_imported)
    refuse_output(picture, ".png", ours=lambda old: is_imported(raw))
    table = read_table(source, **mapping.csv.model_dump())
    recording = gather(table, mapping)
    found = judge(recording, mapping, table, Settings().quality, mapping.target("measured"))
    rate_hz = mapping.sample_rate_hz or RATE_HZ
    samples = resample(recording.time_s, recording.channels, rate_hz, source)
    write_log(recording, samples, mapping, source, raw)
    draw_recording(recording, mapping, picture)
    doubts = [f"doubtful: {line}" for line in (*found.doubts, *found.stops)]
    lines = [*found.words, *doubts, *table.notes, *recording.notes]
    print("\n".join([f"{source}:", *(f"  {line}" for line in lines)]))
    print(f"{raw}: {len(samples[0])} samples at {rate_hz:g} Hz; beside it its picture, .png")


def write_log(
    recording: Recording,
    samples: tuple[np.ndarray, dict[str, np.ndarray]],
    mapping: ImportMap,
    source: str,
    raw: Path | str,
) -> None:
    """Write what was resampled of a recording as a raw log."""
    notes = mapping.notes
    if recording.notes:
        notes["time_s"] = "; ".join(recording.notes)
    attributes: dict[str, Any] = {
        "experiment": mapping.experiment,
        "source": "import",
        "sample_rate_hz": mapping.sample_rate_hz or RATE_HZ,
        "seed": 0,
        "rig": {},
        "imported_from": visible(Path(source).name),
        "imported_sha256": sha256(source),
        "imported_start_s": recording.start_s,
        "map": json.dumps(mapping.model_dump(exclude_none=True)),
        "notes": json.dumps(notes),
    }
    with replacing(raw) as log:
        write_raw(log, {"time_s": samples[0], **samples[1]}, **attributes)


def is_imported(old: Path | str) -> bool:
    """Return whether a file is a raw log that an import wrote."""
    try:
        return bool(read_columns(old, ()).attributes.get("source") == "import")
    except LogError:
        return False
