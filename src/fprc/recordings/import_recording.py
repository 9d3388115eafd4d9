"""`fprc import`: convert a recording of another program to a raw log, and draw it."""

import json
from pathlib import Path
from textwrap import shorten
from typing import Any

import numpy as np

from fprc import escape
from fprc.artifacts import refuse_output, replacing
from fprc.channels import unit_of
from fprc.config import Settings
from fprc.errors import ConfigError, LogError
from fprc.logs import read_columns, write_raw
from fprc.provenance import sha256
from fprc.recordings.draft import draft_map
from fprc.recordings.gather import Recording, gather, resample
from fprc.recordings.importing import ImportMap, read_csv, read_map
from fprc.recordings.judge import judge
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
    """Turn a recording of another program into a raw log; no file of another program is lost."""
    if draft:
        # a map that is not complete may already say how the text is to be read
        layout = read_csv(map_).model_dump() if map_ else {}
        print(draft_map(read_table(source, **layout), layout))
        return
    if not (map_ and out):
        raise ConfigError("give --draft, or both --map and --out")
    mapping = read_map(map_)
    if mapping.experiment is None:
        raise ConfigError(f"{map_}: experiment is missing; give sweep or complex")
    picture = str(Path(out).with_suffix(".png"))
    refuse_output(out, ".h5", ours=is_imported)
    refuse_output(picture, ".png", ours=lambda old: is_imported(out))
    table = read_table(source, **mapping.csv.model_dump())
    recording = gather(table, mapping)
    found = judge(recording, mapping, table, Settings().quality, mapping.target("measured"))
    rate_hz = mapping.sample_rate_hz or RATE_HZ
    samples = resample(recording.time_s, recording.channels, rate_hz, source)
    write_log(out, recording, *samples, mapping.changed(sample_rate_hz=rate_hz), source)
    draw_recording(recording, mapping, picture)
    doubts = [f"doubtful: {line}" for line in (*found.doubts, *found.stops)]
    lines = [*found.words, *doubts, *table.notes, *recording.notes]
    print("\n".join([f"{source}:", *(f"  {line}" for line in lines)]))
    print(f"{out}: {len(samples[0])} samples at {rate_hz:g} Hz; beside it its picture, .png")


def write_log(
    raw: Path | str,
    recording: Recording,
    time_s: np.ndarray,
    channels: dict[str, np.ndarray],
    mapping: ImportMap,
    source: str,
) -> None:
    """Write what was resampled of a recording as a raw log."""
    noted = {"time_s": "; ".join(recording.notes)} if recording.notes else {}
    attributes: dict[str, Any] = {
        "experiment": mapping.experiment,
        "source": "import",
        "sample_rate_hz": mapping.sample_rate_hz,
        "seed": 0,
        "rig": {},
        "imported_from": escape.visible(Path(source).name),
        "imported_sha256": sha256(source),
        "imported_start_s": recording.start_s + float(time_s[0]),
        "map": json.dumps(mapping.model_dump(exclude_none=True)),
        "notes": json.dumps(mapping.notes | noted),
    }
    with replacing(raw) as log:
        write_raw(log, {"time_s": time_s - time_s[0], **channels}, **attributes)


def is_imported(old: Path | str) -> bool:
    """Return whether a file is a raw log that an import wrote."""
    try:
        return bool(read_columns(old, ()).attributes.get("source") == "import")
    except LogError:
        return False


def draw_recording(recording: Recording, mapping: ImportMap, png: str) -> None:
    """Draw every channel over time, as it was recorded."""
    from fprc.figures import style  # slow to import, and a draft needs none

    columns, count = mapping.columns, len(recording.channels)
    fig, axes = style.figure(
        count, 1, style.PAGE_IN, 0.4 + 0.85 * count, sharex=True, squeeze=False
    )
    for ax, (name, values) in zip(axes[:, 0], recording.channels.items(), strict=True):
        quantity, spec = name.rpartition("_")[0].removesuffix("_command"), columns[name]
        colour = style.SIGNALS.get(quantity, style.SIGNALS["valve"])  # grey: none of its own
        ax.plot(recording.time_s, values, color=colour, linewidth=0.6)
        title = f"{name} from {spec['column']}{': ' * bool(spec['note'])}{spec['note']}"
        style.letter(ax, escape.figure(shorten(title, 100, placeholder=" ...")))
        ax.set_ylabel("" if spec["unit"] == "1" else unit_of(name))
    ax.set_xlim(*recording.time_s[[0, -1]])
    ax.set_xlabel("Time [s]")
    style.save(fig, {"source": "import"}, png)
