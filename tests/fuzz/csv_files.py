"""Recordings as text, with wrong separators, quotes, headers and numbers."""

import csv
import io
from pathlib import Path
from typing import Any, NamedTuple

import damage
import imports
import numpy as np
import signals
from judging import Case

NAME = "arm.csv"
_HEADERS = (
    ("t", "angle", "p", "z"),
    ("t [ms]", "angle [rad]", "P set [bar]", "PAM B [kPa abs]"),
    ("t", "a,deg", "p;exp", "z"),
    ('t "clock"', "the angle", " p", "z "),
    ("t", "$\\frac{$", "$p$_^", "%z"),
    ("t", "=1+1", "@SUM(1)", "-2"),
    ("t", "\x1b[31mangle\x1b[0m", "p", "z\x9b2J"),
    ("t", "<b>a|b</b>", "`p`", "[z](x)"),
    ("Zeit", "Größe °", "давление", "圧力"),
    ("t", "a" * 300, "p.1", "p[:, 0]"),
)
_PLAIN = [_HEADERS[k] for k in (0, 1, 2, 4, 5, 7, 8)]


class Written(NamedTuple):
    """Format of a text file."""

    data: bytes
    separator: str
    comma: bool
    encoding: str
    header: int


def case(rng: np.random.Generator, folder: Path) -> Case:
    """Make a case of a text file and a map."""
    headers = _HEADERS[rng.integers(len(_HEADERS))] if rng.random() < 0.5 else _HEADERS[0]
    rate_hz = float(rng.choice([100.0, 200.0]))
    table, unit = _table(rate_hz, str(rng.choice(["s", "ms"])))
    rows = [list(row) for row in zip(*table.values(), strict=True)]
    header = list(headers)
    mapping = imports.any_map(
        rng, dict(zip(("theta_deg", "p_exp_kpa", "p_o_kpa"), headers[1:], strict=True)),
        {"column": headers[0], "unit": unit}, rate_hz,
    )  # fmt: skip
    done = []
    if rng.random() < 0.5:
        done.append(_TABLE[rng.integers(len(_TABLE))](rng, header, rows))
    written = _write(rng, header, rows)
    data = written.data
    if rng.random() < 0.4:
        ways = (damage.flip, damage.flip, damage.flip, *damage.ROUGH, _insert, _insert)
        data, what = ways[rng.integers(len(ways))](rng, data)
        done.append(what)
    if written.comma or rng.random() < 0.3:
        mapping["csv"] = {"separator": written.separator, "decimal": "," if written.comma else "."}
    if rng.random() < 0.25:
        done.append(f"map: {imports.spoil(rng, mapping)}")
    (folder / NAME).write_bytes(data)
    imports.write_map(folder, mapping)
    text = f"{written.separator!r} {headers[1][:20]!r}: {'; '.join(done) or 'as it should be'}"

    def reading(path: Path) -> dict[str, Any]:
        return read(path.read_bytes(), written)

    steps = imports.steps(rng, NAME, mapping, reading, draw=0.5)
    return Case("recording, CSV", text, steps, sound=not done and headers in _PLAIN)


def _table(rate_hz: float, unit: str) -> tuple[dict[str, list[str]], str]:
    channels = signals.hysteresis(300)
    time_s = np.arange(300) / rate_hz
    factor = 1e3 if unit == "ms" else 1.0
    return {
        "t": [f"{factor * t:.6g}" for t in time_s],
        "angle": [f"{value:.5g}" for value in channels["theta_deg"]],
        "p": [f"{value:.6g}" for value in channels["p_exp_kpa"]],
        "z": [f"{value:.6g}" for value in channels["p_o_kpa"]],
    }, unit


def _write(rng: np.random.Generator, header: list, rows: list) -> Written:
    separator = str(rng.choice([",", ",", ";", "\t", "|"]))
    comma = separator == ";" and rng.random() < 0.5
    if comma:
        rows = [[value.replace(".", ",") for value in row] for row in rows]
    text = io.StringIO()
    quoting = csv.QUOTE_ALL if rng.random() < 0.15 else csv.QUOTE_MINIMAL
    end = "\r\n" if rng.random() < 0.2 else "\n"
    writer = csv.writer(text, delimiter=separator, quoting=quoting, lineterminator=end)
    before = 0
    if rng.random() < 0.15:
        before = int(rng.integers(1, 4))
        text.write(f"# a note{end}" * before)
    if header:
        writer.writerow(header)
    writer.writerows(rows)
    encoding = str(rng.choice(["utf-8", "utf-8", "utf-8", "utf-8-sig", "latin-1"]))
    try:
        data = text.getvalue().encode(encoding)
    except UnicodeEncodeError:
        data, encoding = text.getvalue().encode("utf-8"), "utf-8"
    return Written(data, separator, comma, encoding, before)


def read(data: bytes, written: Written) -> dict[str, np.ndarray | None]:
    """Return the columns of a file, read by Python's csv module.

    Raises
    ------
    imports.WrongError
        A name is repeated, or a row and the header differ in the number of fields.
    """
    try:
        text = data.decode("utf-8-sig")
    except UnicodeDecodeError:
        text = data.decode("latin-1")
    lines = text.splitlines()
    if lines and not text.endswith(("\n", "\r")):
        lines.pop()  # it may be cut short
    lines = [line for line in lines if line.strip()]
    lines = [line for k, line in enumerate(lines) if k > 10 or not line.lstrip().startswith("#")]
    reader = csv.reader(lines, delimiter=written.separator, skipinitialspace=True)
    try:
        header, *rows = list(reader)
    except (csv.Error, ValueError) as error:
        raise imports.WrongError(str(error)) from error
    header = [name.strip() for name in header]
    if len(set(header)) < len(header):
        raise imports.WrongError("a name is there twice")
    if any(len(row) != len(header) for row in rows):
        raise imports.WrongError("a row has not as many fields as the header")
    columns = zip(*rows, strict=True)
    return {
        name: _numbers(column, written.comma) for name, column in zip(header, columns, strict=True)
    } | {name: _numbers(column, written.comma) for name, column in _again(header, rows)}


def _again(header: list[str], rows: list[list[str]]):
    """Yield the columns under the names in the map, which may have blanks around them."""
    for name, column in zip(header, zip(*rows, strict=True), strict=True):
        yield f" {name}", column
        yield f"{name} ", column


def _numbers(texts, comma: bool) -> np.ndarray | None:
    try:
        return np.array([float(text.replace(",", ".") if comma else text) for text in texts])
    except ValueError:
        return None


# --- variants of a table ---------------------------------------------------------------


def _ragged(rng, header, rows):
    k, way = int(rng.integers(len(rows))), int(rng.integers(4))
    if way == 0:
        rows[k].pop(int(rng.integers(len(rows[k]))))
    elif way == 1:
        rows[k].insert(int(rng.integers(len(rows[k]))), "7")
    elif way == 2:
        for row in rows:
            row.append("7")
    else:
        header.append("more")
    return f"ragged, way {way} at {k}"


def _odd_field(rng, header, rows):
    k, j = int(rng.integers(len(rows))), int(rng.integers(len(rows[0])))
    odd = [
        "", " ", "nan", "NaN", "inf", "-inf", "1e400", "1e308", "1,000", "1_0", "x", "\x1b[31m",
        "--", "0x10", "1.2.3", "=1+1", "#N/A", "null", '"', "'1", "1 2", "½", "٣", "1e", "+",
        "9" * 400, "y" * 200000, "\u2028", "1\x0b2",
    ]  # fmt: skip
    rows[k][j] = odd[rng.integers(len(odd))]
    return f"row {k}, column {j}: {rows[k][j][:20]!r}"


def _clock(rng, header, rows):
    k, way = int(rng.integers(1, len(rows))), int(rng.integers(7))
    last = float(rows[k - 1][0])
    if way == 0:
        rows[k][0] = rows[k - 1][0]
    elif way == 1:
        rows[k][0] = f"{last - 0.5:.6g}"
    elif way in (2, 3):
        jump = float(rng.choice([0.5, 3.0, 1e6, 1e9]))
        for row in rows[k : k + 1 if way == 2 else None]:
            row[0] = f"{float(row[0]) + jump:.12g}"
    elif way == 4:
        for j in range(k, min(k + 40, len(rows))):
            rows[j][0] = rows[j - j % 2][0]
    elif way == 5:
        for row in rows:
            row[0] = f"{float(row[0]) + 1.7e9:.15g}"
    else:
        rows.reverse()
    return f"clock, way {way} at {k}"


def _names(rng, header, rows):
    k, way = int(rng.integers(len(header))), int(rng.integers(6))
    if way == 0:
        header[k] = header[k - 1]
    elif way == 1:
        header.clear()
    elif way == 2:
        header[k] = ["", "7", "x" * 10**6, "\x00", '"', "a\nb", "\x1b]0;x\x07"][rng.integers(7)]
    elif way == 3:
        header[:] = [str(j) for j in range(len(header))]
    elif way == 4:
        header[k] = f" {header[k]} "
    else:
        header[k] = header[k].upper()
    return f"names, way {way} at {k}"


def _few(rng, header, rows):
    del rows[int(rng.choice([0, 1, 2, 3])) :]
    return f"{len(rows)} rows"


def _many_columns(rng, header, rows):
    wide = int(rng.choice([300, 3000, 30_000], p=[0.6, 0.35, 0.05]))
    header += [f"c{k}" for k in range(wide)]
    del rows[40 if wide < 10_000 else 3 :]
    for row in rows:
        row += ["0"] * wide
    return f"{wide} columns more"


def _constant(rng, header, rows):
    j, value = int(rng.integers(1, 4)), str(rng.choice(["0", "5", "1e300", "-1e308", "1e-320"]))
    for row in rows:
        row[j] = value
    return f"column {j} is {value}"


def _blank_line(rng, header, rows):
    rows.insert(int(rng.integers(len(rows))), [])
    return "a blank line"


_TABLE = (
    _ragged, _ragged, _odd_field, _odd_field, _clock, _clock, _names, _few, _many_columns,
    _constant, _blank_line,
)  # fmt: skip


def _insert(rng: np.random.Generator, data: bytes):
    """Insert bytes that are special in CSV, text encodings or terminals."""
    some = (
        b'"', b"'", b",", b";", b"\n", b"\r", b"\0", b"\xff", b"\xef\xbb\xbf", b"\x1b[2J", b"#",
        b"\t", b'""', b"\xc2\x85", b"e", b"-", b".",
    )  # fmt: skip
    at, what = int(rng.integers(len(data))), some[rng.integers(len(some))]
    return data[:at] + what + data[at:], f"{what!r} at byte {at}"
