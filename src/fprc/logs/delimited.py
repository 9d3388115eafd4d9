"""Text tables written by other programs: CSV and similar."""

import csv
import io
import re
from codecs import BOM_UTF16_BE, BOM_UTF16_LE
from collections import Counter
from collections.abc import Iterator, Sequence
from itertools import islice
from pathlib import Path
from typing import NamedTuple

import numpy as np

from fprc.errors import LogError
from fprc.given import read_given
from fprc.logs.decimal_mark import number, numbers_of, parsed
from fprc.logs.variables import Source

#: Largest text file; reading it takes about ten times as much memory.
LARGEST_TEXT_BYTES = 256 << 20
#: Accepted separators and their names; a blank stands for any run of blanks and tabs.
_SEPARATORS = {",": "commas", ";": "semicolons", "\t": "tabs", "|": "bars", " ": "blanks"}
#: Rows used to detect the separator.
_TRIED = 5


class _Text(NamedTuple):
    path: Path
    lines: list[str]
    notes: tuple[str, ...]


class _Row(NamedTuple):
    line: int
    last_line: int
    fields: list[str]


def read_text(
    path: Path,
    *,
    separator: str | None = None,
    decimal: str | None = None,
    header_line: int | None = None,
    data_line: int | None = None,
) -> Source:
    """Read a text table with one header line; fields may be quoted.

    Lines that begin with ``#`` or ``%`` are comments. A separator at the end of a
    line adds no field. A last line without a line end is left out: it may be cut short.

    Parameters
    ----------
    separator, decimal, header_line, data_line
        Format of the file, lines counted from 1; None: detect it.

    Raises
    ------
    LogError
        The file is not text, or too large; lines have more or fewer fields than the
        header; a column name occurs twice.
    """
    text = _text_of(path)
    mark = separator or _separator_of(text, header_line, data_line)
    header, below = _header_and_rows(text, mark, header_line, data_line)
    rows = _matching_rows(path, header, below, mark)
    names = [name.strip() for name in header.fields]
    if header_line is None and all(number(name.replace(",", ".")) is not None for name in names):
        names = [""] * len(names)
        if data_line is None:
            rows.insert(0, header)
    if not rows:
        raise LogError(
            f"{path}: no samples below line {header.last_line}; check csv.header_line, "
            "csv.data_line, that every quotation mark is closed, and that the last line ends in a "
            "line end"
        )
    # separators at the line ends make columns with neither name nor value
    present = [
        k for k, name in enumerate(names) if name or any(row.fields[k].strip() for row in rows)
    ]
    shown = {k: names[k] or str(k) for k in present}
    twice = [name for name, count in Counter(shown.values()).items() if count > 1]
    if twice:
        raise LogError(f"{path}: column {twice[0]}: occurs twice; rename one in the header")
    lines = [row.line for row in rows]
    columns = {name: [row.fields[k] for row in rows] for k, name in shown.items()}
    variables, others = numbers_of(columns, lines, separator=mark, decimal=decimal)
    kind = f"text separated by {_SEPARATORS.get(mark, mark)}"
    return Source(path, kind, variables, others, np.array(lines), text.notes)


def _text_of(path: Path) -> _Text:
    raw = read_given(path, error=LogError, most_bytes=LARGEST_TEXT_BYTES)
    wide = raw.startswith((BOM_UTF16_LE, BOM_UTF16_BE))
    if b"\0" in raw and not wide:
        raise LogError(f"{path}: not a text file; give it the file name ending of its format")
    try:
        text = raw.decode("utf-16" if wide else "utf-8-sig")
    except UnicodeDecodeError:
        text = raw.decode("latin-1")
    lines = list(io.StringIO(text, newline=""))
    while lines and not lines[-1].strip("\r\n"):
        lines.pop()
    if len(lines) < 2 or lines[-1].endswith(("\n", "\r")):
        return _Text(path, lines, ())
    note = f"line {len(lines)}, the last, has no line end and may be cut short; it was left out"
    return _Text(path, lines[:-1], (note,))


def _header_and_rows(
    text: _Text, mark: str, header_line: int | None, data_line: int | None
) -> tuple[_Row, Iterator[_Row]]:
    """Return the header, and an iterator over the rows below it."""
    header = next(_rows(text, header_line or 1, mark, verbatim=header_line is not None), None)
    if header is None or not header.fields:
        raise LogError(
            f"{text.path}: no samples; the file is empty, or csv.header_line is past its end"
        )
    if data_line is not None and data_line <= header.last_line:
        raise LogError(
            f"{text.path}: csv.data_line = {data_line}; must be below the header, which ends on "
            f"line {header.last_line}"
        )
    return header, _rows(text, data_line or header.last_line + 1, mark)


def _rows(text: _Text, first: int, mark: str, *, verbatim: bool = False) -> Iterator[_Row]:
    """Yield the rows from line ``first``; skip comments, and blank lines before the first row.

    If ``verbatim``, the first line is a row even if it is blank or looks like a comment.
    """
    begins = last = first
    between_rows, started = not verbatim, verbatim

    def numbered_lines() -> Iterator[str]:
        nonlocal begins, last, between_rows
        for at, line in enumerate(islice(text.lines, first - 1, None), first):
            if between_rows:
                if line.lstrip().startswith(("#", "%")) or not (started or line.strip()):
                    continue
                begins, between_rows = at, False
            last = at
            # csv.reader takes one separator: replace the tabs outside quotation marks by blanks
            yield re.sub(r'("[^"]*")|\t', lambda m: m[1] or " ", line) if mark == " " else line

    reader = csv.reader(numbered_lines(), delimiter=mark, skipinitialspace=True, strict=True)
    try:
        for fields in reader:
            started = between_rows = True
            yield _Row(begins, last, fields)
    except csv.Error as error:
        raise LogError(
            f"{text.path}: line {begins} cannot be read ({error}); it has an extra quotation "
            "mark, or lacks one"
        ) from error


def _separator_of(text: _Text, header_line: int | None, data_line: int | None) -> str:
    """Return the separator that splits the header and the first rows into equally many fields.

    If several do, it is the one that yields the most numbers; if none does, the one that
    splits the header into the most fields.
    """

    def score(mark: str) -> tuple[bool, float, float]:
        try:
            header, below = _header_and_rows(text, mark, header_line, data_line)
            rows = [_matching_fields(row.fields, header.fields) for row in islice(below, _TRIED)]
        except LogError:  # unbalanced quotation marks, which the right separator can have too
            return (False, 0.0, np.inf)
        width = len(header.fields) - (not header.fields[-1].strip())
        fields = [field for row in rows for field in row or ()]
        plain = mark == "," or width == 1
        known = [parsed(field if plain else field.replace(",", ".")) for field in fields]
        numbers = 1.0 - known.count(None) / max(len(known), 1)
        # a single column that is not all numbers contains another separator
        matches = None not in rows and (width > 1 or numbers == 1.0)
        return (matches, numbers if matches else 0.0, width)

    return max(_SEPARATORS, key=score)


def _matching_fields(fields: list[str], header: Sequence[str]) -> list[str] | None:
    """Return one field per header field; None if there are more or fewer fields."""
    surplus = len(fields) - len(header)
    if surplus == 1 and not fields[-1].strip():
        return fields[:-1]
    if surplus == -1 and not header[-1].strip():
        return [*fields, ""]
    return fields if surplus == 0 else None


def _matching_rows(path: Path, header: _Row, below: Iterator[_Row], mark: str) -> list[_Row]:
    rows, unfit = [], []
    for row in below:
        fields = _matching_fields(row.fields, header.fields)
        if row.last_line > row.line:
            raise LogError(
                f"{path}: a quotation mark on line {row.line} is not closed on that line; close it"
            )
        if fields is None:
            unfit.append(row)
        else:
            rows.append(row._replace(fields=fields))
    if unfit:
        raise LogError(
            f"{path}: the header, line {header.line}, has {len(header.fields)} fields separated by "
            f"{_SEPARATORS.get(mark, mark)}, line {unfit[0].line} has {len(unfit[0].fields)}, and "
            f"{len(unfit) - 1} more lines do not match; repair them, or set csv.separator, "
            "csv.header_line and csv.data_line"
        )
    return rows
