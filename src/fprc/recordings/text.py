"""Text tables written by other programs."""

import csv
import io
import re
from codecs import BOM_UTF16_BE, BOM_UTF16_LE
from collections import Counter
from collections.abc import Callable
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
    cut short.

    Parameters
    ----------
    separator, decimal, header_line, data_line
        Format of the file, lines counted from 1; None: detect it.

    Raises
    ------
    LogError
        The file is not text, or too large; it has no samples; many lines have more or fewer
        fields than the first sample.
    """
    lines, notes = _lines_of(path)
    labview = _labview(lines)
    decimal = decimal or labview.get("Decimal_Separator")
    if header_line is not None and data_line is not None and data_line <= header_line:
        raise LogError(f"{path}: csv.data_line = {data_line}; must be below {header_line}")
    head = {number: lines[number - 1] for number in _looked_at(lines, header_line, data_line)}
    named = _of_names(list(head.values()))
    tried = dict.fromkeys([separator] if separator else _SEPARATORS)
    serial = sum(map(bool, map(_SERIAL.match, head.values()))) > len(head) / 2
    splits = {mark: _splitter(mark, serial) for mark in tried}
    comments = {number for number, line in head.items() if _is_comment(line)}
    places = {
        mark: locate(head, split, comments, header_line, data_line, decimal)
        for mark, split in splits.items()
    }
    # blanks split wherever tabs do
    mark = max(places, key=lambda mark: (*places[mark].score[:2], mark != " ", places[mark].width))
    place, split = places[mark], splits[mark]
    kind = f"text separated by {_SEPARATORS.get(mark, mark)}"
    if named and place.score[0] < 0.5:
        names, units, split = named
        place = Place((1.0, True, len(names)), len(names), 1, names, units)
        kind = "text with a name before each number"
    if not place.width:
        raise LogError(
            f"{path}: no samples; the file has no lines of numbers, or csv.header_line or "
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
    unusable = tuple(f"line {n}: {line!r}" for n, line in odd.items() if n < last)
    footer = [n for n in odd if n > last]
    if footer:
        notes += (f"lines {footer[0]} to {footer[-1]}, below the last sample, were left out",)
    if labview and not any(fields[0] for fields in rows.values()):  # X0 and multiples of Delta_X
        begin, step = (float(labview[key].replace(",", ".")) for key in ("X0", "Delta_X"))
        for k, fields in enumerate(rows.values()):
            fields[0] = repr(begin + k * step).replace(".", decimal or ".")
    found = columns_of(path, place, rows, decimal, separator=mark)
    return found._replace(kind=kind, notes=(*notes, *found.notes), unusable=unusable)


def _samples(
    lines: list[str], place: Place, split: _Split
) -> tuple[dict[int, list[str]], dict[int, str]]:
    """Return the fields of each line of a table by its number, and the lines that are no samples.

    A sample that was cut keeps its place, without values.
    """
    rows: dict[int, list[str]] = {}
    odd: dict[int, str] = {}
    for number, line in enumerate(islice(lines, place.first - 1, None), place.first):
        if _is_comment(line) or not line.strip(" \t\r\n,;|"):
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


def _labview(lines: list[str]) -> dict[str, str]:
    """Return the header of a LabVIEW measurement file: the first value of each key."""
    if not lines or not lines[0].startswith("LabVIEW Measurement"):
        return {}
    fields = [re.split("[\t,;]", line.strip(), maxsplit=1) for line in lines[:60]]
    found = {parts[0]: parts[1].split("\t")[0] for parts in fields if len(parts) > 1}
    return {"X0": "0", "Delta_X": "1", "Decimal_Separator": ".", **found}


def _looked_at(lines: list[str], header: int | None, data: int | None) -> list[int]:
    """Return the numbers of the first lines, and of the header and the lines below it."""
    begin = min(max(header or 1, data or 1), len(lines) + 1)
    filled = (n for n in range(begin, len(lines) + 1) if lines[n - 1].strip())
    near = range(max(begin - 40, 1), begin)
    above = near if header is None else [header] * (header < begin)
    return [*above, *islice(filled, _TRIED)]


def _is_comment(line: str) -> bool:
    return line.lstrip().startswith(("#", "%", "//", "sep="))


def _lines_of(path: Path) -> tuple[list[str], tuple[str, ...]]:
    """Return the lines of a file, and a note if the last one was left out."""
    raw = read_given(path, error=LogError, most_bytes=LARGEST_TEXT_BYTES)
    wide = raw.startswith((BOM_UTF16_LE, BOM_UTF16_BE)) or raw[1:200:2].count(0) > 80
    if b"\0" in raw and not wide:
        raise LogError(f"{path}: not text, and of no known format; save it as .csv, .mat or .h5")
    lines = list(io.StringIO(_decoded(raw, wide), newline=""))
    while lines and not lines[-1].strip("\r\n"):
        lines.pop()
    if len(lines) < 2 or lines[-1].endswith(("\n", "\r")):
        return lines, ()
    note = f"line {len(lines)}, the last, has no line end and may be cut short; it was left out"
    return lines[:-1], (note,)


def _decoded(raw: bytes, wide: bool) -> str:
    if wide:
        bom = raw.startswith((BOM_UTF16_LE, BOM_UTF16_BE))
        return raw.decode("utf-16" if bom else "utf-16-le", errors="replace")
    try:
        return raw.decode("utf-8-sig")
    except UnicodeDecodeError:
        pass
    for encoding in _ENCODINGS:
        if known_words(raw[:4000].decode(encoding, errors="ignore")):
            return raw.decode(encoding, errors="replace")
    return raw.decode("latin-1")


def _splitter(mark: str, serial: bool) -> _Split:
    """Return what splits a line into fields; fields may be in double quotes."""

    def split(line: str) -> list[str]:
        line = line.rstrip("\r\n")
        if '"' not in line:
            return line.split() if mark == " " else [part.strip() for part in line.split(mark)]
        if mark == " ":  # csv.reader takes one separator
            line = re.sub(r'("[^"]*")|\s+', lambda found: found[1] or " ", line)
        (fields,) = csv.reader([line], delimiter=mark, skipinitialspace=True)
        return [field.strip() for field in fields]

    def split_serial(line: str) -> list[str]:
        found = _SERIAL.match(line)
        if found is None:
            return split(line)
        fields = split(found[2])
        return [found[1] if any(map(is_value, fields)) else "time", *fields]

    csv.field_size_limit(LARGEST_TEXT_BYTES)
    return split_serial if serial else split


def _of_names(lines: list[str]) -> tuple[list[str], list[str], _Split] | None:
    """Return the names and units in lines that name each number, and what splits such lines."""
    found = [_NAMED.findall(line) for line in lines]
    labels = Counter(tuple(part[0] for part in parts) for parts in found if parts)
    if not labels or labels.most_common(1)[0][1] < len(lines) / 2:
        return None
    names = labels.most_common(1)[0][0]
    units = next([p[2] for p in parts] for parts in found if tuple(p[0] for p in parts) == names)
    first = next(line for line, parts in zip(lines, found, strict=True) if parts)
    stamped = is_stamp(first.split()[0])

    def split(line: str) -> list[str]:
        parts = _NAMED.findall(line)
        if tuple(part[0] for part in parts) != names:
            return [line]
        return [*([line.split()[0]] if stamped else []), *(part[1] for part in parts)]

    more = ["time"] if stamped else []
    return [*more, *names], [*([""] if stamped else []), *units], split
