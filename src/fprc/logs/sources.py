"""Files of other programs as named arrays: CSV, HDF5, MATLAB."""

import difflib
import io
import re
import warnings
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any, NamedTuple

import h5py
import numpy as np
import pandas as pd
import scipy.io

from fprc.errors import LogError
from fprc.logs.columns import refuse_cut_file

_HDF5 = b"\x89HDF\r\n\x1a\n"
_SEPARATORS = {",": "commas", ";": "semicolons", "\t": "tabs", "|": "bars"}
_SUFFIXES = {
    ".csv": "CSV", ".tsv": "CSV", ".txt": "CSV", ".dat": "CSV",
    ".h5": "HDF5", ".hdf5": "HDF5", ".hdf": "HDF5", ".mat": "MATLAB",
}  # fmt: skip


class Source(NamedTuple):
    """What a file holds.

    Attributes
    ----------
    kind : str
        In words.
    variables : dict
        Arrays of one or two dimensions by name.
    others : dict
        Names of what cannot be a channel, and why.
    """

    path: Path
    kind: str
    variables: dict[str, np.ndarray]
    others: dict[str, str]


def read_source(
    path: Path | str,
    *,
    separator: str | None = None,
    decimal: str | None = None,
    header_line: int | None = None,
    data_line: int | None = None,
) -> Source:
    """Read every variable of a file that can be a channel.

    Parameters
    ----------
    separator, decimal, header_line, data_line
        Of a text file, lines counted from 1; None finds out.

    Raises
    ------
    LogError
        The file cannot be read as what its name's ending says.
    """
    path = Path(path)
    kind = _SUFFIXES.get(path.suffix.lower())
    if kind is None:
        raise LogError(
            f"{path}: cannot tell what it is by its ending; must be one of {', '.join(_SUFFIXES)}"
        )
    try:
        with path.open("rb") as file:
            head = file.read(520)
    except OSError as error:
        raise LogError(f"{path}: cannot be opened ({error.strerror}); check the path") from error
    if kind == "CSV":
        return _read_csv(path, separator, decimal, header_line, data_line)
    if kind == "MATLAB" and not head.startswith((_HDF5, b"MATLAB 7.3")):
        return _read_matlab(path)
    return _read_hdf5(path, at=0 if head.startswith(_HDF5) else 512, matlab=kind == "MATLAB")


# --- text -----------------------------------------------------------------------------------


def _read_csv(
    path: Path,
    separator: str | None,
    decimal: str | None,
    header_line: int | None,
    data_line: int | None,
) -> Source:
    raw = path.read_bytes()
    if b"\0" in raw[:4096]:
        raise LogError(f"{path}: not a text file; give it the ending of what it is")
    try:
        text = raw.decode("utf-8-sig")
    except UnicodeDecodeError:
        text = raw.decode("latin-1")
    lines = text.rstrip().splitlines()
    if header_line is None:
        header_line = 1 + next((k for k, line in enumerate(lines) if _says_something(line)), 0)
    first = data_line or header_line + 1
    if not header_line < first <= len(lines):
        raise LogError(f"{path}: no samples below line {header_line}; check csv.header_line")
    separator = separator or _separator_of([lines[header_line - 1], *lines[first - 1 : first + 20]])
    names = [part.strip().strip('"') for part in _split(lines[header_line - 1], separator)]
    if all(_number(name.replace(",", ".")) for name in names):
        names, first = [str(k) for k in range(len(names))], header_line
    table = _parse(path, lines[first - 1 :], separator, len(names), first)
    names = [name or str(k) for k, name in enumerate(names)]
    twice = sorted({name for name in names if names.count(name) > 1})
    if twice:
        raise LogError(f"{path}: column {twice[0]}: is there twice; rename one in the header")
    variables, others = {}, {}
    for name, texts in zip(names, table, strict=True):
        values, bad = _numbers(texts, decimal, comma=separator != ",")
        if bad is None:
            variables[name] = values
        else:
            others[name] = (
                f"line {first + bad} holds {texts.iloc[bad]!r}, not a number; set csv.decimal or "
                "csv.data_line if that is how the file is written"
            )
    said = _SEPARATORS.get(separator, "blanks" if separator == r"\s+" else separator)
    return Source(path, f"text separated by {said}", variables, others)


def _says_something(line: str) -> bool:
    return bool(line.strip()) and not line.lstrip().startswith(("#", "%"))


def _split(line: str, separator: str) -> list[str]:
    return line.split() if separator == r"\s+" else line.split(separator)


def _separator_of(lines: list[str]) -> str:
    """Return what splits the header and the first samples into equally many parts."""
    counts = {mark: {line.count(mark) for line in lines} for mark in _SEPARATORS}
    fitting = [mark for mark in _SEPARATORS if len(counts[mark]) == 1 and counts[mark] != {0}]
    if fitting:
        return max(fitting, key=lambda mark: min(counts[mark]))
    words = {len(line.split()) for line in lines}
    return r"\s+" if len(words) == 1 and words != {1} else ","


def _parse(path: Path, lines: list[str], separator: str, columns: int, first: int) -> list:
    try:
        with warnings.catch_warnings():
            # fields beyond the header's are dropped with a warning alone
            warnings.simplefilter("error", pd.errors.ParserWarning)
            table = pd.read_csv(
                io.StringIO("\n".join(lines)),
                sep=separator,
                header=None,
                names=range(columns),
                index_col=False,
                dtype=str,
                skipinitialspace=True,
                skip_blank_lines=False,
                on_bad_lines="error",
            )
    except (
        pd.errors.ParserError,
        pd.errors.ParserWarning,
        pd.errors.EmptyDataError,
        ValueError,
    ) as error:
        raise LogError(
            f"{path}: cannot be read as text of {columns} columns from line {first} on ({error}); "
            "set csv.separator and csv.header_line"
        ) from error
    return [table[k] for k in range(columns)]


def _number(text: str) -> bool:
    try:
        float(text)
    except ValueError:
        return False
    return True


def _thousands(texts: pd.Series) -> pd.Series:
    """Mark numbers with a comma, if all have three digits after it and others have no comma."""
    comma = texts.str.contains(",", regex=False, na=False)
    grouped = texts[comma].str.fullmatch(r"[+-]?\d{1,3}(,\d{3})+")
    return comma & bool(comma.any() and not comma.all() and grouped.all())


def _numbers(texts: pd.Series, decimal: str | None, *, comma: bool) -> tuple[np.ndarray, Any]:
    """Return the numbers of a column, and the first row that holds none.

    Where nothing says what a comma is, 980, 990, 1,000 may be thousands: no number.
    """
    for mark in [decimal] if decimal else [".", ","] if comma else ["."]:
        plain = texts.str.replace(",", ".", regex=False) if mark == "," else texts
        values = pd.to_numeric(plain, errors="coerce")
        unread = values.isna() & texts.notna() & (texts.str.lower() != "nan")
        if mark == ",":
            unread |= texts.str.contains(".", regex=False, na=False)
            if not decimal:
                unread |= _thousands(texts)
        bad = np.flatnonzero(unread)
        if not bad.size:
            return values.to_numpy(dtype=np.float64), None
    return values.to_numpy(dtype=np.float64), int(bad[0])


# --- HDF5 and MATLAB ------------------------------------------------------------------------


def _read_hdf5(path: Path, *, at: int, matlab: bool) -> Source:
    refuse_cut_file(path, at=at)
    variables: dict[str, np.ndarray] = {}
    others: dict[str, str] = {}
    try:
        with h5py.File(path, "r") as file:
            for name, dataset in _datasets(file):
                # MATLAB keeps arrays by columns, and names the fields of a struct by dots
                shown = name.replace("/", ".") if matlab else name
                kind = dataset.attrs.get("MATLAB_class", b"double")
                if dataset.ndim > 2 or dataset.dtype.kind not in "fiu" or kind == b"char":
                    others[shown] = f"{dataset.dtype} of shape {dataset.shape}"
                    continue
                values = np.asarray(dataset[()], dtype=np.float64)
                variables[shown] = values.T if matlab else values
    except Exception as error:  # a damaged file makes the library raise whatever it stumbles over
        raise _damaged(path, "HDF5", error) from error
    kind = "MATLAB 7.3" if matlab else "HDF5"
    return Source(path, kind, *_sorted_out(path, variables, others))


def _datasets(group: h5py.Group, prefix: str = "") -> Iterator[tuple[str, h5py.Dataset]]:
    for name, member in group.items():
        if name.startswith("#"):  # where MATLAB keeps what its cells refer to
            continue
        if isinstance(member, h5py.Group):
            yield from _datasets(member, f"{prefix}{name}/")
        elif isinstance(member, h5py.Dataset):
            yield f"{prefix}{name}", member


def _read_matlab(path: Path) -> Source:
    try:
        content = scipy.io.loadmat(path, simplify_cells=True, verify_compressed_data_integrity=True)
    except Exception as error:  # the library raises whatever it stumbles over
        raise _damaged(path, "MATLAB", error) from error
    variables: dict[str, np.ndarray] = {}
    others: dict[str, str] = {}
    for name, value in _fields(content):
        try:
            array = np.asarray(value)
        except ValueError:  # a cell array of unlike things
            array = np.array(None)
        if array.dtype.kind in "fiub":
            variables[name] = array.astype(np.float64)
        else:
            others[name] = (
                "not an array of numbers; save tables, timetables and objects as a struct of arrays"
            )
    return Source(path, "MATLAB 5", *_sorted_out(path, variables, others))


def _fields(struct: Mapping[str, Any], prefix: str = "") -> Iterator[tuple[str, Any]]:
    for name, value in struct.items():
        if str(name).startswith("__"):
            continue
        if isinstance(value, dict):
            yield from _fields(value, f"{prefix}{name}.")
        else:
            yield f"{prefix}{name}", value


def _sorted_out(
    path: Path, variables: Mapping[str, np.ndarray], others: Mapping[str, str]
) -> tuple[dict[str, np.ndarray], dict[str, str]]:
    """Drop empty dimensions, and what has too many or too few."""
    kept, dropped = {}, dict(others)
    for name, values in variables.items():
        squeezed = values.reshape([n for n in values.shape if n != 1])
        if squeezed.ndim in (1, 2) and squeezed.size:
            kept[name] = squeezed
        else:
            dropped[name] = f"array of shape {values.shape}"
    if not kept and not dropped:
        raise LogError(f"{path}: holds nothing; the file is empty or cut short")
    return kept, dropped


def _damaged(path: Path, kind: str, error: Exception) -> LogError:
    return LogError(
        f"{path}: cannot be read as {kind} ({type(error).__name__}: {error}); the file is cut "
        "short, damaged, or something else"
    )


# --- columns --------------------------------------------------------------------------------

_INDEXED = re.compile(r"(?P<name>.+?)\s*\[\s*(?P<row>:|\d+)\s*,\s*(?P<column>:|\d+)\s*\]")


def columns_of(source: Source) -> dict[str, np.ndarray]:
    """Return every column that a map can name; those of a matrix as ``name[:, j]``, j from 0."""
    found = {}
    for name, values in source.variables.items():
        if values.ndim == 1:
            found[name] = values
        elif values.shape[0] >= values.shape[1]:
            found |= {f"{name}[:, {j}]": values[:, j] for j in range(values.shape[1])}
        else:
            found |= {f"{name}[{j}, :]": values[j] for j in range(values.shape[0])}
    return found


def pick(source: Source, text: str) -> np.ndarray:
    """Return the column that a map names.

    Raises
    ------
    LogError
        There is none of that name (with the nearest), or it is no vector; the
        message names the column and not the file.
    """
    if text in source.variables:
        values = source.variables[text]
        if values.ndim == 1:
            return values
        rows, columns = values.shape
        raise LogError(
            f"{text}: has {rows} rows and {columns} columns; choose one, "
            f"as {text}[:, 0] (counted from 0)"
        )
    match = _INDEXED.fullmatch(text)
    if match and match["name"] in source.variables and ":" in (match["row"], match["column"]):
        return _slice(source, text, match)
    if text in source.others:
        raise LogError(f"{text}: cannot be a channel: {source.others[text]}")
    raise LogError(f"{text}: no such column; {_nearest(source, text)}")


def _slice(source: Source, text: str, match: re.Match) -> np.ndarray:
    values = source.variables[match["name"]]
    index = tuple(slice(None) if part == ":" else int(part) for part in match.group(2, 3))
    if values.ndim == 2 and index != (slice(None), slice(None)):
        try:
            return values[index]
        except IndexError:
            pass
    raise LogError(f"{text}: {match['name']} has shape {values.shape}; indices count from 0")


def _nearest(source: Source, text: str) -> str:
    known = [*columns_of(source), *source.others]
    lower = {name.lower(): name for name in known}
    nearest = difflib.get_close_matches(text.lower(), lower, n=1, cutoff=0.0)[0]
    return f"did you mean {lower[nearest]}? `fprc import {source.path} --list` shows all"
