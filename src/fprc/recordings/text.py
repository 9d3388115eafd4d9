"""Text tables written by other programs, and sheets of Excel."""

import csv
import io
import re
from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from contextlib import suppress
from itertools import islice
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd

from fprc.errors import LogError
from fprc.given import read_given
from fprc.recordings.names import KANJI, is_time, is_unit
from fprc.recordings.table import Column, Table

#: Separators that are looked for; a blank stands for any run of blanks and tabs.
_SEPARATORS = ",;\t| "
#: Lines that are looked at to find the separator and the first sample, and lines above it.
_TRIED, _ABOVE = 300, 40
#: Most lines of a table that are no samples, and texts of a column that are no numbers, as a share.
_MOST_ODD = 0.1
#: How a comment begins; ``#DIV/0!`` and the like are values that Excel could not compute.
_COMMENT = re.compile(r"\s*(?:#(?!N/A|NV\b|[A-ZÄÖÜ/0]+[!?])|%|//|sep=)")
#: First field of a line that has the unit of each column.
_UNITS = re.compile(r"(?i)(y_unit_label|units?|einheit(en)?|unit[eéà]s?|unidad|単位|单位)\b.*")
#: What TwinCAT writes before each channel's name, unit and period.
_TWINCAT = {"Name", "Unit", "Data-Type", "SampleTime", "SymbolName", "NetID", "Port", "Offset"}
#: Texts that stand for a missing value, in lower case.
_MISSING = {"", "-nan", "nan", "na", "n/a", "#n/a", "#na", "<na>", "null", "none", "1.#qnan",
            "-1.#ind", "--", "-"}  # fmt: skip
#: Numbers by their decimal mark; before it, the other mark may group thousands, as in 1.234,5.
_NUMBERS = {
    mark: re.compile(
        rf"(?i)[+-]?(?:(?:\d+(?:[{mark}]\d*)?|[{mark}]\d+)(?:[ed][+-]?\d+)?|inf(?:inity)?"
        rf"|\d{{1,3}}(?:[{other}]\d{{3}})+[{mark}]\d+)"
    )
    for mark, other in (".,", ",.")
}
#: A number in which marks may group thousands; no digit before them is a 0.
_GROUPED = re.compile(r"[+-]?[1-9]\d{0,2}([.,]\d{3})+")
_CLOCK_TIME = re.compile(r"(?:\d{1,2}:)?\d{1,2}:\d\d(?:[.,]\d+)?(?:\s*[AaPp][Mm])?")
#: A date, a time of day, or both.
_STAMP = re.compile(
    rf"{_CLOCK_TIME.pattern}|\d{{1,4}}[-/.]\d{{1,2}}[-/.]\d{{1,4}}"
    rf"(?:[T ]+{_CLOCK_TIME.pattern}(?:\s*(?:Z|UTC|[+-]\d\d:?\d\d))?)?"
)
#: A name, its value and perhaps its unit within a line, as ``angle: 12.5 deg``.
_NAMED = re.compile(
    r"(?<!\w)([^\W\d]\w*)\"?\s*[:=]\s*([-+]?(?:\d+[.,]?\d*|[.,]\d+)(?:[eE][-+]?\d+)?)"
    r"(?:\s*([%°]|[^\W\d]+(?:/\w+)?)(?!\w*\s*[:=]))?"
)
#: What a serial monitor writes before each line, or a logger before names and values.
_PREFIX = re.compile(rf"\s*({_STAMP.pattern})(?:\s*->|\s+(?=[^\W\d]\w*\s*[:=]))")


def read_text(path: Path, **layout: Any) -> Table:
    """Read a text table of any layout that has one sample per line.

    Names are those nearest above the first sample, perhaps in a comment. A last line without a
    line end may be cut short and is left out. What ``layout`` has, as ``importing.Csv``, is not
    detected. LogError: it is no text, has no samples, or many lines of another width.
    """
    # reading takes about ten times as much memory
    raw = read_given(path, error=LogError, most_bytes=256 << 20)
    text = raw.decode("latin-1")
    if raw.startswith((b"\xff\xfe", b"\xfe\xff")):
        text = raw.decode("utf-16", errors="replace")
    for code in ("gb18030", "cp932", "utf-8-sig"):  # spreadsheets in China and Japan
        with suppress(UnicodeDecodeError):
            other = raw.decode(code)
            if code == "utf-8-sig" or any(word in other[:4000] for word in KANJI):
                text = other
    lines = {n: line for n, line in enumerate(io.StringIO(text, newline=""), 1) if line.strip()}
    last, notes = max(lines, default=0), []
    if any("\0" in line for line in lines.values()):
        raise LogError(f"{path}: not text, and of no known format; save it as .csv, .mat or .h5")
    if len(lines) > 1 and not lines[last].endswith(("\n", "\r")):
        notes = [f"line {last}, the last, has no line end and may be cut short; it was left out"]
        del lines[last]
    return _table_of(path, lines, notes, **layout)


def read_xlsx(path: Path) -> Table:
    """Read the sheet of an Excel file that has the most rows, with values as they were saved."""
    sheets = pd.read_excel(path, sheet_name=None, header=None, dtype=object, engine="openpyxl")
    title, sheet = max(sheets.items(), key=lambda item: len(item[1]))
    rows = sheet.fillna("").astype(str).replace(r'[\s"]+', " ", regex=True).to_numpy().tolist()
    lines = {n: "\t".join(row) for n, row in enumerate(rows, 1) if any(row)}
    notes = [f"sheet {title} of {len(sheets)} was read"] if len(sheets) > 1 else []
    return _table_of(path, lines, notes, separator="\t", decimal=".")._replace(kind="Excel")


def _table_of(path: Path, lines: dict[int, str], notes: list[str], **layout: Any) -> Table:
    """Return the table in the lines of a text that are not blank."""
    keys = ("separator", "decimal", "header_line", "data_line")
    separator, decimal, header_line, data_line = map(layout.get, keys)
    stamps = {n: found for n, line in lines.items() if (found := _PREFIX.match(line))}
    if 2 * len(stamps) <= len(lines):
        stamps = {}
    lines = lines | {n: lines[n][found.end() :] for n, found in stamps.items()}
    start = data_line or (header_line or 0) + 1
    below = {n: line for n, line in lines.items() if n >= start and not _COMMENT.match(line)}
    marks = [separator] if separator else [mark for mark in _SEPARATORS if mark != decimal]
    fit, mark, width, begin = _locate(below, marks)
    if fit < 0.6 and (worded := _without_words(below)):
        lines, below, header_line = worded, worded, None
        _, mark, width, begin = _locate(below, "\t")
    if not width:
        raise LogError(f"{path}: no samples: no line of numbers below csv.header_line or data_line")
    begin = data_line or begin
    rows: dict[int, list[str]] = {}
    odd: dict[int, str] = {}
    for number, line in below.items():
        fields = _split(line, mark)
        if number < begin or not any(fields):
            continue
        if len(fields) == width + 1 and not fields[-1]:
            fields.pop()
        if len(fields) != width:
            odd[number] = line.strip()[:60]
            if len(fields) > width or not all(map(is_value, fields)):
                continue
            fields = [""] * width  # a sample that was cut keeps its place
        rows[number] = fields
    last = max(rows)
    if len(odd) > _MOST_ODD * len(rows) and (few := min(odd)) < last:
        raise LogError(
            f"{path}: the first sample seems to be line {begin}, with {width} fields; line {few} "
            f"is {odd[few]!r}; lines of another kind in all: {len(odd)}; give in a map, also to "
            f"--draft, where the table begins, as `csv: {{header_line: {max(begin - 1, 1)}, "
            f"data_line: {begin}}}`, or csv.separator"
        )
    if footer := [n for n in odd if n > last]:
        notes.append(f"lines {footer[0]} to {footer[-1]}, below the last sample, were left out")
    above = [(n, line) for n, line in lines.items() if n < begin]
    names, units, about = _header(above[-_ABOVE:][::-1], mark, width, header_line)
    decimal = decimal or about.get("Decimal_Separator", [None])[0]
    if "Delta_X" in about:  # LabVIEW
        units[0] = "s"
        zero, step = (float(about[key][0].replace(",", ".")) for key in ("X0", "Delta_X"))
        for k, fields in enumerate(rows.values()):
            fields[0] = fields[0] or repr(zero + k * step).replace(".", decimal or ".")
    frame = pd.DataFrame([*rows.values()], index=[*rows], columns=names)
    if stamps:
        frame.insert(0, "time", [stamps[n][1] if n in stamps else "" for n in rows])
        units.insert(0, "")
    columns, others, more = _columns_of(frame, units, decimal, mark)
    unusable = tuple(f"line {n}: {line!r}" for n, line in odd.items() if n < last)
    return Table(path, "text", columns, others, (*notes, *more), np.array([*rows]), unusable)


def _split(line: str, mark: str) -> list[str]:
    """Return the fields of a line, which may be in double quotes."""
    if '"' not in line:
        fields = line.split(None if mark == " " else mark)
    else:
        if mark == " ":  # csv.reader takes one separator
            line = re.sub(r'("[^"]*")|\s+', lambda found: found[1] or " ", line.strip())
        (fields,) = csv.reader([line], delimiter=mark, skipinitialspace=True)
    return [field.strip() for field in fields]


def is_value(text: str) -> bool:
    """Return whether a text is a number, a time, or a word for a missing value."""
    return any(p.fullmatch(text) for p in (*_NUMBERS.values(), _STAMP)) or text.lower() in _MISSING


def _locate(lines: Mapping[int, str], marks: Iterable[str]) -> tuple[float, str, int, int]:
    """Return how much is a table (0 to 1), its separator, its width (0: none), its first line."""
    head, best = dict(islice(lines.items(), _TRIED)), (False, 0.0, False, 0, "", 1)
    for mark in marks:
        rows = {n: fields for n, line in head.items() if any(fields := _split(line, mark))}
        kinds = {n: tuple(map(is_value, fields)) for n, fields in rows.items()}
        seen = Counter(k for n, k in kinds.items() if 2 * k.count(False) <= sum(map(bool, rows[n])))
        if not seen:
            continue
        commonest = max(seen, key=lambda kind: (seen[kind], len(kind)))
        width = len(commonest)
        values = {n: np.array(kind) for n, kind in kinds.items() if len(kind) == width}
        first = next(n for n, kind in values.items() if (kind >= np.array(commonest)).all())
        below = [n for n in rows if n >= first]
        share = sum(values[n].sum() for n in below if n in values) / (width * len(below))
        if width > 1 and not any(rows[n][-1] for n in below if n in values):
            width -= 1  # separators end the lines
        # one column may be several with another separator; blanks split wherever tabs do
        best = max(best, (width > 1, share, mark != " ", width, mark, first))
    _, share, _, width, mark, first = best
    return share, mark, width, first


def _without_words(lines: Mapping[int, str]) -> dict[int, str] | None:
    """Return lines that name each number as a table with names and units; None for others."""
    found = {n: _NAMED.findall(line) for n, line in lines.items()}
    labels = {n: tuple(name for name, *_ in parts) for n, parts in found.items()}
    ((names, count),) = Counter(labels.values()).most_common(1) or [((), 0)]
    if not names or 2 * count <= len(found):
        return None
    first = next(n for n in labels if labels[n] == names)
    units = [f"[{unit if is_unit(unit) else '-'}]" for _, _, unit in found[first]]
    table = {first - 2: "\t".join(names), first - 1: "\t".join(units)}
    for n, parts in found.items():
        if n >= first:
            table[n] = "\t".join(part[1] for part in parts) if labels[n] == names else lines[n]
    return table


def _header(
    above: Sequence[tuple[int, str]], mark: str, width: int, header_line: int | None
) -> tuple[list[str], list[str], dict[str, list[str]]]:
    """Return names, units, and fields by the first one of the lines above, nearest first."""
    keys: dict[str, list[str]] = {}
    names, units = list[str](), list[str]()
    for number, line in above:
        fields = _split(line, mark)
        keys.setdefault(fields[0], fields[1:width])
        pairs = {field.partition("[")[0] for field in fields[0:width:2]}
        if len(pairs) == 1 and pairs <= _TWINCAT:
            continue
        if _UNITS.fullmatch(fields[0]) and len(fields) >= width:
            units = ["", *fields[1:width]]
        elif not names and header_line in (None, number):
            names = _names_in(line, mark, width, asked=header_line is not None)
            if names and not units and all(is_unit(name) for name in names if name):
                names, units = [], names
    if not names and "Name" in keys:  # TwinCAT: a time and a value for each channel
        stamp = "".join(re.findall(r"SampleTime\[(.*)\]", " ".join(keys)))
        names = [part for name in keys["Name"][::2] for part in (f"{name} time", name)]
        units = [part for unit in keys.get("Unit", [""] * width)[::2] for part in (stamp, unit)]
    if not names:
        names, units = units or [""] * width, []
    return names, units or [""] * width, keys


def _names_in(line: str, mark: str, width: int, *, asked: bool) -> list[str]:
    """Return the names in a line, one for each column; none if it has not as many."""
    if _COMMENT.match(line):
        line = re.sub(r"^[\s#%/]*(?:\w+:\s+)?", "", line)
    plain = line.replace('"', "").strip()
    for found in (
        _split(line, mark),
        re.split(r"\s*[,;|\t]\s*|\s{2,}", plain),
        re.findall(r"[^\s\[(]+(?:\s*[\[(][^\])]*[\])])?", plain),  # blanks outside of brackets
    ):
        names = [name.strip() for name in found]
        if len(names) == width + 1 and names[-1].lower() in ("", "comment"):
            names.pop()
        some = [name for name in names if name]
        if len(names) == width <= 2 * len(some) and (asked or not any(map(is_value, some))):
            return names
    return fields[:width] if asked and len(fields := _split(line, mark)) > width else []


def _columns_of(
    frame: pd.DataFrame, units: Sequence[str], decimal: str | None, separator: str
) -> tuple[dict[str, Column], dict[str, str], list[str]]:
    """Return the columns of rows of texts, why others are none, and notes."""
    columns: dict[str, Column] = {}
    others: dict[str, str] = {}
    notes: list[str] = []
    decimal = decimal or _decimal_of(frame, separator)
    for k, (name, texts) in enumerate(frame.items()):
        missing = texts.str.lower().isin(_MISSING)
        repeats = [*frame.columns[:k]].count(name) if name else 0
        name = f"{name} ({repeats + 1})" if repeats else name or str(k)
        stamps = _stamps(texts, missing)
        values = _numbers(texts, decimal) if stamps is None else stamps
        bad = texts[np.isnan(values) & ~missing]
        first = f"line {bad.index[0]} holds {bad.iloc[0][:60]!r}, not a number" if len(bad) else ""
        if len(bad) > _MOST_ODD * len(texts):
            doubt = "" if decimal else ", or its mark may group thousands: set csv.decimal"
            others[name] = f"{first}{doubt}"
        elif not np.isfinite(values).any():
            others[name] = "no numbers"
        else:
            columns[name] = Column(values, units[k].strip("[]() -") if stamps is None else "s")
            notes += [f"{name}: {first}; such lines in all: {len(bad)}"] if len(bad) else []
    clocks = [name for name in columns if is_time(name)]
    length = None
    for name, found in columns.items() if len(clocks) > 1 else ():
        if name in clocks:  # between several clocks, columns end with the clock before them
            length = 1 + int(np.flatnonzero(np.isfinite(found.values))[-1])
        columns[name] = found._replace(values=found.values[:length])
    return columns, others, notes


def _numbers(texts: pd.Series, mark: str | None) -> np.ndarray:
    """Return the numbers in texts; NaN for other texts, and without a mark where it matters."""
    if mark is None:
        points, commas = _numbers(texts, "."), _numbers(texts, ",")
        return np.where(points == commas, points, np.nan)
    numbers = texts.where(texts.str.fullmatch(_NUMBERS[mark])).str.lower()
    plain = numbers.str.replace(".,"[mark == "."], "").str.replace(mark, ".").str.replace("d", "e")
    return pd.to_numeric(plain, errors="coerce").to_numpy(np.float64, na_value=np.nan)


def _decimal_of(frame: pd.DataFrame, separator: str) -> str | None:
    """Return the one decimal mark of a table.

    None if numbers contradict each other, or all marks may group thousands, as in 990, 1,000.
    """
    cells = pd.Series(frame.to_numpy().ravel())
    points, commas = (
        cells[cells.str.contains(mark, regex=False) & cells.str.fullmatch(number)]
        for mark, number in _NUMBERS.items()
    )
    mixed = frame.apply(lambda texts: texts.str.isdigit().any() and texts.str.contains(",").any())
    mark, marked = (",", commas) if len(commas) else (".", points)
    usual = (mark == ",") == (separator == ";") and not (mark == "," and mixed.any())
    doubtful = len(marked) and not usual and marked.str.fullmatch(_GROUPED).all()
    return None if doubtful or (len(points) and len(commas)) else mark


def _stamps(texts: pd.Series, missing: pd.Series) -> np.ndarray | None:
    """Return dates as seconds since 1970, or times of day in s; None for other texts."""
    given, days_first = texts[~missing], False
    if given.empty or not given[:50].str.fullmatch(_STAMP).all():
        return None
    if clock := given[:50].str.fullmatch(_CLOCK_TIME).all():  # min:s too
        given = "1970-01-01 " + given.str.replace(r"^(\d+:\d+[.,])", r"0:\1", regex=True)
    elif not re.match(r"\d{4}", given.iloc[0]):
        days_first = "/" not in given.iloc[0] or given.str.match(r"(1[3-9]|[23]\d)/").any()
    found = pd.to_datetime(given, utc=True, errors="coerce", format="mixed", dayfirst=days_first)
    since = (found - pd.Timestamp(0, tz="UTC")) / pd.Timedelta(seconds=1)
    seconds = since.reindex(texts.index).to_numpy()
    midnights = np.append(0, np.cumsum(np.diff(seconds) < -43200.0))
    return seconds + 86400.0 * midnights if clock else seconds
