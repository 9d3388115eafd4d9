"""`fprc import`: draft a map of a recording of another program, or make it a raw log."""

import json
from collections.abc import Mapping
from pathlib import Path
from textwrap import shorten
from typing import Any

import numpy as np
import pandas as pd

from fprc import escape
from fprc.artifacts import refuse_output, replacing, sha256
from fprc.channels import CHANNELS, TARGETS, unit_of
from fprc.config import Settings
from fprc.errors import ConfigError, LogError
from fprc.escape import in_words, visible
from fprc.logs import read_columns, write_raw
from fprc.recordings.clock import Clock, clocks_of, own_clock
from fprc.recordings.importing import Draft, ImportMap, Recording, gather, read_map, resample
from fprc.recordings.judge import judge, other_units
from fprc.recordings.names import factor_of, has, is_time, likely_channel, reference_of, stated_unit
from fprc.recordings.table import Column, Table, read_table

#: Rate of a raw log unless its map gives one, Hz.
RATE_HZ = 200.0
#: Channels of a draft even if no column's name identifies them: what training FPRC needs.
_DRAFTED = ("theta_deg", TARGETS["measured"], "p_o_kpa")
#: Largest share of missing values of a column whose samples are left out, not interpolated.
_MISSING = 0.1
#: Pressure of the air, kPa.
AIR_KPA = 101.325


def import_or_draft(
    source: str, *, draft: bool = False, map_: str | None = None, out: str | None = None
) -> None:
    """Turn a recording of another program into a raw log; no file of another program is lost."""
    if draft:
        layout = read_map(map_, Draft).csv.model_dump(exclude_none=True) if map_ else {}
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
    mapping = mapping.changed(sample_rate_hz=mapping.sample_rate_hz or RATE_HZ)
    samples = resample(recording.time_s, recording.channels, mapping.sample_rate_hz, source)
    write_log(out, recording, samples, mapping, source)
    draw_recording(recording, mapping, picture)
    doubts = [f"doubtful: {line}" for line in (*found.doubts, *found.stops)]
    lines = [*found.words, *doubts, *table.notes, *recording.notes]
    print("\n".join([f"{source}:", *(f"  {line}" for line in lines)]))
    rate_hz, count = mapping.sample_rate_hz, len(samples[0])
    print(f"{out}: {count} samples at {rate_hz:g} Hz; beside it its picture, .png")


def write_log(
    raw: Path | str, recording: Recording, samples: tuple[np.ndarray, dict[str, np.ndarray]],
    mapping: ImportMap, source: str,
) -> None:  # fmt: skip
    """Write what was resampled of a recording, times and channels, as a raw log."""
    (time_s, channels), notes = samples, mapping.notes
    if recording.notes:
        notes["time_s"] = "; ".join(recording.notes)
    with replacing(raw) as log:
        write_raw(
            log,
            {"time_s": time_s - time_s[0], **channels},
            experiment=mapping.experiment,
            source="import",
            sample_rate_hz=mapping.sample_rate_hz,
            seed=0,
            rig={},
            imported_from=visible(Path(source).name),
            imported_sha256=sha256(source),
            imported_start_s=recording.start_s + float(time_s[0]),
            map=json.dumps(mapping.model_dump(exclude_none=True)),
            notes=json.dumps(notes),
        )


def is_imported(old: Path | str) -> bool:
    """Return whether a file is a raw log that an import wrote."""
    try:
        return bool(read_columns(old, ()).attributes.get("source") == "import")
    except LogError:
        return False


def draw_recording(recording: Recording, mapping: ImportMap, png: str) -> None:
    """Draw every channel over time, as it was recorded."""
    from fprc.figures import style  # slow to import, and a draft needs none

    titles = []
    for name, spec in mapping.columns.items():
        text = f"{name} from {spec['column']}: {spec['note']}".removesuffix(": ")
        titles.append(escape.figure(shorten(text, 100, placeholder=" ...")))
    count, frame = len(titles), pd.DataFrame(recording.channels, recording.time_s)
    fig, axes = style.figure(count, 1, style.PAGE_IN, 0.4 + 0.85 * count, sharex=True)
    frame.plot(subplots=True, ax=axes, title=titles, legend=False, color="0.3", linewidth=0.6)
    axes[-1].set(xlabel="Time [s]", xlim=recording.time_s[[0, -1]])
    style.save(fig, {"source": "import"}, png)


def draft_map(table: Table, layout: Mapping[str, Any] | None = None) -> str:
    """Return a map of a foreign file in YAML, its channels, units and clock guessed.

    A channel that the workflow needs and no column's name identifies has the column ``?``.
    Comments describe each column, and say what is doubtful.
    """
    columns, clocks = table.columns, clocks_of(table)
    best = _best(table, clocks)
    main = best["theta_deg"][0] if "theta_deg" in best else next(iter(best.values()), [""])[0]
    clock = own_clock(main, table, clocks) if main else next(iter(clocks), None)
    lines = [
        f"# Drafted from the names in {table.path.name}, {table.kind}; check each line; complete "
        "those with a ?, or delete them where the recording has no such channel",
        "experiment: sweep  # for fprc import: or complex",
        _time_line(clock, clocks, table),
        "channels:",
    ]
    missing = {name: ~np.isfinite(column.values) for name, column in columns.items()}
    used, apart = {clock}, set()
    drafted = {name for name in _DRAFTED if name != "p_exp_kpa" or TARGETS["command"] not in best}
    for channel in CHANNELS:
        if channel.name in best:
            name, *others = best[channel.name]
            used.add(name)
            spec, words = _spec(channel.name, name, columns[name])
            own = own_clock(name, table, clocks)
            twin = own and clock and np.array_equal(columns[own].values, columns[clock].values)
            if own and own != clock and not twin:
                spec["time"] = own
            elif clock and name != main and missing[name].mean() > _MISSING:
                spec["time"] = clock
                apart.add(name)
                words.append("time: its samples are interpolated, since others lie between")
        elif channel.name in drafted:
            spec, words = {"column": "?", "unit": unit_of(channel.name)}, [channel.meaning]
            others = best.get("p_exp_kpa", [])[1:] if channel.name == "p_o_kpa" else []
        else:
            continue
        lines.append(_line(f"  {channel.name}", spec, words + _or(others[:3])))
    if layout:
        lines.append(_line("csv", layout, ["as given"]))
    words = []
    if count := len(table.unusable):
        words.append(f"lines that are no samples: {count}: {'; '.join(table.unusable[:3])}")
    for name, gone in missing.items():
        if name in used - apart and gone.sum() > count:
            first = table.sample(int(gone.argmax()))
            words.append(f"{gone.sum()} values of {_quoted(name)}, the first at {first}")
    if words:
        lines.append(f"skip_unusable: true  # leaves out {'; '.join(words)}")
    lines += [f"# {_quoted(n)}: {_in_words(c)}" for n, c in columns.items() if n not in used]
    lines += [f"# {name}: cannot be a channel: {why}" for name, why in table.others.items()]
    return "\n".join(visible(line) for line in (*lines, *(f"# {note}" for note in table.notes)))


def _best(table: Table, clocks: Mapping[str, Clock]) -> dict[str, list[str]]:
    """Return, by channel, the columns whose names fit it, the likeliest first."""
    found: dict[str, dict[str, int]] = {}
    sensors = []
    for name, column in table.columns.items():
        channel, strength = likely_channel(name, column.label, column.unit) or ("", 0)
        named = name not in clocks or (strength >= 2 and not is_time(name))
        if channel and named and len(column.values) >= 3:
            found.setdefault(channel, {})[name] = strength
        elif name not in clocks and has(f"{name} {column.label}", "sensor"):
            sensors.append(name)
    best = {channel: sorted(of, key=of.__getitem__, reverse=True) for channel, of in found.items()}
    return {"p_o_kpa": sensors, **best} if sensors else best


def _spec(channel: str, name: str, column: Column) -> tuple[dict[str, Any], list[str]]:
    """Return the entry of a channel in a map, and in words its values and what is doubtful."""
    unit, target = stated_unit(name, column.label, column.unit), unit_of(channel)
    words = [_in_words(column)]
    if likely_channel(name, column.label, column.unit) is None:  # a sensor of another quantity
        what = f"{column.label or name} [{unit.text if unit else '?'}]"
        words.append("no pressure, so in its own unit; scale it to between 1 and 1000")
        return {"column": name, "unit": "1", "note": what}, words
    spec: dict[str, Any] = {"column": name, "unit": unit.text if unit else target}
    multiple = unit.multiple if unit else 1.0
    others = other_units(channel, spec["unit"], column.values * multiple)
    if unit is None:
        spec["unit"] = [*others, target][0]
        words.append(f"unit? {in_words(others, 'or')} by its size" if others else "unit?")
    elif others:
        words.append(f"unusual in {unit.text}; in {in_words(others, 'or')}?")
    if multiple != 1.0:
        spec["scale"] = multiple
        words.append(f"the name has a factor; delete scale if the numbers are in {spec['unit']}")
    reference = reference_of(f"{name} {column.label} {column.unit}")
    if target == "kPa" and reference != "gauge":
        air = float(f"{-AIR_KPA / (factor_of(spec['unit'], target) or 1.0):.6g}")
        words.append(f"gauge? if absolute, add offset: {air:g}")
        if reference == "absolute":
            spec |= {"offset": air, "note": "read as absolute"}
            words[-1] = "absolute: better the air's pressure of that day as offset"
    return spec, words


def _time_line(name: str | None, clocks: Mapping[str, Clock], table: Table) -> str:
    if name is None:
        counted = [n for n in table.columns if has(n, "count") or has(n, "time")]
        hint = f"; {_quoted(counted[0])} seems to count the samples" if counted else ""
        return _line("time", {"rate_hz": "?"}, [f"or column and unit{hint}"])
    clock, samples = clocks[name], len(table.columns[name].values)
    spec = {"column": name, "unit": clock.unit}
    words = [f"{clock.rate_hz:.5g} Hz", *clock.doubts]
    if clock.repeated:
        spec["repeated"] = "mean" if clock.repeated > 0.1 * samples else "first"
        words.append(f"{clock.repeated} samples repeat a time stamp; first or mean")
    if not has(f"{name} {table.columns[name].label}", "time"):
        words += _or([other for other in clocks if other != name])
    return _line("time", spec, words)


def _or(names: list[str]) -> list[str]:
    return [f"or {in_words(map(_quoted, names), 'or')}?"] if names else []


def _quoted(name: str) -> str:
    return json.dumps(name, ensure_ascii=False)


def _line(key: str, value: Mapping[str, Any], comments: list[str]) -> str:
    return f"{key}: {json.dumps(value, ensure_ascii=False)}  # {'; '.join(comments)}"


def _in_words(column: Column) -> str:
    """Describe a column: its label, its samples, their range, and how many are not finite."""
    finite = column.values[np.isfinite(column.values)]
    words = [f"{len(column.values)} samples"]
    if column.label:
        words.insert(0, column.label)
    if finite.size:
        words.append(f"{finite.min():.4g} to {finite.max():.4g}")
    if missing := len(column.values) - len(finite):
        words.append(f"{missing} not finite")
    return ", ".join(words)
