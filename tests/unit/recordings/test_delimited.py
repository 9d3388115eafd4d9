import csv
import io

import numpy as np
import pytest
from hypothesis import assume, example, given
from hypothesis import strategies as st

from fprc.errors import LogError
from fprc.recordings import delimited
from fprc.recordings.delimited import read_text

SEPARATORS = [",", ";", "\t", "|", " "]


def read(path, **options):
    return read_text(
        path, **dict.fromkeys(["separator", "decimal", "header_line", "data_line"]) | options
    )


@pytest.fixture
def table(tmp_path):
    """Write a text and return the source read from it."""

    def table(text, **options):
        path = tmp_path / "log.csv"
        path.write_bytes(text if isinstance(text, bytes) else text.encode())
        return read(path, **options)

    return table


@pytest.fixture
def refusal(table):
    def refusal(text, **options):
        with pytest.raises(LogError) as caught:
            table(text, **options)
        return str(caught.value)

    return refusal


def columns(source):
    return {name: values.tolist() for name, values in source.columns.items()}


def test_first_line_of_a_spreadsheet_may_name_the_separator(table):
    source = table("sep=;\nt;p,kPa\n0;1,5\n1;2,5\n")
    assert columns(source) == {"t": [0.0, 1.0], "p,kPa": [1.5, 2.5]}
    assert source.lines.tolist() == [3, 4]


# --- names and numbers ----------------------------------------------------------------------

#: Any text; without characters that files cannot hold, and line ends, which a name has not.
MARKS = st.characters(exclude_categories=["Cs"], exclude_characters="\0\r\n")
NAMES = st.text(MARKS, max_size=6) | st.text('",;|\t #%"a.1', max_size=6)


def is_number(text):
    try:
        float(text.replace(",", "."))
    except ValueError:
        return False
    return True


@given(
    separator=st.sampled_from(SEPARATORS),
    names=st.lists(NAMES, min_size=2, max_size=5, unique_by=str.strip),
    rows=st.integers(1, 8),
    seed=st.integers(0, 9),
)
@example(separator=",", names=["t", "a,deg", "p", "z"], rows=3, seed=0)
@example(separator=",", names=['5" pipe', "a;b", "line#2"], rows=3, seed=0)
@example(separator=" ", names=["a,b", '"', "c d"], rows=3, seed=0)
@example(separator=";", names=["a", "b"], rows=1, seed=3)
def test_table_of_any_names_comes_back_as_it_was_written(
    tmp_path_factory, separator, names, rows, seed
):
    stripped = [name.strip() for name in names]
    # no name, no letter in any, a comment, or a blank line: the ambiguous cases
    assume(all(stripped) and not all(map(is_number, stripped)))
    assume(not stripped[0].startswith(("#", "%", "sep=")))
    # unquoted, a tab is a blank
    assume(separator != " " or not any("\t" in name for name in names))
    numbers = np.random.default_rng(seed).standard_normal((rows, len(names)))
    written = io.StringIO(newline="")
    writer = csv.writer(written, delimiter=separator)
    writer.writerow(names)
    writer.writerows([[repr(float(number)) for number in row] for row in numbers])
    path = tmp_path_factory.getbasetemp() / "any_table.csv"
    path.write_bytes(written.getvalue().encode())
    for options in ({}, {"separator": separator, "header_line": 1}):
        found = read(path, **options)
        assert found.others == {}
        assert list(found.columns) == stripped
        assert np.array_equal(np.column_stack(list(found.columns.values())), numbers)


@pytest.mark.parametrize(
    "text", ["t;a, deg;p\n0,5;1,5;2,5\n1,5;2,5;3,5\n", "t\ta b\tp\n0,5\t1,5\t2,5\n1,5\t2,5\t3,5\n"]
)
def test_separator_that_leaves_numbers_is_preferred(table, text):
    assert list(columns(table(text)).values()) == [[0.5, 1.5], [1.5, 2.5], [2.5, 3.5]]


def test_blanks_and_tabs_in_any_number_are_one_separator(table):
    assert columns(table("  t \t a  \n 0   1.5\n 1\t2.5  \n")) == {"t": [0, 1], "a": [1.5, 2.5]}


@pytest.mark.parametrize(
    "text",
    [
        "t,a\n0,1\n2,3\n",
        "t,a,\n0,1,\n2,3,\n",
        "t,a,\n0,1\n2,3\n",
        "t,a\n0,1,\n2,3,\n",
        "\ufefft,a\n0,1\n2,3\n",
        "t,a\r\n0,1\r\n2,3\r\n\r\n",
        "# made in 2019, by, hand\n\nt,a\n\n0,1\n# half time \"\n2,3\n% end\n",
        "t , a\n0 , 1\n2 , 3\n",
    ],
)  # fmt: skip
def test_one_table_written_in_several_ways(table, text):
    assert columns(table(text)) == {"t": [0, 2], "a": [1, 3]}


@pytest.mark.parametrize("encoding", ["latin-1", "utf-8", "utf-8-sig", "utf-16"])
def test_letters_of_other_encodings_are_read(table, encoding):
    assert list(columns(table("t,angle [°]\n0,1\n".encode(encoding)))) == ["t", "angle [°]"]


def test_column_without_a_name_has_its_number(table):
    assert columns(table("t,a,\n0,1,5\n1,2,\n"))["2"][0] == 5.0


#: Text, the decimal mark declared or None, and what p is: numbers, or None if it is refused.
DECIMALS = {
    "comma": ("t;p\n0;1,25\n1;2\n", None, [1.25, 2.0]),
    "comma, three digits": ("t;p\n0;1,250\n1;1,500\n", None, [1.25, 1.5]),
    "comma, a 0 before it": ("t\tp\n0\t0,250\n1\t1,500\n", None, [0.25, 1.5]),
    "comma, quoted": ('t,p\n"0","1,5"\n1,"2,25"\n', None, [1.5, 2.25]),
    "comma, a gap": ("t;p\n0;1,250\n1;\n2;1.#QNAN\n3;2,500\n", None, [1.25, None, None, 2.5]),
    "comma, shown by the clock": ("t;p\n0,5;990\n1,5;1,000\n", None, [990.0, 1.0]),
    "point, three digits": ("t,p\n0,50.000\n1,50.125\n", None, [50.0, 50.125]),
    "declared": ("t;p\n0;990\n1;1,000\n", ",", [990.0, 1.0]),
    "point, the clock has commas": ("t;p\n0,5;50.000\n1,5;50.125\n", None, None),
    "comma, the clock has points": ('t,p\n0.0,"1,500"\n0.5,"1,501"\n', None, None),
    "comma for thousands?": ('t,p\n0,"1,500"\n1,"1,501"\n', None, None),
    "comma for thousands? 2": ("t\tp\n0\t1,500\n1\t1,501\n", None, None),
    "comma in some rows": ("t;p\n0;990\n1;1,000\n", None, None),
    "point for thousands?": ("t;p\n0;50.000\n1;50.125\n", None, None),
    "both in a column": ("t;p\n0;1.5\n1;1,5\n", None, None),
    "underscores": ("t,p\n0,1\n1,1_0\n", None, None),
    "both in a number": ("t;p\n0;1.234,5\n1;1.234,6\n", None, None),
    "too small for a float": ("t,p\n0,1e-400\n1,0e5\n", None, None),
    "declared otherwise": ("t;p\n0;50.000\n1;5,5\n", ",", None),
}  # fmt: skip


@pytest.mark.parametrize("case", DECIMALS)
def test_decimal_mark_is_that_of_the_file_or_refused(table, case):
    text, decimal, expected = DECIMALS[case]
    source = table(text, decimal=decimal)
    if expected is None:
        assert "csv.decimal" in source.others["p"]
    else:
        assert source.others == {}
        np.testing.assert_array_equal(source.columns["p"], np.array(expected, float))


@given(
    numbers=st.lists(st.floats(-1e6, 1e6), min_size=2, max_size=5),
    separator=st.sampled_from([";", "\t", "|"]),
    mark=st.sampled_from(".,"),
    digits=st.integers(0, 4),
)
def test_number_is_read_as_it_was_written_or_not_at_all(
    tmp_path_factory, numbers, separator, mark, digits
):
    texts = [f"{number:.{digits}f}" for number in numbers]
    lines = [f"{k}{separator}{text.replace('.', mark)}" for k, text in enumerate(texts)]
    path = tmp_path_factory.getbasetemp() / "decimals.csv"
    path.write_text("\n".join([f"t{separator}p", *lines, ""]))
    for options in ({}, {"decimal": mark}):
        source = read(path, **options)
        if "p" in source.columns or options:
            assert source.columns["p"].tolist() == list(map(float, texts))


@pytest.mark.parametrize("last", ["2,12", "2,1", "2,", "2", '2,"1', ""])
def test_last_line_without_a_line_end_is_left_out_with_a_note(table, last):
    source = table(f"t,x\n0,1\n1,2\n{last}")
    assert columns(source) == {"t": [0, 1], "x": [1, 2]}
    assert len(source.notes) == bool(last)


def test_missing_values_are_nan(table):
    (values,) = list(table("t,p\n0,\n1,NA\n2, null \n3,nan\n4,5\n").columns.values())[1:]
    assert np.isnan(values[:4]).all()
    assert values[4] == 5.0


def test_text_without_header_is_numbered(table):
    assert columns(table("0,1.5\n1,2.5\n2,3.5\n")) == {"0": [0, 1, 2], "1": [1.5, 2.5, 3.5]}


def test_lines_of_header_and_data_may_be_given(table):
    text = 'made by a "logger\nt,x\ns,mm\n0,1.5\n1,2.5\n'
    source = table(text, header_line=2, data_line=4)
    assert columns(source) == {"t": [0, 1], "x": [1.5, 2.5]}
    assert source.lines.tolist() == [4, 5]


# --- refusals -------------------------------------------------------------------------------


def test_column_that_is_no_number_is_named_with_its_line(table):
    source = table('# made by hand\nt,x,who\n0,1.5,me\n1,off,5" hose\n2,3.5,\n')
    assert source.others["x"].startswith("line 4 holds 'off'")
    assert list(source.columns) == ["t"]


@pytest.mark.parametrize(
    ("content", "options", "place"),
    [
        ("", {}, "no samples"),
        ("# only this", {}, "no samples"),
        ("t,x\n", {}, "below line 1"),
        ("t,t\n0,1\n1,2\n", {}, "column t"),
        ("t,x\0\n", {}, "not a text file"),
        ('t,"x\n0,1\n1,2\n', {}, "line 1"),
        ('t,"x\n[deg]"\n0,1\n1,2\n', {}, "line 1"),
        ('t,"x"y\n0,1\n1,2\n', {}, "line 1"),
        ('t,x\n0,1\n1,"2"3\n3,4\n', {}, "line 3"),
        ('t,x\n0,"1\n1,"2\n3,4\n', {}, "line 2"),
        ('t,x\n0,"1\n1,2\n3,4"\n', {}, "line 2"),
        ('t,x\n0,1\n3,"4\n', {}, "line 3"),
        ("t,x\n0,1\n1,2,3\n2,3\n", {}, "line 3 has 3"),
        ("t,x\n0,1\n1\n2,3\n", {}, "line 3 has 1"),
        ("t,x\n0,1\n\n2,3\n", {}, "line 3 has 0"),
        ("t,x\n0,1\n1,2,3,\n2,3\n", {}, "line 3 has 4"),
        ("t_ms,p_set,p_o\n0,1,0,50,1\n5,1,1,50,2\n", {}, "csv.separator"),
        ("t,x\n0,1\n1,2\n", {"header_line": 9}, "csv.header_line"),
        ("t,x\n0,1\n1,2\n", {"header_line": 2, "data_line": 2}, "csv.data_line = 2"),
        ("t,x\n0,1\n1,2\n", {"data_line": 9}, "below line 1"),
    ],
)
def test_text_that_is_no_table_is_refused_with_the_place(refusal, content, options, place):
    message = refusal(content, **options)
    assert "log.csv: " in message
    assert place in message


def test_large_text_is_refused_unread(refusal, monkeypatch):
    monkeypatch.setattr(delimited, "LARGEST_TEXT_BYTES", 8)
    assert "must have at most 8" in refusal("t,x\n0,1\n1,2\n")


def test_many_columns_are_read(table):
    """With a quadratic search over names this takes a minute for 20,000."""
    names = [f"c{k}" for k in range(20_000)]
    line = ",".join("1.5" for _ in names)
    found = table("\n".join([",".join(names), line, line, ""]))
    assert len(found.columns) == 20_000
    assert found.columns["c19999"].tolist() == [1.5, 1.5]
