"""Numbers written as text: one decimal mark for all columns of a file."""

import re
from collections.abc import Mapping, Sequence

import numpy as np

#: Texts that stand for a missing value, in lower case.
_MISSING = {"", "-nan", "na", "n/a", "#n/a", "#na", "<na>", "null", "none", "1.#qnan", "-1.#ind"}
#: Name of each decimal mark.
_NAMES = {".": "point", ",": "comma"}
#: A number in which marks may group thousands; no digit before them is a 0.
_GROUPED = re.compile(r"\s*[+-]?[1-9]\d{0,2}(([.,])\d{3})+\s*")


def number(text: str) -> float | None:
    """Return the number that a text is, with a decimal point; None if it is none."""
    try:
        return None if "_" in text else float(text)
    except ValueError:
        return None


def parsed(text: str, mark: str = ".") -> float | None:
    """Return a number; NaN for a missing value; None for another text, or too small a number."""
    value = None if _other(mark) in text else number(text.replace(mark, "."))
    if value is None:
        return np.nan if text.strip().lower() in _MISSING else None
    return None if value == 0.0 and _is_tiny(text) else value


def _other(mark: str) -> str:
    return "," if mark == "." else "."


def _is_tiny(text: str) -> bool:
    """Return whether a text that is read as 0 is another number, such as 1e-400."""
    digits = text.lower().partition("e")[0]
    return any(digit.isdecimal() and int(digit) for digit in digits)


def numbers_of(
    columns: Mapping[str, Sequence[str]],
    lines: Sequence[int],
    *,
    separator: str,
    decimal: str | None,
) -> tuple[dict[str, np.ndarray], dict[str, str]]:
    """Return the numbers of each column that has them, and for each other the reason.

    Without ``decimal``, the mark is found out, the same for the whole file. If columns contradict
    each other, or if all marks may group thousands, no column with a mark has numbers.

    Parameters
    ----------
    columns : Mapping
        Texts by name of the column.
    lines : sequence of int
        Line of each row in the file, for messages.
    separator : str
        Separator of the columns. Programs that write decimal commas separate by semicolons.
    decimal : str or None
        Decimal mark; None: find it out.
    """
    numbers, others = {}, {}
    marked: dict[str, tuple[str, int]] = {}  # mark, and the first row with it
    for name, texts in columns.items():
        values, mark, row = _read(texts, decimal)
        if values is None:
            others[name] = f"line {lines[row]} holds {texts[row]!r}, {_flaw(texts[row], decimal)}"
            continue
        numbers[name] = values
        if mark:
            marked[name] = mark, row
    marks = {mark for mark, _ in marked.values()}
    texts = [text for name in marked for text in columns[name]]
    if decimal or not marks or (len(marks) == 1 and _is_decimal(marks.pop(), texts, separator)):
        return numbers, others
    shown = {
        name: f"line {lines[row]} holds {columns[name][row]!r}, "
        f"{_readings(columns[name][row], mark)}"
        for name, (mark, row) in marked.items()
    }
    for name, (mark, _) in marked.items():
        del numbers[name]
        against = next((each for each, (other, _) in marked.items() if other != mark), None)
        but = "" if against is None else f"; but in column {against}, {shown[against]}"
        others[name] = (
            f"{shown[name]}{but}; set csv.decimal to the file's one decimal mark, and remove marks "
            "between thousands"
        )
    return numbers, others


def _read(texts: Sequence[str], decimal: str | None) -> tuple[np.ndarray | None, str, int]:
    """Return the numbers of a column, its decimal mark, or empty, and the first row with it.

    Instead of the numbers return None, and the first row that is not a number.
    """
    bad = []
    for mark in [decimal] if decimal else _NAMES:
        values = [parsed(text, mark) for text in texts]
        if None not in values:
            array = np.array(values, np.float64)
            with_mark = (
                row for row, text in enumerate(texts) if mark in text and array[row] == array[row]
            )
            row = next(with_mark, -1)
            return array, mark if row >= 0 else "", row
        bad.append(values.index(None))
    return None, "", max(bad)  # with the decimal mark that fails last


def _flaw(text: str, decimal: str | None) -> str:
    """Return why a text is not a number, and what to do."""
    if _is_tiny(text) and number(text.replace(",", ".")) == 0.0:
        return "which is not 0 but too small for a number; correct it, or write 0"
    if decimal and number(text.replace(",", ".")) is not None:
        return (
            f"not a number with csv.decimal = {decimal!r}; correct that, or remove marks between "
            "thousands"
        )
    return "not a number; if the file is right, set csv.decimal or csv.data_line"


def _is_decimal(mark: str, texts: Sequence[str], separator: str) -> bool:
    """Return whether the marks in these texts are decimal marks.

    They may group thousands if there are three digits after each, as in 980, 990, 1,000. Columns
    between semicolons usually have decimal commas, others decimal points.
    """
    if not all(_GROUPED.fullmatch(text) for text in texts if mark in text):
        return True
    if mark == ".":
        return separator != ";"
    plain = (text for text in texts if mark not in text and text.strip().lower() not in _MISSING)
    return separator == ";" and not any(plain)


def _readings(text: str, mark: str) -> str:
    """Return what a text is with its mark as decimal mark, and as mark between thousands."""
    readings = f"{float(text.replace(mark, '.')):.15g} with a decimal {_NAMES[mark]}"
    if _GROUPED.fullmatch(text):
        readings += f" or {float(text.replace(mark, '')):.15g} with {_NAMES[mark]}s for thousands"
    return readings
