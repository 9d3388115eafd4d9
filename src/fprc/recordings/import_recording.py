"""`fprc import`: draft a map of a recording of another program, or judge it, and make it a raw log.

The limits below were written down before they were run on any recording.
"""

import json
from collections.abc import Mapping, Sequence
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd

from fprc import escape
from fprc.artifacts import refuse_output
from fprc.channels import CHANNELS, TARGETS, unit_of
from fprc.config import Settings
from fprc.config.settings import Quality
from fprc.errors import ConfigError
from fprc.escape import in_words, visible
from fprc.logs import assess
from fprc.logs.columns import Columns
from fprc.logs.quality import runs
from fprc.recordings import importing
from fprc.recordings.clock import Clock, clocks_of, own_clock, rate_of
from fprc.recordings.importing import USUAL, Draft, ImportMap, Recording, read_map
from fprc.recordings.names import factor_of, has, is_time, likely_channel, stated_unit
from fprc.recordings.table import Column, Table, read_table

_quoted = partial(json.dumps, ensure_ascii=False)
#: Largest share of missing values of a column whose samples are left out, not interpolated.
_MISSING = 0.1
#: Range of plausible sample rates, Hz.
LIKELY_HZ = (1.0, 50000.0)
#: Plausible largest magnitude of a channel, by its unit: outside, another unit may be meant.
PLAUSIBLE = {"kPa": (5.0, 1500.0), "deg": (3.3, 400.0)}
#: Smallest span that is possible in the unit of the channel: less is another unit.
LEAST_SPAN = {"kPa": 5.0, "deg": 2.0}
#: Largest share of samples outside the possible range of their channel.
MOST_OUTSIDE = 0.01
#: A channel that does not change for this share of the recording is stuck.
STUCK = 0.5
#: A channel is a copy of another one if a straight line of it, up to half a second late or early,
#: explains more than this share of the variance. A sealed chamber explains less of P_exp; the
#: actuator's own pressure follows its command to 0.999.
COPIES = {("theta", "P_exp"): 0.9999, ("theta", "P_o"): 0.9999, ("P_o", "P_exp"): 0.99}
COPY_LAG_S = 0.5
#: theta explains next to nothing of P_exp: less than this share, with the best of a constant,
#: theta, its square, low-passes and plays.
NEXT_TO_NOTHING = 0.05
#: Rate at which copies and what theta explains are looked for, Hz, at most that of the recording.
_RATE_HZ = 50.0


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
    picture = Path(out).with_suffix(".png")
    refuse_output(out, ".h5", ours=importing.is_imported)
    refuse_output(picture, ".png", ours=lambda old: importing.is_imported(out))
    table = read_table(source, **mapping.csv.model_dump())
    recording = importing.gather(table, mapping)
    quality, target = Settings().quality, mapping.target("measured")
    words, doubts, stops = judge(recording, mapping, table, quality, target)
    mapping = mapping.changed(sample_rate_hz=mapping.sample_rate_hz or 200.0)  # the paper's
    samples = importing.resample(recording, mapping.sample_rate_hz)
    importing.write_log(out, recording, *samples, mapping)
    draw(recording, mapping.notes, picture)
    doubts = [f"doubtful: {line}" for line in (*doubts, *stops)]
    lines = [*words, *doubts, *table.notes, *recording.notes]
    print("\n  ".join([f"{source}:", *lines]))
    print(f"{out}: {len(samples[0])} samples at {mapping.sample_rate_hz:g} Hz, drawn in {picture}")


def draw(recording: Recording, notes: Mapping[str, str], png: Path) -> None:
    """Draw every channel over time, as it was recorded."""
    from fprc.figures import style  # slow to import, and a draft needs none

    frame = pd.DataFrame(recording.channels, recording.time_s)
    titles = [escape.figure(f"{name} {notes.get(name, '')}"[:100]) for name in frame]
    height_in = 0.4 + 0.85 * len(titles)
    fig, axes = style.figure(len(titles), 1, style.PAGE_IN, height_in, sharex=True)
    frame.plot(subplots=True, ax=axes, title=titles, legend=False, color="0.3", linewidth=0.6)
    axes[-1].set(xlabel="Time [s]", xlim=recording.time_s[[0, -1]])
    style.save(fig, {"source": "import"}, str(png))


def draft_map(table: Table, layout: Mapping[str, Any] | None = None) -> str:
    """Return a map of a foreign file in YAML, its channels, units and clock guessed.

    What no column's name identifies is ``?``. Comments describe columns, and say what is doubtful.
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
    # what training FPRC needs, even if no column's name identifies it
    drafted = {"theta_deg", "p_o_kpa"}
    if TARGETS["command"] not in best:
        drafted.add(TARGETS["measured"])
    for channel in CHANNELS:
        if channel.name in best:
            name, *others = best[channel.name]
            used.add(name)
            spec, words = _spec(channel.name, name, columns[name])
            own = own_clock(name, table, clocks)
            if own and own != clock:
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
        lines.append(_line(f"  {channel.name}", spec, words, others[:3]))
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
    about = f"{name} {column.label} {column.unit}"
    air = float(f"{-101.325 / (factor_of(spec['unit'], target) or 1.0):.6g}")  # of the air
    if target == "kPa" and has(about, "absolute"):
        spec |= {"offset": air, "note": "read as absolute"}
        words.append("absolute: better the air's pressure of that day as offset")
    elif target == "kPa" and not has(about, "gauge"):
        words.append(f"gauge? if absolute, add offset: {air:g}")
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
    others = [other for other in clocks if other != name]
    if has(f"{name} {table.columns[name].label}", "time"):
        others = []
    return _line("time", spec, words, others)


def _line(key: str, value: Mapping[str, Any], words: list[str], others: Sequence[str] = ()) -> str:
    if others:
        words = [*words, f"or {in_words(map(_quoted, others), 'or')}?"]
    return f"{key}: {_quoted(value)}  # {'; '.join(words)}"


def _in_words(column: Column) -> str:
    """Describe a column: its label, its samples, their range, and how many are not finite."""
    finite = column.values[np.isfinite(column.values)]
    words = f"{len(column.values)} samples"
    if finite.size:
        words += f", {finite.min():.4g} to {finite.max():.4g}"
    if missing := len(column.values) - len(finite):
        words += f", {missing} not finite"
    return f"{column.label}, {words}" if column.label else words


def judge(
    recording: Recording, mapping: ImportMap, table: Table, limits: Quality, target: str
) -> tuple[list[str], list[str], list[str]]:
    """Return rate and ranges, doubts, and why no answer for ``target`` can be right, in words."""
    time_s, channels = recording.time_s, recording.channels
    rate_hz = rate_of(time_s)
    words = [f"{len(time_s)} samples over {time_s[-1]:.6g} s at {rate_hz:.6g} Hz"]
    about = {"experiment": mapping.experiment, "source": "import", "notes": mapping.notes}
    limits = limits.changed(stuck_s=max(limits.stuck_s, 20.0 / rate_hz))  # slow logs repeat values
    log = Columns(table.path, {"time_s": time_s, **channels}, about)
    checks = assess(log, limits, rate_hz)["checks"]
    del checks["gaps"]  # they are in the notes of the recording
    doubts = [f"{n}: {check['finding']}" for n, check in checks.items() if not check["passed"]]
    stops = []
    needed = {"theta_deg": "theta", TARGETS[target]: "P_exp", "p_o_kpa": "P_o"}
    for name, spec in mapping.columns.items():
        column, quantity, unit = spec["column"], unit_of(name), spec["unit"]
        of, factor, values = table.columns[column], factor_of(unit, quantity) or 1.0, channels[name]
        ends = f"{values.min():.4g} to {values.max():.4g}"
        words.append(f"{name} from {column}: {ends} {'' if unit == '1' else quantity}".rstrip())
        stated = stated_unit(column, of.label, of.unit)
        # a scale, or a note, says that the map is meant as it is
        meant = spec["scale"] != 1.0 or spec["note"] or unit == "1"
        others = other_units(name, unit, values / factor)
        if stated and not meant and (stated.quantity, stated.factor) != (quantity, factor):
            both = f"the file says {stated.text} of {column}, the map {unit}"
            stops.append(f"channels.{name}: {both}: correct unit, or say in note why it is right")
        elif others and spec["scale"] == 1.0:
            doubts.append(f"{name}: its size is unusual; is {column} in {in_words(others, 'or')}?")
        if (outside := checks["range"]["samples"].get(name, 0)) > MOST_OUTSIDE * len(values):
            stops.append(f"{name}: {outside} samples out of range: correct unit, scale or offset")
        if name not in needed:
            continue
        word, span, least = needed[name], float(np.ptp(values)), LEAST_SPAN[quantity]
        if runs(values)[1].max() >= STUCK * len(values):
            stops.append(f"{word} stands still for half of the recording: check it, or cut it off")
        # P_o may span little
        elif word != "P_o" and unit != "1" and span < least:
            less = f"{word} spans {span:.3g} {quantity}, less than {least:g}"
            stops.append(f"{less}: correct its unit or scale, or give unit: 1 and a note")
    if mapping.sample_rate_hz is None and not LIKELY_HZ[0] <= rate_hz <= LIKELY_HZ[1]:
        stops.append(
            f"time: {rate_hz:.4g} Hz are unusual: correct its unit, or give sample_rate_hz"
        )
    return words, doubts, stops


def other_units(channel: str, unit: str, values: np.ndarray) -> list[str]:
    """Return units in which the values are plausible; none if they are in the one given."""
    target = unit_of(channel)
    factor, top = factor_of(unit, target), float(np.nanmax(np.abs(values), initial=0.0))
    if target not in PLAUSIBLE or unit == "1" or factor is None or not 0.0 < top < np.inf:
        return []
    low, high = PLAUSIBLE[target]
    fit = [name for name in USUAL[target] if low <= top * (factor_of(name, target) or 1.0) <= high]
    return [] if low <= top * factor <= high else fit


def unfit(recording: Recording, target: str) -> list[str]:
    """Return why no answer can be right: a channel is a copy, or theta explains next to nothing."""
    from fprc.models import LowpassBank, PlayOperators  # slow to import, and an import needs none

    time_s, stops = recording.time_s, []
    hz = min(rate_of(time_s), _RATE_HZ)
    grid_s, even = np.arange(0.0, time_s[-1], 1.0 / hz), pd.DataFrame()
    lag = int(min(COPY_LAG_S * hz, 0.1 * len(grid_s)))
    for word, name in {"theta": "theta_deg", "P_exp": TARGETS[target], "P_o": "p_o_kpa"}.items():
        even[word] = np.interp(grid_s, time_s, recording.channels[name])
    for (one, other), most in COPIES.items():
        alike = pd.Series([even[one].corr(even[other].shift(k)) ** 2 for k in range(-lag, lag + 1)])
        if alike.max() > most:
            stops.append(f"{one} and {other} are one signal, by a straight line: check the columns")
    X, p_exp = even[["theta"]].to_numpy(), even["P_exp"].to_numpy()
    epsilons = [1.0 - np.exp(-1.0 / (s * hz)) for s in (0.15, 0.5, 1.7)]
    past = [part.fit(X).map_log(X) for part in (LowpassBank(epsilons), PlayOperators())]
    rows = np.hstack([np.ones_like(X), X, X**2, *past])
    left, spread = np.var(p_exp - rows @ np.linalg.lstsq(rows, p_exp)[0]), np.var(p_exp)
    share = 1.0 - left / spread if spread else 0.0
    if share < NEXT_TO_NOTHING:
        stops.append(f"theta explains {100.0 * share:.1f} % of P_exp, next to nothing: check them")
    return stops
