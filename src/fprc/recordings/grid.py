"""Rows of texts become columns: numbers, dates and times of day."""

import re
import warnings
from collections import Counter
from collections.abc import Mapping, Sequence
from contextlib import suppress
from typing import Any

import numpy as np

from fprc.recordings.names import is_time
from fprc.recordings.table import Column, joined_clocks

#: Texts that stand for a missing value, in lower case.
_MISSING = {"", "-nan", "nan", "na", "n/a", "#n/a", "#na", "<na>", "null", "none", "1.#qnan",
            "-1.#ind", "--", "-"}  # fmt: skip
#: With one mark, or with another that groups thousands, as 1.234,5.
_NUMBER = re.compile(
    r"(?i)[+-]?(?:(?:\d+(?:[.,]\d*)?|[.,]\d+)(?:[ed][+-]?\d+)?|inf(?:inity)?"
    r"|\d{1,3}(?:(?:\.\d{3})+,|(?:,\d{3})+\.)\d+)"
)
#: A number in which marks may group thousands; no digit before them is a 0.
_GROUPED = re.compile(r"\s*[+-]?[1-9]\d{0,2}([.,]\d{3})+\s*")
_CLOCK_TIME = re.compile(r"(?:(\d{1,3}):)?(\d{1,3}):(\d\d)(?:[.,:](\d+))?\s*([AaPp][Mm])?")
#: A date, a time of day, or both.
STAMP = re.compile(
    rf"{_CLOCK_TIME.pattern}|\d{{1,4}}[-/.年]\d{{1,2}}[-/.月]\d{{1,4}}日?"
    rf"(?:[T ]+{_CLOCK_TIME.pattern}(?:\s*(?:Z|UTC|[+-]\d\d:?\d\d))?)?"
)
#: Fewest texts that are numbers, as a share, for a column of numbers.
_LEAST_NUMBERS = 0.9


def is_value(text: str) -> bool:
    """Return whether a text is a number, a time, or a word for a missing value."""
    return bool(_NUMBER.fullmatch(text) or STAMP.fullmatch(text)) or text.lower() in _MISSING


def columns_of(
    names: Sequence[str],
    units: Sequence[str],
    rows: Mapping[int, list[str]],
    mark: str | None,
    separator: str,
) -> tuple[dict[str, Column], dict[str, str], list[str]]:
    """Return the columns of rows of texts, why others are none, and notes.

    The decimal ``mark`` is looked for if it is None. Columns without a name have their number.
    """
    lines, seen = list(rows), Counter[str]()
    texts = list(zip(*rows.values(), strict=True)) or [()] * len(names)
    mark = mark or _decimal_of(texts, separator)
    columns: dict[str, Column] = {}
    others: dict[str, str] = {}
    notes: list[str] = []
    kinds: dict[str, str] = {}
    for k, column in enumerate(texts):
        name = names[k] or str(k)
        seen[name] += 1
        name = name if seen[name] == 1 else f"{name} ({seen[name]})"
        unit = units[k].strip("[]() ") if units else ""
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
        day, clock = kinds["date"], kinds["time"]
        total = columns[day].values[0] + columns[clock].values
        columns[f"{day} + {clock}"] = Column(total, "s")
    clocks = [name for name in columns if is_time(name)]
    length = None
    for name, found in columns.items() if len(clocks) > 1 else ():
        if name in clocks:  # between several clocks, columns end with the clock before them
            known = np.flatnonzero(np.isfinite(found.values))
            length = int(known[-1]) + 1 if known.size else 0
        columns[name] = found._replace(values=found.values[:length])
    return columns, others, notes


def _numbers(texts: Sequence[str], mark: str | None) -> tuple[np.ndarray, list[int]]:
    """Return the numbers in texts, NaN for others, and which of them are no numbers."""
    joined = "".join(texts)
    if not re.search(r"[^0-9eE+.\-]", joined) and (mark == "." or "." not in joined):
        with suppress(ValueError):
            return np.array(texts, np.float64), []
    values, bad, other = np.full(len(texts), np.nan), [], ".,"[mark == "."]
    for k, text in enumerate(texts):
        grouped = mark and -1 < text.find(other) < text.find(mark)
        plain = text.replace(other, "") if grouped else text
        if _NUMBER.fullmatch(text) and not set(plain) & set(".,") - {mark}:
            values[k] = float(plain.replace(",", ".").lower().replace("d", "e"))
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
        if len(marks := set(".,") & set("".join(given))) == 1:
            marked.setdefault(marks.pop(), []).extend(given)
    if len(marked) != 1:
        return None if marked else "."
    ((mark, given),) = marked.items()
    usual = mark == "," if separator == ";" else mark == "."
    if all(_GROUPED.fullmatch(text) for text in given if mark in text):
        return mark if usual and (mark == "." or all(mark in text for text in given)) else None
    return mark


def _stamps(texts: Sequence[str]) -> tuple[np.ndarray | None, str]:
    """Return dates as seconds since 1970, or times of day in s, and which of the two they are."""
    given = [text for text in texts[:50] if text.lower() not in _MISSING]
    if not given or not all(map(STAMP.fullmatch, given)):
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
