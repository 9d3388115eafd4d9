"""A map guessed from a file, which says line by line what is doubtful."""

import json
from collections.abc import Mapping
from typing import Any

import numpy as np

from fprc.channels import CHANNELS, TARGETS, unit_of
from fprc.escape import in_words, visible
from fprc.recordings.clock import Clock, clocks_of, own_clock
from fprc.recordings.judge import other_units
from fprc.recordings.names import factor_of, has, is_time, likely_channel, reference_of, stated_unit
from fprc.recordings.table import Column, Table

#: Channels of a draft even if no column's name identifies them: what training FPRC needs.
_DRAFTED = ("theta_deg", TARGETS["measured"], "p_o_kpa")
#: Largest share of missing values of a column whose samples are left out, not interpolated.
_MISSING = 0.1
#: Pressure of the air, and what of a pressure at rest may be it, kPa.
AIR_KPA, _AT_REST_KPA = 101.325, (85.0, 110.0)


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
        f"# Drafted from the names in {visible(f'{table.path.name}, {table.kind}')}; check each "
        "line; complete those with a ?, or delete them where the recording has no such channel",
        "experiment: sweep  # for fprc import: or complex",
        _time_line(clock, clocks, table),
        "channels:",
    ]
    missing = {name: ~np.isfinite(column.values) for name, column in columns.items()}
    used, apart = {clock} if clock else set(), set()
    for channel in CHANNELS:
        measured_too = channel.name == TARGETS["measured"] and TARGETS["command"] in best
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
            lines.append(_line(f"  {channel.name}", spec, words + _or(others[:3])))
        elif channel.name in _DRAFTED and not measured_too:
            free = best.get("p_exp_kpa", [])[1:4] if channel.name == "p_o_kpa" else []
            spec = {"column": "?", "unit": channel.unit}
            lines.append(_line(f"  {channel.name}", spec, [channel.meaning, *_or(free)]))
    if given := {key: value for key, value in (layout or {}).items() if value is not None}:
        lines.append(_line("csv", given, ["as given"]))
    words = [f"lines that are no samples: {len(table.unusable)}: {'; '.join(table.unusable[:3])}"]
    words = words * bool(table.unusable) + [
        f"{gone.sum()} values of {_quoted(name)}, the first at {table.sample(int(gone.argmax()))}"
        for name, gone in missing.items()
        if name in used - apart and gone.sum() > len(table.unusable)
    ]
    lines += [f"skip_unusable: true  # leaves out {'; '.join(words)}"] * bool(words)
    lines += [f"# {_quoted(n)}: {_in_words(c)}" for n, c in columns.items() if n not in used]
    lines += [f"# {name}: cannot be a channel: {why}" for name, why in table.others.items()]
    return "\n".join(visible(line) for line in (*lines, *(f"# {note}" for note in table.notes)))


def _best(table: Table, clocks: Mapping[str, Clock]) -> dict[str, list[str]]:
    """Return, by channel, the columns whose names fit it, the likeliest first."""
    found: dict[str, dict[str, int]] = {}
    for name, column in table.columns.items():
        channel, strength = likely_channel(name, column.label, column.unit) or ("", 0)
        named = name not in clocks or (strength >= 2 and not is_time(name))
        if channel and named and len(column.values) >= 3:
            found.setdefault(channel, {})[name] = strength
    best = {channel: sorted(of, key=of.__getitem__, reverse=True) for channel, of in found.items()}
    taken = {*clocks, *(name for names in best.values() for name in names)}
    sensors = [n for n, c in table.columns.items() if has(f"{n} {c.label}", "sensor")]
    free = [name for name in sensors if name not in taken]
    return best if "p_o_kpa" in best or not free else {**best, "p_o_kpa": free}


def _spec(channel: str, name: str, column: Column) -> tuple[dict[str, Any], list[str]]:
    """Return the entry of a channel in a map, and in words its values and what is doubtful."""
    unit, target = stated_unit(name, column.label, column.unit), unit_of(channel)
    words = [_in_words(column)]
    if likely_channel(name, column.label, column.unit) is None:  # a sensor of another quantity
        what = f"{column.label or name} [{unit.text if unit else '?'}]"
        words.append("no pressure, so in its own unit; scale it to between 1 and 1000")
        return {"column": name, "unit": "1", "note": what}, words
    spec: dict[str, Any] = {"column": name, "unit": unit.text if unit else target}
    others = other_units(channel, spec["unit"], column.values * (unit.multiple if unit else 1.0))
    if unit is None:
        spec["unit"] = [*others, target][0]
        words.append(f"unit? {in_words(others, 'or')} by its size" if others else "unit?")
    elif others:
        words.append(f"unusual in {unit.text}; in {in_words(others, 'or')}?")
    if unit and unit.multiple != 1.0:
        spec["scale"] = unit.multiple
        words.append(f"the name has a factor; delete scale if the numbers are in {unit.text}")
    if target != "kPa":
        return spec, words
    factor = factor_of(spec["unit"], target) or 1.0
    air = float(f"{-AIR_KPA / factor:.6g}")
    reference = reference_of(f"{name} {column.label} {column.unit}")
    lowest = float(np.nanmin(column.values)) * factor * spec.get("scale", 1.0)
    if reference == "absolute":
        spec |= {"offset": air, "note": "read as absolute"}
        words.append("absolute: better the air's pressure of that day as offset")
    elif reference is None:
        at_rest = "command" not in channel and _AT_REST_KPA[0] < lowest < _AT_REST_KPA[1]
        words.append(f"{'absolute? then' * at_rest or 'gauge? if absolute,'} add offset: {air:g}")
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
    words = [column.label] * bool(column.label) + [f"{len(column.values)} samples"]
    words += [f"{finite.min():.4g} to {finite.max():.4g}"] * bool(finite.size)
    missing = len(column.values) - len(finite)
    return ", ".join(words + [f"{missing} not finite"] * bool(missing))
