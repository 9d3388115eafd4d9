"""Text tables written by other programs, and sheets of Excel."""

import csv
import io
import re
from codecs import BOM_UTF16_BE, BOM_UTF16_LE
from collections import Counter
from collections.abc import Callable
from datetime import date, time
from itertools import islice
from pathlib import Path

from fprc.errors import LogError
from fprc.given import read_given
from fprc.recordings.grid import Place, columns_of, is_stamp, is_value, locate
from fprc.recordings.names import known_words
from fprc.recordings.table import Table

#: Largest text file; reading it takes about ten times as much memory.
LARGEST_TEXT_BYTES = 256 << 20
#: Accepted separators and their names; a blank stands for any run of blanks and tabs.
_SEPARATORS = {",": "commas", ";": "semicolons", "\t": "tabs", "|": "bars", " ": "blanks"}
#: Lines that are looked at to find the separator and where the table begins.
_TRIED = 300
#: Most lines that are no samples, as a share of the table; more mean that it was misunderstood.
_MOST_UNUSABLE = 0.1
#: Encodings tried if a text is not Unicode: spreadsheets in Japan and China write them.
_ENCODINGS = ("cp932", "gb18030")
#: How a comment begins.
_COMMENT = re.compile(r"\s*(?:#|%|//|sep=)")
#: What a serial monitor writes before each line.
_SERIAL = re.compile(r"\s*(\d{1,2}:\d\d:\d\d(?:[.,]\d+)?)\s*->\s*(.*)", re.DOTALL)
#: A name and its value within a line, as ``angle: 12.5 deg``.
_NAMED = re.compile(
    r"([^\W\d]\w*)\"?\s*[:=]\s*([-+]?(?:\d+[.,]?\d*|[.,]\d+)(?:[eE][-+]?\d+)?)"
    r"(?:\s*([%°]|[^\W\d]+(?:/\w+)?)(?!\w*\s*[:=]))?"
)

_Split = Callable[[str], list[str]]


def read_text(
    path: Path,
    *,
    separator: str | None = None,
    decimal: str | None = None,
    header_line: int | None = None,
    data_line: int | None = None,
) -> Table:
    """Read a text table of any layout that has one sample per line.

    Names are taken from the line above the first sample that has one for each column, which may
    be a comment; a line of units below it, LabVIEW's and TwinCAT's headers, and lines such as
    ``angle: 1.2, p: 30`` are understood. Lines that begin with ``#``, ``%``, ``//`` or ``sep=``
    are comments; blank lines are skipped. A last line without a line end is left out: it may be
    cut short. What the caller gives of the layout, lines counted from 1, is not detected. LogError:
    the file is no text, has no samples, or many lines with more or fewer fields than the first.
    """
    lines, notes = _lines_of(path)
    labview: dict[str, str] = {}
    if lines and lines[0].startswith("LabVIEW Measurement"):
        keys = [re.split("[\t,;]", line.strip(), maxsplit=1) for line in lines[:60]]
        labview = {"X0": "0", "Delta_X": "1", "Decimal_Separator": "."}
        labview |= {pair[0]: pair[1].split("\t")[0] for pair in keys if len(pair) > 1}
        decimal = decimal or labview["Decimal_Separator"]
    # the first lines that are not blank, or those around the header that is given
    start = header_line or max((data_line or 1) - 40, 1)
    filled = ((n, line) for n, line in enumerate(lines[start - 1 :], start) if line.strip())
    head = dict(islice(filled, _TRIED))
    serial = sum(map(bool, map(_SERIAL.match, head.values()))) > len(head) / 2
    comments = {number for number, line in head.items() if _COMMENT.match(line)}
    splits = {mark: _splitter(mark, serial) for mark in ([separator] if separator else _SEPARATORS)}
    places = {
        mark: locate({n: split(line) for n, line in head.items()}, head, comments, header_line,
                     data_line, decimal)
        for mark, split in splits.items()
    }  # fmt: skip
    # blanks split wherever tabs do
    mark = max(places, key=lambda mark: (*places[mark].score, mark != " ", places[mark].width))
    place, split = places[mark], splits[mark]
    kind = f"text separated by {_SEPARATORS.get(mark, mark)}"
    if place.score[0] < 0.5 and (named := _of_names(list(head.values()))):
        place, split = named
        kind = "text with a name before each number"
    if not place.width:
        raise LogError(
            f"{path}: no samples; the file has no lines of plain numbers, or csv.header_line or "
            "csv.data_line are past them"
        )
    rows, odd = _samples(lines, place, split)
    last = max(rows, default=0)
    if len(odd) > _MOST_UNUSABLE * len(rows) and (few := min(odd)) < last:
        raise LogError(
            f"{path}: the first sample seems to be line {place.first}, with {place.width} fields; "
            f"line {few} is {odd[few]!r}; lines of another kind in all: {len(odd)} of "
            f"{len(odd) + len(rows)}; if the table begins elsewhere, say where in a map, as "
            f"`csv: {{header_line: {max(place.first - 1, 1)}, data_line: {place.first}}}`, or give "
            "csv.separator; --draft takes that map too (--map)"
        )
    if footer := [n for n in odd if n > last]:
        notes += (f"lines {footer[0]} to {footer[-1]}, below the last sample, were left out",)
    if labview and not any(fields[0] for fields in rows.values()):  # X0 and multiples of Delta_X
        zero, step = (float(labview[key].replace(",", ".")) for key in ("X0", "Delta_X"))
        for k, fields in enumerate(rows.values()):
            fields[0] = repr(zero + k * step).replace(".", decimal or ".")
    found = columns_of(path, place, rows, decimal, mark)
    unusable = tuple(f"line {n}: {line!r}" for n, line in odd.items() if n < last)
    return found._replace(kind=kind, notes=(*notes, *found.notes), unusable=unusable)


def _samples(
    lines: list[str], place: Place, split: _Split
) -> tuple[dict[int, list[str]], dict[int, str]]:
    """Return the fields of each line of a table by its number, and the lines that are no samples.

    A sample that was cut keeps its place, without values.
    """
    rows: dict[int, list[str]] = {}
    odd: dict[int, str] = {}
    for number, line in enumerate(lines[place.first - 1 :], place.first):
        if _COMMENT.match(line) or not line.strip(" \t\r\n,;|"):
            continue
        parts = split(line)
        fields = place.fitted(parts)
        if fields is None:
            odd[number] = line.strip()[:60]
            if len(parts) < place.width and all(map(is_value, parts)):
                fields = [""] * place.width
        if fields is not None:
            rows[number] = fields
    return rows, odd


def _lines_of(path: Path) -> tuple[list[str], tuple[str, ...]]:
    """Return the lines of a file, and a note if the last one was left out."""
    raw = read_given(path, error=LogError, most_bytes=LARGEST_TEXT_BYTES)
    bom = raw.startswith((BOM_UTF16_LE, BOM_UTF16_BE))
    wide = bom or raw[1:200:2].count(0) > 80
    if b"\0" in raw and not wide:
        raise LogError(f"{path}: not text, and of no known format; save it as .csv, .mat or .h5")
    others = [e for e in _ENCODINGS if known_words(raw[:4000].decode(e, errors="ignore"))]
    code = "utf-16" if bom else "utf-16-le" if wide else "utf-8-sig"
    try:
        text = raw.decode(code)
    except UnicodeDecodeError:
        text = raw.decode(code if wide else [*others, "latin-1"][0], errors="replace")
    lines = list(io.StringIO(text, newline=""))
    while lines and not lines[-1].strip("\r\n"):
        lines.pop()
    if len(lines) < 2 or lines[-1].endswith(("\n", "\r")):
        return lines, ()
    note = f"line {len(lines)}, the last, has no line end and may be cut short; it was left out"
    return lines[:-1], (note,)


def _splitter(mark: str, serial: bool) -> _Split:
    """Return what splits a line into fields; fields may be in double quotes."""
    csv.field_size_limit(LARGEST_TEXT_BYTES)

    def split(line: str) -> list[str]:
        found = _SERIAL.match(line) if serial else None
        line = (found[2] if found else line).rstrip("\r\n")
        if '"' in line:
            if mark == " ":  # csv.reader takes one separator
                line = re.sub(r'("[^"]*")|\s+', lambda found: found[1] or " ", line)
            (fields,) = csv.reader([line], delimiter=mark, skipinitialspace=True)
        else:
            fields = line.split() if mark == " " else line.split(mark)
        fields = [field.strip() for field in fields]
        if not found:
            return fields
        return [found[1] if any(map(is_value, fields)) else "time", *fields]

    return split


def _of_names(lines: list[str]) -> tuple[Place, _Split] | None:
    """Return the place of lines that name each number, and what splits such lines."""
    parts_of = {line: _NAMED.findall(line) for line in lines}
    labels = Counter(tuple(part[0] for part in parts_of[line]) for line in lines)
    names, count = labels.most_common(1)[0] if labels else ((), 0)
    if not names or count < len(lines) / 2:
        return None
    first = next(line for line in lines if tuple(part[0] for part in parts_of[line]) == names)
    stamped = is_stamp(first.split()[0])

    def split(line: str) -> list[str]:
        parts = _NAMED.findall(line)
        if tuple(part[0] for part in parts) != names:
            return [line]
        return [*line.split()[:stamped], *(part[1] for part in parts)]

    units = [part[2] for part in parts_of[first]]
    names_of_all, units = [*["time"][:stamped], *names], [*[""][:stamped], *units]
    return Place((1.0, True), len(names_of_all), 1, names_of_all, units), split


def read_xlsx(path: Path) -> Table:
    """Read the sheet of an Excel file that has the most rows, with values as they were saved."""
    from openpyxl import load_workbook

    with path.open("rb") as file:
        sheets = {
            sheet.title: {
                number: ["" if c is None else c.isoformat() if isinstance(c, date | time)
                         else str(c).strip() for c in row]
                for number, row in enumerate(sheet.iter_rows(values_only=True), 1)
                if any(cell is not None for cell in row)
            }
            for sheet in load_workbook(file, read_only=True, data_only=True).worksheets
        }  # fmt: skip
    title = max(sheets, key=lambda title: len(sheets[title]))
    rows = sheets[title]
    place = locate({number: rows[number] for number in [*rows][:_TRIED]}, {}, decimal=".")
    if not place.width:
        raise LogError(f"{path}: sheet {title}: has no rows of numbers")
    fitted = {number: place.fitted(row) or row[: place.width] for number, row in rows.items()}
    below = {number: row for number, row in fitted.items() if number >= place.first and any(row)}
    found = columns_of(path, place, below, ".")
    notes = (f"sheet {title} of {len(sheets)} was read",) if len(sheets) > 1 else ()
    return found._replace(kind="Excel", notes=(*notes, *found.notes))
