"""`fprc import`: convert a recording of another program to a raw log."""

import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from fprc.artifacts import is_json_with, read_json, refuse_output, replacing_all, write_json
from fprc.channels import CHANNELS, TARGETS, unit_of
from fprc.config import Settings
from fprc.errors import ConfigError, LogError
from fprc.escape import in_words, terminal, visible
from fprc.figures import style
from fprc.logs import read_columns, write_raw
from fprc.logs.quality import other_quantity
from fprc.provenance import sha256
from fprc.recordings.clock import SECONDS, Recording, likely_rate, oddities, refuse_length
from fprc.recordings.diagnosis import describe, diagnose
from fprc.recordings.diagnosis_figure import draw_diagnosis
from fprc.recordings.gather import gather, read_source
from fprc.recordings.importing import (
    ImportMap,
    is_absolute,
    is_time,
    likely_channel,
    likely_time_unit,
    likely_unit,
    read_csv,
    read_map,
)
from fprc.recordings.resample import rate_of, resample
from fprc.recordings.source import Source

#: Channels of a draft even if no column's name identifies them: what training FPRC needs.
_DRAFTED = ("theta_deg", TARGETS["measured"], "p_o_kpa")
#: Largest distance of a clock that jitters from a straight line, as a share of its span.
_OFF_LINE = 0.01
#: A sample rate this near to a whole number of Hz, as a share of it, is that number: quartz clocks
#: are better. Rates such as 142.857 Hz, a sample each 7 ms, stay as they are.
_INTEGER_TOLERANCE = 5e-4


def import_or_draft(
    source: str,
    *,
    draft: bool = False,
    map_: str | None = None,
    out: str | None = None,
) -> None:
    """Turn a CSV, HDF5 or MATLAB file into a raw log."""
    if draft:
        # a map that is not complete may already say how the text is to be read
        layout = read_csv(map_).model_dump() if map_ else {}
        print(draft_map(read_source(source, **layout)))
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

    The rate excludes pauses. If it differs from a whole number by no more than a clock's error, it
    is that number.

    Raises
    ------
    LogError
        The file cannot be used with this map; or its clock is odd, and the map does not give the
        rate.
    """
    content, recording = _read(mapping, source)
    odd = oddities(content, mapping.time.model_dump(), recording)
    if odd and mapping.sample_rate_hz is None:
        raise LogError(f"{source}: time: {'; '.join(odd)}; give sample_rate_hz if it is not")
    rate_hz = rate_of(recording.time_s)
    whole_hz = float(np.round(rate_hz))
    is_whole = abs(rate_hz - whole_hz) <= _INTEGER_TOLERANCE * rate_hz
    return (whole_hz if is_whole else rate_hz), float(recording.time_s[-1])


def _read(mapping: ImportMap, source: str) -> tuple[Source, Recording]:
    """Return a file, and of it what the map selects."""
    content = read_source(source, **mapping.csv.model_dump())
    recording = gather(
        content,
        time=mapping.time.model_dump(),
        channels=mapping.channels.model_dump(exclude_none=True),
        start_s=mapping.start_s,
        end_s=mapping.end_s,
    )
    return content, recording


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
    time = mapping.time.model_dump()
    content, recording = _read(mapping, source)
    refuse_length(content, time, recording, rate_hz)
    units = {name: "" if spec["unit"] == "1" else unit_of(name) for name, spec in columns.items()}
    diagnosis = diagnose(recording, quality=Settings().quality.model_dump())
    lines = describe(diagnosis, units)
    lines[1:1] = [f"clock: {oddity}" for oddity in oddities(content, time, recording)]
    lines += content.notes
    time_s, channels = resample(recording.time_s, recording.channels, rate_hz)
    notes = {
        name: (other_quantity(name) if spec["unit"] == "1" else "") + spec["note"]
        for name, spec in columns.items()
    }
    filled = [line.removeprefix("clock: ") for line in lines if line.startswith("clock: gaps")]
    notes["time_s"] = "".join(filled)
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
    with replacing_all(diagnosed, picture, raw) as (page, png, log):
        file = {"source": Path(source).name, "log": Path(raw).name, "words": lines}
        write_json(page, file | diagnosis)
        fig = draw_diagnosis(recording, diagnosis, titles=titles, units=units)
        style.save(fig, {"source": "import"}, str(png))
        write_raw(log, {"time_s": time_s, **channels}, **attributes)
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
        ".png",
    ]
    print(terminal("\n".join(report)))


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


def draft_map(content: Source) -> str:
    """Return a map of a foreign file in YAML, its channels, units and clock guessed.

    A channel that the workflow needs and no column's name identifies has the column ``?``, and
    a unit that no name gives is marked: the user completes them. Comments describe each column.
    """
    columns = content.columns
    guesses = {
        name: guess for name, values in columns.items() if (guess := _guess_clock(name, values))
    }
    # a row's number is one too, so the name decides; else the first
    clock = min(guesses, key=lambda name: not is_time(name), default=None)
    found: dict[str, str] = {}
    for name in columns:
        if name != clock and (likely := likely_channel(name)):
            found.setdefault(likely, name)
    file = visible(f"{content.path.name}, {content.kind}")
    lines = [
        f"# Drafted from the names in {file}; check each "
        "line; complete those with a ?, or delete them where the recording has no such channel",
        "experiment: sweep  # or complex; instead, for fprc readout: test_from_s, in seconds",
    ]
    if clock is None:
        lines.append(_line("time", {"rate_hz": "?"}, "or column and unit"))
    else:
        rate_hz, unit = guesses[clock]
        others = [] if is_time(clock) else [name for name in guesses if name != clock]
        doubt = f"; or {in_words(others, 'or')}?" if others else ""
        lines.append(_line("time", {"column": clock, "unit": unit}, f"{rate_hz:.5g} Hz{doubt}"))
    lines.append("channels:")
    for channel in CHANNELS:
        key = f"  {channel.name}"
        column = found.get(channel.name)
        if column is not None:
            named = likely_unit(column, channel.name)
            words = _in_words(columns[column]) + ("" if named else "; unit?")
            if channel.unit == "kPa" and is_absolute(column):
                words += "; absolute? then offset: minus the air's, -101.325 kPa"
            lines.append(_line(key, {"column": column, "unit": named or channel.unit}, words))
        elif channel.name in _DRAFTED and not (
            channel.name == TARGETS["measured"] and TARGETS["command"] in found
        ):
            lines.append(_line(key, {"column": "?", "unit": channel.unit}, channel.meaning))
    more = [
        f"{json.dumps(name, ensure_ascii=False)}: {_in_words(values)}"
        for name, values in columns.items()
        if name not in (clock, *found.values())
    ]
    more += [f"{name}: cannot be a channel: {why}" for name, why in content.others.items()]
    return "\n".join([*lines, *(visible(f"# {text}") for text in (*more, *content.notes))])


def _line(key: str, value: Mapping[str, str], comment: str) -> str:
    """Return a line of YAML; names are in quotes, with unprintable characters as its escapes."""
    return visible(f"{key}: {json.dumps(value, ensure_ascii=False)}  # {comment}")


def _in_words(values: np.ndarray) -> str:
    """Describe a column: its samples, their range, and how many are not finite."""
    finite = values[np.isfinite(values)]
    words = f"{len(values)} samples"
    if finite.size:
        words += f", {finite.min():.4g} to {finite.max():.4g}"
    missing = len(values) - len(finite)
    return f"{words}, {missing} not finite" if missing else words


@np.errstate(all="ignore")  # differences of large values may overflow, and are no steps of a clock
def _guess_clock(name: str, values: np.ndarray) -> tuple[float, str] | None:
    """Guess rate and unit of a column that increases as a clock does; its name may have the unit.

    Nine of ten steps are about equal, or, where a clock jitters more, its stamps are near a
    straight line. Repeated stamps are allowed.
    """
    if len(values) < 3 or not np.isfinite(values).all():
        return None
    steps = np.diff(values)
    span = float(values[-1] - values[0])
    if (steps < 0.0).any() or span <= 0.0:
        return None
    step = float(np.median(steps))
    if (np.abs(steps - step) < 0.5 * step).mean() <= 0.9:
        line = np.linspace(values[0], values[-1], len(values))
        if not np.abs(values - line).max() < _OFF_LINE * span:
            return None
        step = span / len(steps)
    guess, named = likely_rate(step), likely_time_unit(name)
    return (1.0 / (step * SECONDS[named]), named) if guess and named else guess
