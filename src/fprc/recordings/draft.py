"""A map guessed from a file, with what is doubtful; and what is doubtful in a map that is given."""

import json
from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np

from fprc.channels import CHANNELS, TARGETS, unit_of
from fprc.escape import in_words, visible
from fprc.recordings.clock import Clock, clocks_of, own_clock
from fprc.recordings.gather import Recording
from fprc.recordings.importing import USUAL, ImportMap
from fprc.recordings.names import (
    Unit,
    factor_of,
    has,
    is_time,
    likely_channel,
    parse_unit,
    reference_of,
    unit_in,
)
from fprc.recordings.table import Column, Table

#: Channels of a draft even if no column's name identifies them: what training FPRC needs.
_DRAFTED = ("theta_deg", TARGETS["measured"], "p_o_kpa")
#: Plausible largest magnitude of a channel, by its unit: outside, another unit may be meant.
PLAUSIBLE = {"kPa": (5.0, 1500.0), "deg": (3.3, 400.0)}
#: Largest share of missing values of a column whose samples are left out, not interpolated.
_MISSING = 0.1
#: Pressure of the air, and what of a pressure at rest may be it, kPa.
AIR_KPA, _AT_REST_KPA = 101.325, (85.0, 110.0)


def stated_unit(name: str, column: Column) -> Unit | None:
    """Return the unit that a file states for a column, beside its name or in it."""
    return parse_unit(column.unit) or unit_in(column.label) or unit_in(name)


def other_units(channel: str, unit: str, values: np.ndarray) -> list[str]:
    """Return units in which the values are plausible; none if they are in the one given."""
    limits = PLAUSIBLE.get(unit_of(channel))
    factor = factor_of(unit, channel)
    top = float(np.nanmax(np.abs(values), initial=0.0))
    if limits is None or unit == "1" or factor is None or not 0.0 < top < np.inf:
        return []
    if limits[0] <= top * factor <= limits[1]:
        return []
    usual = [(name, top * (factor_of(name, channel) or 1.0)) for name in USUAL[unit_of(channel)]]
    return [name for name, value in usual if limits[0] <= value <= limits[1]]


def contradictions(mapping: ImportMap, table: Table) -> dict[str, str]:
    """Say by channel which units of a map are not those that the file states.

    A scale, or a note, says that the map is meant as it is.
    """
    found = {}
    for channel, spec in mapping.channels.model_dump(exclude_none=True).items():
        header = stated_unit(spec["column"], table.pick(spec["column"]))
        as_stated = header and (header.quantity, header.factor)
        meant = spec["scale"] != 1.0 or spec["note"] or spec["unit"] == "1"
        if header and not meant and as_stated != (
            unit_of(channel), factor_of(spec["unit"], channel)
        ):  # fmt: skip
            unlike = f"the file says {header.text} of {spec['column']}, the map {spec['unit']}"
            found[channel] = f"{channel}: {unlike}"
    return found


def doubts(mapping: ImportMap, table: Table, recording: Recording) -> list[str]:
    """Say what a map takes otherwise than the file states it, and what is implausible."""
    found = contradictions(mapping, table)
    for channel, spec in mapping.channels.model_dump(exclude_none=True).items():
        factor, values = factor_of(spec["unit"], channel) or 1.0, recording.channels[channel]
        others = other_units(channel, spec["unit"], values / factor)
        if others and channel not in found and spec["scale"] == 1.0:
            found[channel] = (
                f"{channel}: {_range(values)} {unit_of(channel)} are unusual; is {spec['column']} "
                f"in {in_words(others, 'or')}?"
            )
    return list(found.values())


def draft_map(table: Table, layout: Mapping[str, Any] | None = None) -> str:
    """Return a map of a foreign file in YAML, its channels, units and clock guessed.

    A channel that the workflow needs and no column's name identifies has the column ``?``.
    Comments describe each column, and say what is doubtful.
    """
    clocks = clocks_of(table)
    best = _best(table, clocks)
    main = best["theta_deg"][0] if "theta_deg" in best else next(iter(best.values()), [""])[0]
    clock = own_clock(main, table, clocks) if main else next(iter(clocks), None)
    file = visible(f"{table.path.name}, {table.kind}")
    lines = [
        f"# Drafted from the names in {file}; check each "
        "line; complete those with a ?, or delete them where the recording has no such channel",
        "experiment: sweep  # or complex; instead, for fprc readout: test_from_s, in seconds",
        _time_line(clock, clocks, table),
        "channels:",
    ]
    used, apart = {clock} if clock else set(), set()
    for channel in CHANNELS:
        names = best.get(channel.name, [])
        if names:
            used.add(names[0])
            own = own_clock(names[0], table, clocks)
            spec, words = _spec(channel.name, names[0], table.columns[names[0]])
            if own != clock and own is not None and not _alike(table, own, clock):
                spec["time"] = own
            elif clock and names[0] != main and _missing(table.columns[names[0]]) > _MISSING:
                spec["time"] = clock
                apart.add(names[0])
                words.append("time: its samples are interpolated, since others lie between")
            words += [f"or {in_words(map(_quoted, names[1:4]), 'or')}?"] if names[1:] else []
            lines.append(_line(f"  {channel.name}", spec, "; ".join(words)))
        elif channel.name in _DRAFTED and not (
            channel.name == TARGETS["measured"] and TARGETS["command"] in best
        ):
            free = best.get("p_exp_kpa", [])[1:4] if channel.name == "p_o_kpa" else []
            words = [channel.meaning, *([f"{in_words(map(_quoted, free), 'or')}?"] if free else [])]
            spec = {"column": "?", "unit": channel.unit}
            lines.append(_line(f"  {channel.name}", spec, "; ".join(words)))
    if given := {key: value for key, value in (layout or {}).items() if value is not None}:
        lines.append(_line("csv", given, "as given"))
    lines += _skipped(table, used - apart)
    more = [
        f"{_quoted(name)}: {_in_words(column)}"
        for name, column in table.columns.items()
        if name not in used
    ]
    more += [f"{name}: cannot be a channel: {why}" for name, why in table.others.items()]
    return "\n".join([*lines, *(visible(f"# {text}") for text in (*more, *table.notes))])


def _best(table: Table, clocks: Mapping[str, Clock]) -> dict[str, list[str]]:
    """Return, by channel, the columns whose names fit it, the likeliest first."""
    found: dict[str, list[tuple[int, str]]] = {}
    for name, column in table.columns.items():
        guess = likely_channel(name, column.label, column.unit)
        if guess is None or len(column.values) < 3:
            continue
        if name not in clocks or (guess.strength >= 2 and not is_time(name)):
            found.setdefault(guess.channel, []).append((guess.strength, name))
    best = {
        channel: [name for _, name in sorted(names, key=lambda item: -item[0])]
        for channel, names in found.items()
    }
    free = [
        name
        for name, column in table.columns.items()
        if has(f"{name} {column.label}", "sensor")
        and not any(name in names for names in best.values())
        and name not in clocks
    ]
    return best if "p_o_kpa" in best or not free else {**best, "p_o_kpa": free}


def _spec(channel: str, name: str, column: Column) -> tuple[dict[str, Any], list[str]]:
    """Return the entry of a channel in a map, and in words its values and what is doubtful."""
    unit, target = stated_unit(name, column), unit_of(channel)
    words = [_in_words(column)]
    guess = likely_channel(name, column.label, column.unit)
    if guess is None:  # a sensor of another quantity
        what = f"{column.label or name} [{unit.text if unit else '?'}]"
        as_it_is = {"column": name, "unit": "1", "note": what}
        return as_it_is, [*words, "no pressure, so in its own unit; scale it to between 1 and 1000"]
    spec: dict[str, Any] = {"column": name, "unit": unit.text if unit else target}
    if unit is None:
        others = other_units(channel, target, column.values)
        spec["unit"] = [*others, target][0]
        words.append(f"unit? {in_words(others, 'or')} by its size" if others else "unit?")
    elif others := other_units(channel, unit.text, column.values * unit.multiple):
        words.append(f"unusual in {unit.text}; in {in_words(others, 'or')}?")
    if unit and unit.multiple != 1.0:
        spec["scale"] = unit.multiple
        words.append(f"the name has a factor; delete scale if the numbers are in {unit.text}")
    if target == "kPa":
        words += _reference(spec, channel, f"{name} {column.label} {column.unit}", column)
    return spec, words


def _reference(spec: dict[str, Any], channel: str, name: str, column: Column) -> Iterator[str]:
    """Add the offset of an absolute pressure; ask if the name does not say what it is."""
    factor = factor_of(spec["unit"], channel) or 1.0
    air = float(f"{-AIR_KPA / factor:.6g}")
    reference = reference_of(name)
    if reference == "absolute":
        spec |= {"offset": air, "note": "read as absolute"}
        yield "absolute: better the air's pressure of that day as offset"
    elif reference is None:
        finite = column.values[np.isfinite(column.values)]
        lowest = float(finite.min(initial=np.inf)) * factor * spec.get("scale", 1.0)
        if "command" not in channel and _AT_REST_KPA[0] < lowest < _AT_REST_KPA[1]:
            yield f"absolute? then add offset: {air:g}"
        else:
            yield f"gauge? if absolute, add offset: {air:g}"


def _time_line(name: str | None, clocks: Mapping[str, Clock], table: Table) -> str:
    if name is None:
        counted = [n for n in table.columns if has(n, "count") or has(n, "time")]
        hint = f"; {_quoted(counted[0])} seems to count the samples" if counted else ""
        return _line("time", {"rate_hz": "?"}, f"or column and unit{hint}")
    clock = clocks[name]
    spec = {"column": name, "unit": clock.unit}
    words = [f"{clock.rate_hz:.5g} Hz", *clock.doubts]
    if clock.repeated:
        samples = len(table.columns[name].values)
        spec["repeated"] = "mean" if clock.repeated > 0.1 * samples else "first"
        words.append(f"{clock.repeated} samples repeat a time stamp; first or mean")
        if 2 * clock.repeated > samples:
            each = samples / (samples - clock.repeated)
            words.append(f"or give rate_hz: {each * clock.rate_hz:.4g}, without a column")
    if not has(f"{name} {table.columns[name].label}", "time"):
        others = [_quoted(other) for other in clocks if other != name]
        words += [f"or {in_words(others, 'or')}?"] if others else []
    return _line("time", spec, "; ".join(words))


def _skipped(table: Table, used: set[str]) -> list[str]:
    """Return the line that leaves out what is no sample, if there is any, and says what."""
    missing = {
        name: int(np.sum(~np.isfinite(table.columns[name].values)))
        for name in table.columns
        if name in used and np.sum(~np.isfinite(table.columns[name].values)) > len(table.unusable)
    }
    words = [f"lines that are no samples: {len(table.unusable)}: {'; '.join(table.unusable[:3])}"]
    words = words if table.unusable else []
    for name, count in missing.items():
        first = int(np.argmin(np.isfinite(table.columns[name].values)))
        words.append(f"{count} values of {_quoted(name)}, the first at {table.sample(first)}")
    return [visible(f"skip_unusable: true  # leaves out {'; '.join(words)}")] if words else []


def _missing(column: Column) -> float:
    return float(np.mean(~np.isfinite(column.values)))


def _alike(table: Table, one: str, other: str | None) -> bool:
    return other is not None and np.array_equal(
        table.columns[one].values, table.columns[other].values
    )


def _quoted(name: str) -> str:
    return json.dumps(name, ensure_ascii=False)


def _line(key: str, value: Mapping[str, Any], comment: str) -> str:
    """Return a line of YAML; names are in quotes, with unprintable characters as its escapes."""
    return visible(f"{key}: {json.dumps(value, ensure_ascii=False)}  # {comment}")


def _range(values: np.ndarray) -> str:
    return f"{values.min():.4g} to {values.max():.4g}"


def _in_words(column: Column) -> str:
    """Describe a column: its label, its samples, their range, and how many are not finite."""
    finite = column.values[np.isfinite(column.values)]
    words = f"{column.label}, " if column.label else ""
    words += f"{len(column.values)} samples"
    if finite.size:
        words += f", {_range(finite)}"
    missing = len(column.values) - len(finite)
    return f"{words}, {missing} not finite" if missing else words
