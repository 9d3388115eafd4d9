"""Text tables written by other programs, and sheets of Excel."""

import csv
import io
import re
from codecs import BOM_UTF16_BE, BOM_UTF16_LE
from collections import Counter
from collections.abc import Callable, Mapping, Sequence
from itertools import islice
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from fprc.errors import LogError
from fprc.given import read_given
from fprc.recordings.grid import STAMP, columns_of, is_value
from fprc.recordings.names import is_unit, known_words
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
#: How a comment begins; ``#DIV/0!`` and the like are values that Excel could not compute.
_COMMENT = re.compile(r"\s*(?:#(?!N/A|NV\b|[A-ZÄÖÜ/0]+[!?])|%|//|sep=)")
#: A name, and the unit behind it, in a header that blanks separate.
_WITH_BRACKET = re.compile(r"[^\s\[(]+(?:\s*[\[(][^\])]*[\])])?")
#: First field of a line that has the unit of each column.
_UNITS = re.compile(r"(?i)(y_unit_label|units?|einheit(en)?|unit[eéà]s?|unidad|単位|单位)\b.*")
#: What TwinCAT writes before each channel's name, unit and period.
_KEYS = {"name", "unit", "data-type", "sampletime", "symbolname", "netid", "port", "offset"}
#: What a serial monitor writes before each line.
_SERIAL = re.compile(r"\s*(\d{1,2}:\d\d:\d\d(?:[.,]\d+)?)\s*->\s*(.*)", re.DOTALL)
#: A name, its value and perhaps its unit within a line, as ``angle: 12.5 deg``.
_NAMED = re.compile(
    r"(?<!\w)([^\W\d]\w*)\"?\s*[:=]\s*([-+]?(?:\d+[.,]?\d*|[.,]\d+)(?:[eE][-+]?\d+)?)"
    r"(?:\s*([%°]|[^\W\d]+(?:/\w+)?)(?!\w*\s*[:=]))?"
)


class Place(NamedTuple):
    """Where a table is."""

    #: Share of the lines and fields that are its values; whether it has names.
    score: tuple[float, bool] = (0.0, False)
    width: int = 0  #: columns; 0: there is no table
    first: int = 1  #: line of the first sample
    names: Sequence[str] = ()  #: empty without names
    units: Sequence[str] = ()


def read_text(path: Path, **layout: Any) -> Table:
    """Read a text table of any layout that has one sample per line.

    Names are taken from the line above the first sample that has one for each column, which may
    be a comment; a line of units below it, LabVIEW's and TwinCAT's headers, and lines such as
    ``angle: 1.2, p: 30`` are understood. Lines that begin with ``#``, ``%``, ``//`` or ``sep=``
    are comments; blank lines are skipped. A last line without a line end is left out: it may be
    cut short. What ``layout`` has, as ``importing.Csv``, is not detected. LogError: the file is no
    text, has no samples, or many lines with more or fewer fields than the first.
    """
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
    numbered = enumerate(io.StringIO(text, newline=""), 1)
    lines = {number: line for number, line in numbered if line.strip()}
    last, notes = max(lines, default=0), []
    if len(lines) > 1 and not lines[last].endswith(("\n", "\r")):
        notes = [f"line {last}, the last, has no line end and may be cut short; it was left out"]
        del lines[last]
    return _table_of(path, lines, notes, **layout)


def read_xlsx(path: Path) -> Table:
    """Read the sheet of an Excel file that has the most rows, with values as they were saved."""
    import pandas as pd

    sheets = pd.read_excel(path, sheet_name=None, header=None, dtype=object, engine="openpyxl")
    title, sheet = max(sheets.items(), key=lambda item: len(item[1]))
    rows = sheet.fillna("").astype(str).replace(r'[\s"]+', " ", regex=True).to_numpy().tolist()
    lines = {n: "\t".join(row) for n, row in enumerate(rows, 1) if any(row)}
    notes = [f"sheet {title} of {len(sheets)} was read"] if len(sheets) > 1 else []
    found = _table_of(path, lines, notes, separator="\t", decimal=".")
    return found._replace(kind="Excel")


def _table_of(
    path: Path,
    lines: Mapping[int, str],
    notes: list[str],
    separator: str | None = None,
    decimal: str | None = None,
    header_line: int | None = None,
    data_line: int | None = None,
) -> Table:
    """Return the table in the lines of a text that are not blank."""
    labview: dict[str, str] = {}
    if next(iter(lines.values()), "").startswith("LabVIEW Measurement"):
        keys = r"(?m)^(X0|Delta_X|Decimal_Separator)[\t,;]([^\t\r\n]+)"
        labview = {"X0": "0", "Delta_X": "1", "Decimal_Separator": "."}
        labview |= dict(re.findall(keys, "".join(islice(lines.values(), 60))))
        decimal = decimal or labview["Decimal_Separator"]
    place, mark, split = _best(lines, separator, decimal, header_line, data_line)
    kind = f"text separated by {_SEPARATORS.get(mark, mark)}"
    if place.score[0] < 0.5 and (worded := _without_words(lines)):
        (lines, *header), kind = worded, "text with a name before each number"
        place, mark, split = _best(lines, "\t", decimal)
        place = Place(*place[:3], *header)
    if not place.width:
        raise LogError(
            f"{path}: no samples; the file has no lines of plain numbers, or csv.header_line or "
            "csv.data_line are past them"
        )
    rows: dict[int, list[str]] = {}
    odd: dict[int, str] = {}
    for number, line in lines.items():
        if number < place.first or _COMMENT.match(line) or not line.strip(" \t\r\n,;|"):
            continue
        fields = split(line)
        if len(fields) == place.width + 1 and not fields[-1]:
            fields.pop()
        if len(fields) != place.width:
            odd[number] = line.strip()[:60]
            if len(fields) > place.width or not all(map(is_value, fields)):
                continue
            fields = [""] * place.width  # a sample that was cut keeps its place
        rows[number] = fields
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
        notes.append(f"lines {footer[0]} to {footer[-1]}, below the last sample, were left out")
    if labview and not any(fields[0] for fields in rows.values()):  # X0 and multiples of Delta_X
        zero, step = (float(labview[key].replace(",", ".")) for key in ("X0", "Delta_X"))
        for k, fields in enumerate(rows.values()):
            fields[0] = repr(zero + k * step).replace(".", decimal or ".")
    names = place.names or [""] * place.width
    columns, others, more = columns_of(names, place.units, rows, decimal, mark)
    unusable = tuple(f"line {n}: {line!r}" for n, line in odd.items() if n < last)
    return Table(path, kind, columns, others, (*notes, *more), np.array([*rows]), unusable)


def _best(
    lines: Mapping[int, str],
    separator: str | None,
    decimal: str | None,
    header_line: int | None = None,
    data_line: int | None = None,
) -> tuple[Place, str, Callable[[str], list[str]]]:
    """Return where a table is, what separates it, and what splits its lines."""
    # the first lines, or those around the header that is given
    start = header_line or max((data_line or 1) - 40, min(lines, default=1))
    head = dict(islice(((n, line) for n, line in lines.items() if n >= start), _TRIED))
    serial = 2 * sum(map(bool, map(_SERIAL.match, head.values()))) > len(head)
    splits = {mark: _splitter(mark, serial) for mark in ([separator] if separator else _SEPARATORS)}
    places = {
        mark: _locate(split, head, header_line, data_line, decimal)
        for mark, split in splits.items()
    }
    # blanks split wherever tabs do
    mark = max(places, key=lambda mark: (*places[mark].score, mark != " ", places[mark].width))
    return places[mark], mark, splits[mark]


def _splitter(mark: str, serial: bool) -> Callable[[str], list[str]]:
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


def _without_words(
    lines: Mapping[int, str],
) -> tuple[dict[int, str], list[str], list[str]] | None:
    """Return lines that name each number as rows of numbers, names and units; None for others."""
    found = {n: _NAMED.findall(line) for n, line in islice(lines.items(), _TRIED)}
    labels = Counter(tuple(part[0] for part in parts) for parts in found.values() if parts)
    names, count = (labels.most_common(1) or [((), 0)])[0]
    if 2 * count <= len(found):
        return None
    first = next(n for n, parts in found.items() if tuple(part[0] for part in parts) == names)
    units = [part[2] for part in found[first]]
    stamped = bool(STAMP.fullmatch(lines[first].split()[0]))
    tabbed = {}
    for n, line in lines.items():
        parts = _NAMED.findall(line)
        same = tuple(part[0] for part in parts) == names
        fields = [*line.split()[:stamped], *(part[1] for part in parts)] if same else [line]
        tabbed[n] = "\t".join(fields)
    return tabbed, ["time"][:stamped] + [*names], [""][:stamped] + units


def _locate(
    split: Callable[[str], list[str]],
    lines: Mapping[int, str],
    header_line: int | None,
    data_line: int | None,
    decimal: str | None,
) -> Place:
    """Find a table in the first lines: the width that most lines of numbers have.

    Comments may hold names, but no samples.
    """
    rows, begin = {n: split(line) for n, line in lines.items()}, data_line or (header_line or 0) + 1
    below = {n: f for n, f in rows.items() if n >= begin and not _COMMENT.match(lines[n])}
    values = {}
    for n, fields in below.items():
        filled = [field for field in fields if field]
        if 2 * sum(map(is_value, filled)) >= len(filled) > 0:
            values[n] = fields
    if not values:
        return Place()
    widths = Counter(map(len, values.values()))
    width = max(widths, key=lambda width: (widths[width], width))
    table = {n: fields for n, fields in values.items() if len(fields) == width}
    later = [*zip(*[*table.values()][len(table) // 2 :], strict=True)]
    counted = [
        k
        for k in range(width)
        if 2 * sum(bool(c) and is_value(c) for c in later[k]) > len(later[k])
    ]
    samples = [n for n, fields in table.items() if all(is_value(fields[k]) for k in counted)]
    first = data_line or min(samples or table)
    table = {n: fields for n, fields in table.items() if n >= first}
    if width > 1 and all(not fields[-1] for fields in table.values()):
        width -= 1
    above = [n for n in rows if n < first and any(rows[n]) and n == (header_line or n)]
    names, units = _header([(rows[n], lines[n]) for n in reversed(above)], width)
    if not names and len(asked := rows.get(header_line or 0, [])) >= width:
        names = asked[:width]  # the caller says so, though they are numbers
    cells = [cell for fields in table.values() for cell in fields[:width]]
    share = sum(map(is_value, cells)) / len(cells)
    if width == 1 and (share < 1.0 or (decimal is None and any("," in cell for cell in cells))):
        return Place()  # it has another separator
    in_table = share * len(table) / sum(any(fields) for n, fields in below.items() if n >= first)
    return Place((round(in_table, 2), bool(names)), width, first, names, units)


def _header(
    above: Sequence[tuple[list[str], str]], width: int
) -> tuple[Sequence[str], Sequence[str]]:
    """Return names and units from fields and lines above the first sample, nearest first."""
    keyed: dict[str, list[str]] = {}
    names: Sequence[str] = ()
    units: Sequence[str] = ()
    for fields, line in above[:40]:
        keys = {key.partition("[")[0].lower() for key in fields[0:width:2]}
        if width % 2 == 0 and len(fields) >= width and len(keys) == 1 and keys <= _KEYS:
            keyed.setdefault(fields[0].lower(), fields[:width])
        elif _UNITS.fullmatch(fields[0]) and len(fields) >= width:
            units = ["", *fields[1:width]]
        elif not names and (found := _names_in(line, fields, width)):
            if not units and all(is_unit(name) for name in found if name):
                units = found
            else:
                names = found
    if "name" in keyed and not names:  # TwinCAT: a time and a value for each channel
        stamp = re.findall(r"sampletime\[(.*)\]", " ".join(keyed)) or [""]
        names = [part for name in keyed["name"][1::2] for part in (f"{name} time", name)]
        units = [part for u in keyed.get("unit", [""] * width)[1::2] for part in (stamp[0], u)]
    if names[:1] == ["X_Value"] and units:  # LabVIEW's clock
        units = ["s", *units[1:]]
    if not names and not all(unit[:1] in ("", "[", "(") for unit in units):
        return units, ()
    return names, units


def _names_in(line: str, fields: list[str], width: int) -> list[str]:
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
            names.pop()
        if len(names) == width - 1 > 1 and line.startswith('"'):
            names = ["", *names]  # R: the row's number has no name
        some = [name for name in names if name]
        if len(names) == width <= 2 * len(some) and not any(map(is_value, some)):
            return names
    return []
