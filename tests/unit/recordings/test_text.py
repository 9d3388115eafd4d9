import csv
import io

import numpy as np
import pytest
from hypothesis import assume, example, given
from hypothesis import strategies as st

from fprc.errors import LogError
from fprc.recordings.names import is_unit
from fprc.recordings.text import is_value, read_text


@pytest.fixture
def table(tmp_path):
    """Write a text and return the table read from it."""

    def table(text, **options):
        path = tmp_path / "log.csv"
        path.write_bytes(text if isinstance(text, bytes) else text.encode())
        return read_text(path, **options)

    return table


def columns(table):
    return {name: column.values.tolist() for name, column in table.columns.items()}


#: Any text; without characters that files cannot hold, and line ends, which a name has not.
MARKS = st.characters(exclude_categories=["Cs"], exclude_characters="\0\r\n\x1c\x1d\x1e\x1f\x85")
NAMES = st.text(MARKS, max_size=6) | st.text('",;|\t #%"a.1', max_size=6)


@given(
    separator=st.sampled_from(",;\t| "),
    names=st.lists(NAMES, min_size=2, max_size=5, unique_by=str.strip),
    rows=st.integers(2, 8),
    seed=st.integers(0, 9),
)
@example(separator=",", names=['5" pipe', "a;b", "line#2"], rows=3, seed=0)
@example(separator=" ", names=["a,b", '"', "c d"], rows=3, seed=0)
def test_table_of_any_names_comes_back_as_it_was_written(
    tmp_path_factory, separator, names, rows, seed
):
    stripped = [name.strip() for name in names]
    # a number, a comment, or a blank line may be meant: the ambiguous cases
    assume(all(stripped) and not any(map(is_value, stripped)))
    assume(not stripped[0].startswith(("#", "%", "sep=", "//")))
    assume('"' not in "".join(stripped) or separator != " ")
    assume(not all(map(is_unit, stripped)) and stripped[-1].lower() != "comment")
    # unquoted, a tab is a blank
    assume(separator != " " or "".join(names).isprintable())
    numbers = np.random.default_rng(seed).standard_normal((rows, len(names)))
    written = io.StringIO(newline="")
    writer = csv.writer(written, delimiter=separator)
    writer.writerow(names)
    writer.writerows([[repr(float(number)) for number in row] for row in numbers])
    path = tmp_path_factory.getbasetemp() / "any_table.csv"
    path.write_bytes(written.getvalue().encode())
    for options in ({}, {"separator": separator, "header_line": 1}):
        found = read_text(path, **options)
        assert found.others == {}
        assert list(found.columns) == stripped
        assert np.array_equal(np.column_stack([c.values for c in found.columns.values()]), numbers)


MOTION = np.random.default_rng(1).normal(50.0, 20.0, (40, 3))
#: Clocks: the text of a sample's time.
CLOCKS = {
    "s": "{:.3f}".format,
    "ms": lambda time_s: f"{1e3 * time_s:.0f}",
    "of the day": lambda time_s: f"21:10:{time_s:06.3f}",
    "date": lambda time_s: f"2024-03-08 21:10:{time_s:09.6f}",
    "none": None,
}
ABOVE = ["Experiment 12", "Device: X", "", "Rate;100", "# comment", "Date 2024-03-08"]


@given(
    separator=st.sampled_from([",", ";", "\t", "|", " ", "  "]),
    decimal=st.sampled_from(".,"),
    digits=st.integers(1, 5),
    clock=st.sampled_from([*CLOCKS]),
    header=st.sampled_from(["{}", "{}", "# {}", ""]),
    above=st.lists(st.sampled_from(ABOVE), max_size=4),
    between=st.sampled_from([None, "", "Pump on"]),
    quote=st.sampled_from(['"', ""]),
    tail=st.booleans(),
    count=st.integers(12, 40),
    encoding=st.sampled_from(["utf-8", "utf-8-sig", "utf-16"]),
)
def test_numbers_of_any_layout_are_those_that_were_written(
    tmp_path_factory, separator, decimal, digits, clock, header, above, between, quote, tail, count,
    encoding,
):  # fmt: skip
    blanks = not separator.strip(" ")
    assume(decimal == "." or separator != ",")
    assume(clock != "date" or not blanks or quote)
    stamps = [] if clock == "none" else [[CLOCKS[clock](k / 100) for k in range(count)]]
    values = [[f"{v:.{digits}f}" for v in column] for column in MOTION[:count].T]
    names = [*["time"][: len(stamps)], "angle", "pressure", "p_o"]
    end = separator if tail and not blanks else ""
    cells = [[text.replace(".", decimal) for text in column] for column in values]
    marked = stamps if clock == "date" else [[t.replace(".", decimal) for t in s] for s in stamps]
    rows = [
        separator.join(f"{quote}{text}{quote}" for text in row) + end
        for row in zip(*marked, *cells, strict=True)
    ]
    rows[5:5] = [] if between is None else [between]
    top = [*above, header.format(separator.join(names))] if header else above
    path = tmp_path_factory.getbasetemp() / "layout.csv"
    path.write_bytes("\n".join([*top, *rows, ""]).encode(encoding))
    # three digits may be thousands
    found = read_text(path, decimal=decimal if digits == 3 else None)
    places = names if header else [str(k) for k in range(len(names))]
    for name, texts in zip(places[len(stamps) :], values, strict=True):
        assert found.columns[name].values.tolist() == [float(text) for text in texts]
    if stamps:
        steps = np.diff(found.columns[places[0]].values)
        assert steps == pytest.approx(10.0 if clock == "ms" else 0.01, abs=1e-6)
    assert len(found.unusable) == bool(between)


#: Text, the decimal mark declared or None, and what p is: numbers, or None if it is refused.
DECIMALS = {
    "comma": ("t;p\n0;1,25\n1;2\n", None, [1.25, 2.0]),
    "comma, three digits": ("t;p\n0;1,250\n1;1,500\n", None, [1.25, 1.5]),
    "comma, a 0 before it": ("t\tp\n0\t0,250\n1\t1,500\n", None, [0.25, 1.5]),
    "comma, a gap": ("t;p\n0;1,250\n1;\n2;1.#QNAN\n3;2,500\n", None, [1.25, None, None, 2.5]),
    "comma, shown by the clock": ("t;p\n0,5;990\n1,5;1,000\n", None, [990.0, 1.0]),
    "point, three digits": ("t,p\n0,50.000\n1,50.125\n", None, [50.0, 50.125]),
    "missing": ("t,p\n0,\n1,NA\n2, null \n3,nan\n4,5\n", None, [None] * 4 + [5.0]),
    "declared": ("t;p\n0;990\n1;1,000\n", ",", [990.0, 1.0]),
    "point, the clock has commas": ("t;p\n0,5;50.000\n1,5;50.125\n", None, None),
    "comma for thousands?": ("t\tp\n0\t1,500\n1\t1,501\n", None, None),
    "comma in some rows": ("t;p\n0;990\n1;1,000\n", None, None),
    "point for thousands?": ("t;p\n0;50.000\n1;50.125\n", None, None),
    "both in a column": ("t;p\n0;1.5\n1;1,5\n", None, None),
    "underscores": ("t,p\n0,1\n1,1_0\n", None, None),
    "points group thousands": ("t;p\n0,5;990,5\n1,5;1.000,25\n", None, [990.5, 1000.25]),
    "points that group nothing": ("t;p\n0,5;990,5\n1,5;10.00,25\n", None, None),
    "points that group, declared": ("t;p\n0;1.000,5\n1;2.000,5\n", ".", None),
    "declared otherwise": ("t;p\n0;50.000\n1;5,5\n", ",", None),
}


@pytest.mark.parametrize("case", DECIMALS)
def test_decimal_mark_is_that_of_the_file_or_refused(table, case):
    text, decimal, expected = DECIMALS[case]
    found = table(text, decimal=decimal)
    if expected is None:
        assert "p" in found.others
    else:
        assert found.others == {}
        np.testing.assert_array_equal(found.columns["p"].values, np.array(expected, float))


def test_header_line_that_is_asked_for_keeps_names_with_blanks(table):
    found = table("Time s  Bend angle  P out\n" + "0.1 2 3\n" * 5, header_line=1)
    assert list(found.columns) == ["Time s", "Bend angle", "P out"]
    short = table('"t" "p"\n' + '"1" 0.5 2.5\n' * 5, header_line=1)
    assert list(short.columns) == ["0", "1", "2"]  # R's row numbers have no name


@pytest.mark.parametrize("last", ["2,12", "2,", "2", '2,"1', ""])
def test_last_line_without_a_line_end_is_left_out_with_a_note(table, last):
    found = table(f"t,x\n0,1\n1,2\n{last}")
    assert columns(found) == {"t": [0, 1], "x": [1, 2]}
    assert len(found.notes) == bool(last)


@pytest.mark.parametrize(
    ("text", "options", "expected"),
    [
        ("t,a,\n0,1,5\n1,2,\n", {}, {"t": [0, 1], "a": [1, 2], "2": [5, None]}),
        ("t,a,a\n0,1,5\n1,2,6\n", {}, {"t": [0, 1], "a": [1, 2], "a (2)": [5, 6]}),
        ("sep=;\nt;a\n0;1\n2;3\n", {}, {"t": [0, 2], "a": [1, 3]}),
        ("t|a\n0|1\n2|3\nEOF\n", {}, {"t": [0, 2], "a": [1, 3]}),
        ('made by a "logger\nt,a\ns,mm\n0,1\n2,3\n', {}, {"t": [0, 2], "a": [1, 3]}),
        ("t,x\n7,8\nt,x\ns,mm\n0,1.5\n1,2.5\n", {"header_line": 3, "data_line": 5},
         {"t": [0, 1], "x": [1.5, 2.5]}),
        ("t,x,who\n0,1,me\n1,2,me\n", {}, {"t": [0, 1], "x": [1, 2]}),
        ("t,2\n0,1\n1,3\n", {"header_line": 1}, {"t": [0, 1], "2": [1, 3]}),
        ("x,t\n" + "7,0\n" * 19 + "#DIV/0!,1\n", {}, {"x": [*[7] * 19, None], "t": [*[0] * 19, 1]}),
        ("a=1 ok p=2 on\n" * 9, {}, {"a": [1] * 9, "p": [2] * 9}),
    ],
)  # fmt: skip
def test_columns_have_the_names_above_them(table, text, options, expected):
    found = columns(table(text, **options))
    assert list(found) == list(expected)
    for name, values in expected.items():
        np.testing.assert_array_equal(found[name], np.array(values, float))


@pytest.mark.parametrize(
    ("content", "options", "place"),
    [
        ("# only this", {}, "no samples"),
        ("t,x\0\n", {}, "no known format"),
        ("t,x\n" + "0,1\n2\n" * 9 + "2,3\n", {}, "line 3"),
        ("t,x\n0,1\n1,2\n", {"header_line": 9}, "csv.header_line"),
        ("t,x\n0,1\n1,2\n", {"data_line": 9}, "no samples"),
    ],
)
def test_text_that_is_no_table_is_refused_with_the_place(table, content, options, place):
    with pytest.raises(LogError) as caught:
        table(content, **options)
    assert "log.csv: " in str(caught.value)
    assert place in str(caught.value)
