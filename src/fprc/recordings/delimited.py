"""Text tables written by other programs: CSV and similar."""

import csv
import io
import re
from codecs import BOM_UTF16_BE, BOM_UTF16_LE
from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from itertools import dropwhile, islice
from pathlib import Path

import numpy as np

from fprc.errors import LogError
from fprc.given import read_given
from fprc.recordings.source import Source

#: Largest text file; reading it takes about ten times as much memory.
LARGEST_TEXT_BYTES = 256 << 20
#: Accepted separators and their names; a blank stands for any run of blanks and tabs.
_SEPARATORS = {",": "commas", ";": "semicolons", "\t": "tabs", "|": "bars", " ": "blanks"}
#: Rows used to detect the separator.
_TRIED = 5
#: Texts that stand for a missing value, in lower case.
_MISSING = {"", "-nan", "na", "n/a", "#n/a", "#na", "<na>", "null", "none", "1.#qnan", "-1.#ind"}
#: A number in which marks may group thousands; no digit before them is a 0.
_GROUPED = re.compile(r"\s*[+-]?[1-9]\d{0,2}([.,]\d{3})+\s*")


def read_text(
    path: Path,
    *,
    separator: str | None = None,
    decimal: str | None = None,
    header_line: int | None = None,
    data_line: int | None = None,
) -> Source:
    """Read a text table with one line of names and one line per row; fields may be quoted.

    Lines that begin with ``#``, ``%``, or ``sep=``, which spreadsheets write, are comments. A
    separator at the end of a line adds no field. A last line without a line end is left out: it
    may be cut short.

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
    lines, notes = _lines_of(path)
    content = {
        number: line
        for number, line in enumerate(lines, 1)
        if number == header_line or not line.lstrip().startswith(("#", "%", "sep="))
    }
    top = header_line or next((number for number, line in content.items() if line.strip()), 0)
    if not content.get(top, "").strip("\r\n"):
        raise LogError(
            f"{path}: no samples; the file is empty, or csv.header_line is a blank line or past "
            "its end"
        )
    if data_line is not None and data_line <= top:
        raise LogError(f"{path}: csv.data_line = {data_line}; must be below the header, line {top}")
    below = ((number, line) for number, line in content.items() if number >= (data_line or top + 1))
    body = dict(dropwhile(lambda row: not row[1].strip(), below))
    text = {top: content[top], **body}
    delimiter = separator or _separator_of(path, dict(islice(text.items(), 1 + _TRIED)))
    names, *rows = _split(path, text, delimiter)
    numbers = list(body)
    fitted = [_fitted(fields, names) for fields in rows]
    unfit = [k for k, fields in enumerate(fitted) if fields is None]
    if unfit:
        raise LogError(
            f"{path}: the header has {len(names)} fields separated by "
            f"{_SEPARATORS.get(delimiter, delimiter)}, line {numbers[unfit[0]]} has "
            f"{len(rows[unfit[0]])}; lines that do not match in all: {len(unfit)}; repair them, or "
            "say in a map where the table begins, as `csv: {header_line: 4, data_line: 6}`, or "
            "csv.separator; --draft takes that map too (--map)"
        )
    table = [fields for fields in fitted if fields is not None]
    if header_line is None and all(_is_number(name) and not _is_missing(name) for name in names):
        if data_line is None:
            table, numbers = [names, *table], [top, *numbers]
        names = [""] * len(names)
    columns = _columns_of(path, names, table) if table else {}
    if not columns:
        raise LogError(
            f"{path}: no samples below line {top}; check csv.header_line, "
            "csv.data_line, and that the last line ends in a line end"
        )
    decimal = decimal or _decimal_of(columns.values(), delimiter)
    usable, others = _numbers_of(columns, numbers, decimal)
    kind = f"text separated by {_SEPARATORS.get(delimiter, delimiter)}"
    return Source(path, kind, usable, others, np.array(numbers), notes)


def _lines_of(path: Path) -> tuple[list[str], tuple[str, ...]]:
    """Return the lines of a file, and a note if the last one was left out."""
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
        return lines, ()
    note = f"line {len(lines)}, the last, has no line end and may be cut short; it was left out"
    return lines[:-1], (note,)


def _split(path: Path, text: Mapping[int, str], delimiter: str) -> list[list[str]]:
    """Return the fields of each line; the lines are given by their numbers."""
    lines: Iterable[str] = text.values()
    if delimiter == " ":  # csv.reader takes one separator: replace the tabs outside quotation marks
        lines = (re.sub(r'("[^"]*")|\t', lambda found: found[1] or " ", line) for line in lines)
    reader = csv.reader(lines, delimiter=delimiter, skipinitialspace=True, strict=True)
    rows: list[list[str]] = []
    try:
        for fields in reader:
            if reader.line_num > len(rows) + 1:
                raise csv.Error("a quotation mark is not closed on that line")
            rows.append(fields)
    except csv.Error as error:
        number = list(text)[len(rows)]
        raise LogError(
            f"{path}: line {number} cannot be read ({error}); repair it, or set csv.separator"
        ) from error
    return rows


def _fitted(fields: list[str], header: Sequence[str]) -> list[str] | None:
    """Return one field per header field; None if there are more or fewer fields."""
    surplus = len(fields) - len(header)
    if surplus == 1 and not fields[-1].strip():
        return fields[:-1]
    if surplus == -1 and not header[-1].strip():
        return [*fields, ""]
    return fields if surplus == 0 else None


def _separator_of(path: Path, text: Mapping[int, str]) -> str:
    """Return the separator that splits the header and the first rows into equally many fields.

    If several do, it is the one that yields the most numbers; if none does, the one that
    splits the header into the most fields.
    """

    def score(delimiter: str) -> tuple[bool, float, float]:
        try:
            names, *split = _split(path, text, delimiter)
        except LogError:  # a flawed line, which the right separator can have too
            return (False, 0.0, np.inf)
        rows = [_fitted(fields, names) for fields in split]
        width = len(names) - (not names[-1].strip())
        fields = [field for row in rows for field in row or ()]
        # a single column that is not all numbers contains another separator
        decimals = "." if delimiter == "," or width == 1 else ".,"
        numbers = sum(_is_number(field, decimals) for field in fields) / max(len(fields), 1)
        matches = None not in rows and (width > 1 or numbers == 1.0)
        return (matches, numbers if matches else 0.0, width)

    return max(_SEPARATORS, key=score)


def _columns_of(
    path: Path, names: Sequence[str], table: Sequence[Sequence[str]]
) -> dict[str, tuple[str, ...]]:
    """Return the texts of each column by its name, or by its number if it has none."""
    columns = [
        (name.strip() or str(k), texts)
        for k, (name, texts) in enumerate(zip(names, zip(*table, strict=True), strict=True))
        # separators at the line ends make columns with neither name nor value
        if name.strip() or any(map(str.strip, texts))
    ]
    twice = [name for name, count in Counter(name for name, _ in columns).items() if count > 1]
    if twice:
        raise LogError(f"{path}: column {twice[0]}: occurs twice; rename one in the header")
    return dict(columns)


def _number(text: str, decimal: str | None) -> float | None:
    """Return a number with this decimal mark, or with none; NaN for a missing value.

    None for another text, and for a number that a float cannot tell from 0, such as 1e-400.
    """
    if _is_missing(text):
        return np.nan
    if "_" in text or (decimal != "." and "." in text):
        return None
    try:
        value = float(text.replace(",", ".") if decimal == "," else text)
    except ValueError:
        return None
    return None if value == 0.0 and re.search("[1-9]", text.lower().partition("e")[0]) else value


def _is_missing(text: str) -> bool:
    return text.strip().lower() in _MISSING


def _is_number(text: str, decimals: str = ".,") -> bool:
    return any(_number(text, decimal) is not None for decimal in decimals)


def _numbers_of(
    columns: Mapping[str, Sequence[str]], lines: Sequence[int], decimal: str | None
) -> tuple[dict[str, np.ndarray], dict[str, str]]:
    """Return the numbers of each column that has them, and for each other the reason."""
    numbers, others = {}, {}
    doubt = "" if decimal else ", or its mark may group thousands"
    for name, texts in columns.items():
        values = [_number(text, decimal) for text in texts]
        if None not in values:
            numbers[name] = np.array(values, np.float64)
            continue
        row = values.index(None)
        others[name] = (
            f"line {lines[row]} holds {texts[row]!r}, not a number{doubt}; if the file is right, "
            "set csv.decimal or csv.data_line, remove marks between thousands, and write dates as "
            "seconds"
        )
    return numbers, others


def _decimal_of(columns: Iterable[Sequence[str]], separator: str) -> str | None:
    """Return the one decimal mark of a file.

    None if columns contradict each other, or if all marks may group thousands: if there are three
    digits after each, as in 980, 990, 1,000. Columns between semicolons usually have decimal
    commas, others decimal points.
    """
    marked: dict[str, list[str]] = {}  # the texts of columns that are numbers with this mark only
    for texts in columns:
        given = [text for text in texts if not _is_missing(text)]
        for mark in (mark for mark in ".," if any(mark in text for text in given)):
            if all(_is_number(text, mark) for text in given):
                marked.setdefault(mark, []).extend(given)
    if len(marked) != 1:
        return None if marked else "."
    ((mark, given),) = marked.items()
    if not all(_GROUPED.fullmatch(text) for text in given if mark in text):
        return mark
    if mark == ".":
        return mark if separator != ";" else None
    return mark if separator == ";" and all(mark in text for text in given) else None
