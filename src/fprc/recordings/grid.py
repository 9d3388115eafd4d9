"""Rows of texts, from a text file or a sheet: where their table begins, and its columns."""

import re
import warnings
from collections import Counter
from collections.abc import Callable, Collection, Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from fprc.recordings.names import is_time, is_unit
from fprc.recordings.table import Column, Table, joined_clocks

#: Texts that stand for a missing value, in lower case.
_MISSING = {"", "-nan", "nan", "na", "n/a", "#n/a", "#na", "<na>", "null", "none", "1.#qnan",
            "-1.#ind", "--", "-"}  # fmt: skip
_NUMBER = r"[+-]?(?:\d+(?:[.,]\d*)?|[.,]\d+)(?:[eEdD][+-]?\d+)?"
_VALUE = re.compile(rf"(?:{_NUMBER}|[+-]?inf(?:inity)?)", re.IGNORECASE)
#: A number and its unit in one field.
_WITH_UNIT = re.compile(rf"({_NUMBER})\s?([%°]|[^\W\d_]{{1,5}}(?:/\w+)?)")
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

    #: Share of the lines and fields that are its values; whether it has names; its width.
    score: tuple[float, bool, int]
    width: int  #: columns; 0: there is no table
    first: int  #: line of the first sample
    names: list[str]  #: empty without names
    units: list[str]

    def fitted(self, fields: list[str]) -> list[str] | None:
        """Return one field per column; None if there are more or fewer."""
        surplus = len(fields) - self.width
        if surplus == 0:
            return fields
        if surplus == 1 and not fields[-1]:
            return fields[:-1]
        return [*fields, ""] if surplus == -1 and self.names and not self.names[-1] else None


def locate(
    lines: Mapping[int, str],
    split: Callable[[str], list[str]],
    comments: Collection[int],
    header_line: int | None,
    data_line: int | None,
    decimal: str | None,
) -> Place:
    """Find a table in the first lines: the width that most lines of numbers have.

    Parameters
    ----------
    lines : Mapping
        Lines by their numbers.
    split : callable
        What splits a line into fields.
    comments : collection of int
        Numbers of lines that hold no samples, but may hold names.
    """
    rows = {number: split(line) for number, line in lines.items()}
    below = {
        number: fields
        for number, fields in rows.items()
        if number not in comments and number >= (data_line or (header_line or 0) + 1)
    }
    values = {number: fields for number, fields in below.items() if _is_sample(fields)}
    if not values:
        return Place((0.0, False, 0), 0, 1, [], [])
    widths = Counter(map(len, values.values()))
    width = max(widths, key=lambda width: (widths[width], width))
    table = {number: fields for number, fields in values.items() if len(fields) == width}
    later = [*table.values()][len(table) // 2 :]
    counted = [k for k in range(width) if 2 * sum(_is_number(row[k]) for row in later) > len(later)]
    samples = [n for n, fields in table.items() if all(is_value(fields[k]) for k in counted)]
    first = data_line or next(iter(samples), min(table))
    if all(not fields[-1] for fields in table.values()) and width > 1:
        width -= 1
    above = [n for n in sorted(rows, reverse=True) if n < first and any(rows[n])]
    if header_line is not None:
        above = [n for n in above if n == header_line]
    names, units = _header(above, rows, lines, width, header_line is not None)
    cells = [cell for fields in table.values() for cell in fields[:width]]
    share = sum(map(is_value, cells)) / len(cells)
    if width == 1 and (share < 1.0 or (decimal is None and any("," in cell for cell in cells))):
        return Place((0.0, False, 0), 0, 1, [], [])  # it has another separator
    in_table = share * len(table) / sum(map(any, below.values()))
    return Place((round(in_table, 2), bool(names), width), width, first, names, units)


def _header(
    above: Sequence[int],
    rows: Mapping[int, list[str]],
    lines: Mapping[int, str],
    width: int,
    asked: bool,
) -> tuple[list[str], list[str]]:
    """Return names and units from the lines above the first sample, nearest first."""
    keyed: dict[str, list[str]] = {}
    names: list[str] = []
    units: list[str] = []
    for number in above[:40]:
        fields = rows[number]
        keys = {key.partition("[")[0].lower() for key in fields[0:width:2]}
        if width % 2 == 0 and len(fields) >= width and len(keys) == 1 and keys <= _KEYS:
            keyed.setdefault(fields[0].lower(), fields[:width])
            continue
        if _UNIT_LINE.fullmatch(fields[0]) and len(fields) >= width:
            units = ["", *fields[1:width]]
            continue
        if names:
            continue
        found = _names_in(lines[number], fields, width, asked)
        if found and not units and all(is_unit(name) for name in found if name):
            units = found
        elif found:
            names = found
    if "name" in keyed and not names:  # TwinCAT: a time and a value for each channel
        times = next((key for key in keyed if key.startswith("sampletime")), "")
        stamp = re.sub(r".*\[(.*)\].*", r"\1", times) if "[" in times else ""
        channels, of = keyed["name"][1::2], keyed.get("unit", [""] * width)[1::2]
        names = [part for name in channels for part in (f"{name} time", name)]
        units = [part for unit in of for part in (stamp, unit)]
    if names[:1] == ["X_Value"] and units:  # LabVIEW's clock
        units[0] = "s"
    if not names:
        names, units = (units, []) if units and not all(map(_bracketed, units)) else ([], units)
    return names, units


def _bracketed(text: str) -> bool:
    return not text or text[0] in "[("


def _names_in(line: str, fields: list[str], width: int, asked: bool) -> list[str]:
    """Return the names in a line, one for each column; none if it has not as many."""
    stripped = line.strip().lstrip("#%/").strip()
    others: Iterable[list[str]] = (_WITH_BRACKET.findall(stripped),)
    if line.strip()[:1] in "#%/":
        stripped = re.sub(r"^\w+:\s+", "", stripped)
        others = (re.split(mark, stripped) for mark in (r"\s*[,;|\t]\s*", r"\s{2,}|\t", r"\s+"))
        fields = [fields[0].lstrip("#%/ "), *fields[1:]]
        fields = fields[1:] if not fields[0] and len(fields) == width + 1 else fields
    for found in (fields, *others):
        names = [name.strip() for name in found]
        if len(names) == width + 1 and (not names[-1] or names[-1].lower() == "comment"):
            names = names[:-1]
        if len(names) == width - 1 > 1 and line.startswith('"') and not asked:
            names = ["", *names]  # R: the row's number has no name
        some = [name for name in names if name]
        numbers = sum(is_value(name) for name in some)
        if len(names) == width and 2 * len(some) >= width and (asked or not numbers):
            return names
    return []


def _is_sample(fields: Sequence[str]) -> bool:
    filled = [field for field in fields if field]
    values = sum(is_value(field) for field in filled)
    return 2 * values >= len(filled) > 0 and values > 0


def _is_number(text: str) -> bool:
    return bool(_VALUE.fullmatch(text)) or is_stamp(text)


def is_value(text: str) -> bool:
    """Return whether a text is a number, a time, or a word for a missing value."""
    return (
        bool(_VALUE.fullmatch(text) or _WITH_UNIT.fullmatch(text) or is_stamp(text))
        or text.lower() in _MISSING
    )


def is_stamp(text: str) -> bool:
    """Return whether a text is a date or a time of day."""
    return bool(_STAMP.fullmatch(text))


def columns_of(
    path: Path,
    place: Place,
    rows: Mapping[int, list[str]],
    decimal: str | None,
    *,
    separator: str = "",
) -> Table:
    """Return the columns of a table whose rows have one text for each."""
    lines = list(rows)
    texts = list(zip(*rows.values(), strict=True)) or [()] * place.width
    names = _unique(place.names or [str(k) for k in range(place.width)])
    units = [unit.strip("[]() ") for unit in place.units] or [""] * place.width
    mark = decimal or _decimal_of(texts, separator)
    columns: dict[str, Column] = {}
    others: dict[str, str] = {}
    notes: list[str] = []
    kinds: dict[str, str] = {}
    for name, unit, column in zip(names, units, texts, strict=True):
        if name.isdigit() and not any(column):
            continue  # separators at the line ends make columns with neither name nor value
        values, bad, stated = _numbers(column, mark)
        if len(bad) > (1.0 - _LEAST_NUMBERS) * len(column):
            stamps, kinds[name] = _stamps(column)
            if stamps is None:
                doubt = "" if mark else ", or its mark may group thousands: set csv.decimal"
                row = bad[0]
                others[name] = f"line {lines[row]} holds {column[row][:60]!r}, not a number{doubt}"
                continue
            values, bad, unit = stamps, [], "s"
        if bad:
            notes.append(
                f"{name}: line {lines[bad[0]]} holds {column[bad[0]][:60]!r}, not a number; "
                f"such lines in all: {len(bad)}"
            )
        if np.isfinite(values).any():
            columns[name] = Column(values, unit or stated)
        else:
            others[name] = "no numbers"
    columns |= joined_clocks(columns) | _of_two(columns, kinds)
    return Table(path, "", _own_lengths(columns), others, tuple(notes), np.array(lines))


def _unique(names: Sequence[str]) -> list[str]:
    """Return names without repeats; a column without a name has its number."""
    seen: Counter[str] = Counter()
    unique = []
    for k, name in enumerate(names):
        name = name or str(k)
        seen[name] += 1
        unique.append(name if seen[name] == 1 else f"{name} ({seen[name]})")
    return unique


def _own_lengths(columns: dict[str, Column]) -> dict[str, Column]:
    """Cut columns between several clocks, each at the last stamp of the clock before it."""
    if sum(is_time(name) for name in columns) < 2:
        return columns
    cut, length = {}, None
    for name, column in columns.items():
        if is_time(name):
            known = np.flatnonzero(np.isfinite(column.values))
            length = int(known[-1]) + 1 if known.size else 0
        cut[name] = column._replace(values=column.values[:length])
    return cut


def _numbers(texts: Sequence[str], decimal: str | None) -> tuple[np.ndarray, list[int], str]:
    """Return the numbers in texts, NaN for others; which are no numbers; the unit beside them."""
    joined = "".join(texts)
    plain = not re.search(r"[^0-9eE+.\-]", joined) and "" not in texts
    if plain and (decimal == "." or "." not in joined):
        try:
            return np.array(texts, np.float64), [], ""
        except ValueError:
            pass
    values = [_number(text, decimal) for text in texts]
    bad = [k for k, value in enumerate(values) if value is None]
    if len(bad) > len(texts) // 2:
        with_units = [_WITH_UNIT.fullmatch(text) for text in texts]
        units = {found[2] for found in with_units if found}
        if len(units) == 1 and is_unit(*units):
            parts = [
                found[1] if found else text for found, text in zip(with_units, texts, strict=True)
            ]
            return (*_numbers(parts, decimal)[:2], units.pop())
    return np.array([np.nan if value is None else value for value in values]), bad, ""


def _number(text: str, decimal: str | None) -> float | None:
    """Return a number with this decimal mark, or with none; NaN for a missing value."""
    if text.lower() in _MISSING:
        return np.nan
    if not _VALUE.fullmatch(text) or (decimal != "." and "." in text):
        return None
    if "," in text and decimal != ",":
        return None
    return float(text.replace(",", ".").lower().replace("d", "e"))


def _decimal_of(columns: Iterable[Sequence[str]], separator: str) -> str | None:
    """Return the one decimal mark of a table.

    None if columns contradict each other, or if all marks may group thousands: if there are three
    digits after each, as in 980, 990, 1,000. Columns between semicolons usually have decimal
    commas, others decimal points.
    """
    marked: dict[str, list[str]] = {}  # the texts of columns that are numbers with this mark only
    for texts in columns:
        given = [text for text in texts if _VALUE.fullmatch(text) or _WITH_UNIT.fullmatch(text)]
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
        return _unwrapped(np.array([_seconds(text) for text in texts])), "time"
    import pandas as pd

    plain = [re.sub(r"[年月]", "-", text).replace("日", "") for text in texts]
    plain = [re.sub(r",(\d+)$", r".\1", text) for text in plain]
    form: dict[str, Any] = {"format": "ISO8601"}
    if not re.match(r"\d{4}", plain[0]):
        days_first = "/" not in plain[0] or any(re.match(r"(1[3-9]|[23]\d)/", d) for d in plain)
        form = {"format": "mixed", "dayfirst": days_first}
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
    hour = int(hours or 0) % 12 + 12 * (half.lower() == "pm") if half else int(hours or 0)
    if hours is None and fraction is None:  # h:min
        return 3600.0 * int(minutes) + 60.0 * int(seconds)
    return 3600.0 * hour + 60.0 * int(minutes) + float(f"{seconds}.{fraction or 0}")


def _unwrapped(times: np.ndarray) -> np.ndarray:
    """Return times of day that go on after midnight."""
    return times + 86400.0 * np.append(0, np.cumsum(np.diff(times) < -43200.0))


def _of_two(columns: Mapping[str, Column], kinds: Mapping[str, str]) -> dict[str, Column]:
    """Return the sum of a column of dates and one of times of day, if a table has both."""
    date = next((name for name, kind in kinds.items() if kind == "date"), None)
    time = next((name for name, kind in kinds.items() if kind == "time"), None)
    if date is None or time is None:
        return {}
    total = columns[date].values[0] + columns[time].values
    return {f"{date} + {time}": Column(total, "s")}
