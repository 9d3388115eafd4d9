"""Rows of texts, from a text file or a sheet: where their table begins, and its columns."""

import re
import warnings
from collections import Counter
from collections.abc import Collection, Mapping, Sequence
from contextlib import suppress
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from fprc.recordings.names import is_time, is_unit
from fprc.recordings.table import Column, Table, joined_clocks

#: Texts that stand for a missing value, in lower case.
_MISSING = {"", "-nan", "nan", "na", "n/a", "#n/a", "#na", "<na>", "null", "none", "1.#qnan",
            "-1.#ind", "--", "-"}  # fmt: skip
_NUMBER = re.compile(r"(?i)[+-]?(?:(?:\d+(?:[.,]\d*)?|[.,]\d+)(?:[ed][+-]?\d+)?|inf(?:inity)?)")
#: A number in which marks may group thousands; no digit before them is a 0.
_GROUPED = re.compile(r"\s*[+-]?[1-9]\d{0,2}([.,]\d{3})+\s*")
#: A name, and the unit behind it, in a header that blanks separate.
_WITH_BRACKET = re.compile(r"[^\s\[(]+(?:\s*[\[(][^\])]*[\])])?")
_CLOCK_TIME = re.compile(r"(?:(\d{1,3}):)?(\d{1,3}):(\d\d)(?:[.,:](\d+))?\s*([AaPp][Mm])?")
_STAMP = re.compile(
    rf"{_CLOCK_TIME.pattern}|\d{{1,4}}[-/.年]\d{{1,2}}[-/.月]\d{{1,4}}日?"
    rf"(?:[T ]+{_CLOCK_TIME.pattern}(?:\s*(?:Z|UTC|[+-]\d\d:?\d\d))?)?"
)
#: First field of a line that has the unit of each column.
_UNIT_LINE = re.compile(r"(?:y_unit_label|units?|einheit(?:en)?|unit[eéà]s?|unidad|単位|单位)\b.*",
                        re.IGNORECASE)  # fmt: skip
#: What TwinCAT writes before each channel's name, unit and period.
_KEYS = {"name", "unit", "data-type", "sampletime", "symbolname", "netid", "port", "offset"}
#: Fewest texts that are numbers, as a share, for a column of numbers.
_LEAST_NUMBERS = 0.9


class Place(NamedTuple):
    """Where a table is."""

    #: Share of the lines and fields that are its values; whether it has names.
    score: tuple[float, bool] = (0.0, False)
    width: int = 0  #: columns; 0: there is no table
    first: int = 1  #: line of the first sample
    names: Sequence[str] = ()  #: empty without names
    units: Sequence[str] = ()

    def fitted(self, fields: list[str]) -> list[str] | None:
        """Return one field per column; None if there are more or fewer."""
        surplus = len(fields) - self.width
        if surplus == 1 and not fields[-1]:
            return fields[:-1]
        if surplus == -1 and self.names and not self.names[-1]:
            return [*fields, ""]
        return None if surplus else fields


def locate(
    rows: Mapping[int, list[str]],
    lines: Mapping[int, str],
    comments: Collection[int] = (),
    header_line: int | None = None,
    data_line: int | None = None,
    decimal: str | None = None,
) -> Place:
    """Find a table in the first lines: the width that most lines of numbers have.

    Given are the fields of each line, and the line itself, by their numbers; ``comments`` may hold
    names, but no samples.
    """
    begin = data_line or (header_line or 0) + 1
    below = {n: fields for n, fields in rows.items() if n not in comments and n >= begin}
    values = {n: fields for n, fields in below.items() if _is_sample(fields)}
    if not values:
        return Place()
    widths = Counter(map(len, values.values()))
    width = max(widths, key=lambda width: (widths[width], width))
    table = {n: fields for n, fields in values.items() if len(fields) == width}
    later = [*table.values()][len(table) // 2 :]
    counted = [k for k in range(width) if 2 * sum(_is_number(row[k]) for row in later) > len(later)]
    samples = [n for n, fields in table.items() if all(is_value(fields[k]) for k in counted)]
    first = data_line or min(samples or table)
    table = {n: fields for n, fields in table.items() if n >= first}
    if width > 1 and all(not fields[-1] for fields in table.values()):
        width -= 1
    above = [n for n in sorted(rows, reverse=True) if n < first and any(rows[n])]
    if header_line is not None:
        above = [n for n in above if n == header_line]
    names, units = _header(above, rows, lines, width, header_line is not None)
    cells = [cell for fields in table.values() for cell in fields[:width]]
    share = sum(map(is_value, cells)) / len(cells)
    if width == 1 and (share < 1.0 or (decimal is None and any("," in cell for cell in cells))):
        return Place()  # it has another separator
    in_table = share * len(table) / sum(any(fields) for n, fields in below.items() if n >= first)
    return Place((round(in_table, 2), bool(names)), width, first, names, units)


def _header(
    above: Sequence[int],
    rows: Mapping[int, list[str]],
    lines: Mapping[int, str],
    width: int,
    asked: bool,
) -> tuple[Sequence[str], Sequence[str]]:
    """Return names and units from the lines above the first sample, nearest first."""
    keyed: dict[str, list[str]] = {}
    names: Sequence[str] = ()
    units: Sequence[str] = ()
    for number in above[:40]:
        fields = rows[number]
        keys = {key.partition("[")[0].lower() for key in fields[0:width:2]}
        if width % 2 == 0 and len(fields) >= width and len(keys) == 1 and keys <= _KEYS:
            keyed.setdefault(fields[0].lower(), fields[:width])
        elif _UNIT_LINE.fullmatch(fields[0]) and len(fields) >= width:
            units = ["", *fields[1:width]]
        elif not names and (found := _names_in(lines.get(number, ""), fields, width, asked)):
            if not units and all(is_unit(name) for name in found if name):
                units = found
            else:
                names = found
    if "name" in keyed and not names:  # TwinCAT: a time and a value for each channel
        times = next((key for key in keyed if key.startswith("sampletime[")), "[]")
        stamp = times.partition("[")[2].rstrip("]")
        names = [part for name in keyed["name"][1::2] for part in (f"{name} time", name)]
        units = [part for unit in keyed.get("unit", [""] * width)[1::2] for part in (stamp, unit)]
    if names[:1] == ["X_Value"] and units:  # LabVIEW's clock
        units = ["s", *units[1:]]
    if not names and not all(unit[:1] in ("", "[", "(") for unit in units):
        return units, ()
    return names, units


def _names_in(line: str, fields: list[str], width: int, asked: bool) -> list[str]:
    """Return the names in a line, one for each column; none if it has not as many."""
    stripped = line.strip().lstrip("#%/").strip()
    others = [_WITH_BRACKET.findall(stripped)]
    if re.match(r"\s*(?:#|%|//)", line):
        stripped = re.sub(r"^\w+:\s+", "", stripped)
        others = [re.split(mark, stripped) for mark in (r"\s*[,;|\t]\s*", r"\s{2,}|\t", r"\s+")]
        fields = [fields[0].lstrip("#%/ "), *fields[1:]]
        fields = fields[1:] if not fields[0] and len(fields) == width + 1 else fields
    for found in (fields, *others):
        names = [name.strip() for name in found]
        if len(names) == width + 1 and names[-1].lower() in ("", "comment"):
            names = names[:-1]
        if len(names) == width - 1 > 1 and line.startswith('"') and not asked:
            names = ["", *names]  # R: the row's number has no name
        some = [name for name in names if name]
        if len(names) == width <= 2 * len(some) and (asked or not any(map(is_value, some))):
            return names
    return []


def _is_sample(fields: Sequence[str]) -> bool:
    filled = [field for field in fields if field]
    values = sum(map(is_value, filled))
    return 2 * values >= len(filled) > 0 and values > 0


def _is_number(text: str) -> bool:
    return bool(_NUMBER.fullmatch(text)) or is_stamp(text)


def is_value(text: str) -> bool:
    """Return whether a text is a number, a time, or a word for a missing value."""
    return _is_number(text) or text.lower() in _MISSING


def is_stamp(text: str) -> bool:
    """Return whether a text is a date or a time of day."""
    return bool(_STAMP.fullmatch(text))


def columns_of(
    path: Path, place: Place, rows: Mapping[int, list[str]], mark: str | None, separator: str = ""
) -> Table:
    """Return the columns of a table whose rows have one text for each; None: find the mark."""
    lines, seen = list(rows), Counter[str]()
    texts = list(zip(*rows.values(), strict=True)) or [()] * place.width
    mark = mark or _decimal_of(texts, separator)
    columns: dict[str, Column] = {}
    others: dict[str, str] = {}
    notes: list[str] = []
    kinds: dict[str, str] = {}
    for k, column in enumerate(texts):
        name = (place.names[k] if place.names else "") or str(k)
        seen[name] += 1
        name = name if seen[name] == 1 else f"{name} ({seen[name]})"
        unit = place.units[k].strip("[]() ") if place.units else ""
        if name.isdigit() and not any(column):
            continue  # separators at the line ends make columns with neither name nor value
        values, bad = _numbers(column, mark)
        first = f"line {lines[bad[0]]} holds {column[bad[0]][:60]!r}, not a number" if bad else ""
        if len(bad) > (1.0 - _LEAST_NUMBERS) * len(column):
            stamps, kind = _stamps(column)
            if stamps is None:
                doubt = "" if mark else ", or its mark may group thousands: set csv.decimal"
                others[name] = f"{first}{doubt}"
                continue
            values, bad, unit = stamps, [], "s"
            kinds.setdefault(kind, name)
        if bad:
            notes.append(f"{name}: {first}; such lines in all: {len(bad)}")
        if np.isfinite(values).any():
            columns[name] = Column(values, unit)
        else:
            others[name] = "no numbers"
    columns |= joined_clocks(columns)
    if {"date", "time"} <= kinds.keys():
        day, time = kinds["date"], kinds["time"]
        total = columns[day].values[0] + columns[time].values
        columns[f"{day} + {time}"] = Column(total, "s")
    clocks = [name for name in columns if is_time(name)]
    length = None
    for name, column in columns.items() if len(clocks) > 1 else ():
        if name in clocks:  # between several clocks, columns end with the clock before them
            known = np.flatnonzero(np.isfinite(column.values))
            length = int(known[-1]) + 1 if known.size else 0
        columns[name] = column._replace(values=column.values[:length])
    return Table(path, "", columns, others, tuple(notes), np.array(lines))


def _numbers(texts: Sequence[str], mark: str | None) -> tuple[np.ndarray, list[int]]:
    """Return the numbers in texts, NaN for others, and which of them are no numbers."""
    joined = "".join(texts)
    if not re.search(r"[^0-9eE+.\-]", joined) and (mark == "." or "." not in joined):
        with suppress(ValueError):
            return np.array(texts, np.float64), []
    values, bad = np.full(len(texts), np.nan), []
    for k, text in enumerate(texts):
        if _NUMBER.fullmatch(text) and not set(text) & set(".,") - {mark}:
            values[k] = float(text.replace(",", ".").lower().replace("d", "e"))
        elif text.lower() not in _MISSING:
            bad.append(k)
    return values, bad


def _decimal_of(columns: Sequence[Sequence[str]], separator: str) -> str | None:
    """Return the one decimal mark of a table.

    None if columns contradict each other, or if all marks may group thousands: if there are three
    digits after each, as in 980, 990, 1,000. Columns between semicolons usually have decimal
    commas, others decimal points.
    """
    marked: dict[str, list[str]] = {}  # the texts of columns that are numbers with this mark only
    for texts in columns:
        given = list(filter(_NUMBER.fullmatch, texts))
        for mark, other in (".,", ",."):
            having = [text for text in given if mark in text]
            if having and not any(other in text for text in given):
                marked.setdefault(mark, []).extend(given)
    if len(marked) != 1:
        return None if marked else "."
    ((mark, given),) = marked.items()
    if not all(_GROUPED.fullmatch(text) for text in given if mark in text):
        return mark
    if mark == ".":
        return mark if separator != ";" else None
    return mark if separator == ";" and all(mark in text for text in given) else None


def _stamps(texts: Sequence[str]) -> tuple[np.ndarray | None, str]:
    """Return dates as seconds since 1970, or times of day in s, and which of the two they are."""
    given = [text for text in texts[:50] if text.lower() not in _MISSING]
    if not given or not all(map(is_stamp, given)):
        return None, ""
    if all(map(_CLOCK_TIME.fullmatch, given)):
        times = np.array([_seconds(text) for text in texts])
        midnights = np.append(0, np.cumsum(np.diff(times) < -43200.0))
        return times + 86400.0 * midnights, "time"
    import pandas as pd

    plain = [re.sub(r"[年月]", "-", text).replace("日", "") for text in texts]
    plain = [re.sub(r",(\d+)$", r".\1", text) for text in plain]
    days_first = "/" not in plain[0] or any(re.match(r"(1[3-9]|[23]\d)/", d) for d in plain)
    form: dict[str, Any] = {"format": "mixed", "dayfirst": days_first}
    if re.match(r"\d{4}", plain[0]):
        form = {"format": "ISO8601"}
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        found = pd.to_datetime(pd.Series(plain), utc=True, errors="coerce", **form)
    since = (found - pd.Timestamp(0, tz="UTC")) / pd.Timedelta(seconds=1)
    values = since.to_numpy(np.float64, na_value=np.nan)
    if np.isfinite(values).mean() < _LEAST_NUMBERS:
        return None, ""
    return values, "date" if (values % 86400.0 == 0.0).all() else "stamp"


def _seconds(text: str) -> float:
    found = _CLOCK_TIME.fullmatch(text)
    if found is None:
        return np.nan
    hours, minutes, seconds, fraction, half = found.groups()
    if hours is None and fraction is None:  # h:min
        hours, minutes, seconds = minutes, seconds, "0"
    hour = int(hours or 0) % 12 + 12 * (half.lower() == "pm") if half else int(hours or 0)
    return 3600.0 * hour + 60.0 * int(minutes) + float(f"{seconds}.{fraction or 0}")
