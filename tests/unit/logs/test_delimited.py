import csv
import io
import re

import numpy as np
import pandas as pd
import pytest
from hypothesis import assume, example, given
from hypothesis import strategies as st

from fprc.errors import LogError
from fprc.logs import delimited
from fprc.logs.delimited import read_text

T = np.arange(50) / 100.0
COLUMNS = {"t": T, "angle": np.sin(T), "force": np.arange(50.0) ** 2}
SEPARATORS = [",", ";", "\t", "|", " "]


def read(path, **told):
    return read_text(
        path, **dict.fromkeys(["separator", "decimal", "header_line", "data_line"]) | told
    )


@pytest.fixture
def table(tmp_path):
    """Write a text and return the source read from it."""

    def table(text, **told):
        path = tmp_path / "log.csv"
        path.write_bytes(text if isinstance(text, bytes) else text.encode())
        return read(path, **told)

    return table


@pytest.fixture
def refusal(table):
    def refusal(text, **told):
        with pytest.raises(LogError) as caught:
            table(text, **told)
        return str(caught.value)

    return refusal


def columns(source):
    return {name: values.tolist() for name, values in source.variables.items()}


# --- names and numbers ----------------------------------------------------------------------

#: Any text; without characters that files cannot hold, and line ends that reading unifies.
MARKS = st.characters(exclude_categories=["Cs"], exclude_characters="\0\r")
NAMES = st.text(MARKS, max_size=6) | st.text('",;|\t #%"a.1\n', max_size=6)


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
@example(separator=",", names=['5" pipe', "a;b", "line\n#2"], rows=3, seed=0)
@example(separator=" ", names=["a,b", '"', "c d"], rows=3, seed=0)
@example(separator=";", names=["a", "b"], rows=1, seed=3)
def test_table_of_any_names_comes_back_as_it_was_written(
    tmp_path_factory, separator, names, rows, seed
):
    stripped = [name.strip() for name in names]
    # no name, no letter in any, a comment, or a blank line: the ambiguous cases
    assume(all(stripped) and not all(map(is_number, stripped)))
    assume(not stripped[0].startswith(("#", "%")))
    # unquoted, a tab is a blank
    assume(separator != " " or not any("\t" in name for name in names))
    numbers = np.random.default_rng(seed).standard_normal((rows, len(names)))
    written = io.StringIO(newline="")
    writer = csv.writer(written, delimiter=separator)
    writer.writerow(names)
    writer.writerows([[repr(float(number)) for number in row] for row in numbers])
    path = tmp_path_factory.getbasetemp() / "any_table.csv"
    path.write_bytes(written.getvalue().encode())
    for told in ({}, {"separator": separator, "header_line": 1}):
        found = read(path, **told)
        assert found.others == {}
        assert list(found.variables) == stripped
        assert np.array_equal(np.column_stack(list(found.variables.values())), numbers)


def test_quoted_comma_in_the_header_shifts_no_column(table):
    found = columns(table('t,"a,deg",p,z\n0,1,2,3\n1,4,5,6\n'))
    assert found == {"t": [0, 1], "a,deg": [1, 4], "p": [2, 5], "z": [3, 6]}


def test_doubled_quotes_and_line_ends_are_part_of_a_name(table):
    source = table('"say ""t""","angle\n[deg]"\n0,1\n2,3\n')
    assert columns(source) == {'say "t"': [0, 2], "angle\n[deg]": [1, 3]}
    assert source.lines.tolist() == [3, 4]


def test_quoted_numbers_are_numbers(table):
    assert columns(table('t,p\n"0","1,5"\n"1","2,5"\n')) == {"t": [0, 1], "p": [1.5, 2.5]}


@pytest.mark.parametrize("separator", SEPARATORS)
def test_separator_is_found_out(table, separator):
    found = table(pd.DataFrame(COLUMNS).to_csv(index=False, sep=separator))
    assert columns(found) == {name: values.tolist() for name, values in COLUMNS.items()}


@pytest.mark.parametrize(
    "text",
    ["t;a, deg;p\n0,5;1,5;2,5\n1,5;2,5;3,5\n", "t\ta b\tp\n0,5\t1,5\t2,5\n1,5\t2,5\t3,5\n"],
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


def test_decimal_comma_is_found_out(table):
    text = pd.DataFrame(COLUMNS).to_csv(index=False, sep=";", decimal=",")
    assert columns(table(text))["angle"] == COLUMNS["angle"].tolist()


def test_decimal_commas_between_commas_are_refused(refusal):
    said = refusal("t_ms,p_set,p_o\n0,1,0,50,1\n5,1,1,50,2\n10,1,2,50,3\n")
    assert "line 1, has 3 fields separated by commas, line 2 has 5, and 2 more lines" in said
    assert "csv.separator" in said


@pytest.mark.parametrize("numbers", [["990", "999", "1,000"], ["1.5", "1,5", "2"]])
def test_ambiguous_comma_is_not_a_number_unless_declared_decimal(table, numbers):
    text = "t;p\n" + "".join(f"{k};{number}\n" for k, number in enumerate(numbers))
    source = table(text)
    assert "csv.decimal" in source.others["p"]
    assert "t" in source.variables


@pytest.mark.parametrize(
    ("text", "numbers", "refused"),
    [
        ("t;p;a\n0,000;50.000;1,5\n0,005;51.000;1,6\n", [], ["t", "p", "a"]),
        ('t,p\n0.000,"1,500"\n0.005,"1,600"\n', [], ["t", "p"]),
        ("t;p\n0;1.500\n1;1.600\n", ["t"], ["p"]),
        ("t;p\n0,0;1,5\n0,1;1,625\n", ["t", "p"], []),
        ("t,p\n0.0,1.5\n0.1,1.625\n", ["t", "p"], []),
    ],
)
def test_columns_that_disagree_on_the_decimal_mark_are_refused_with_both_readings(
    table, text, numbers, refused
):
    source = table(text)
    assert [*source.variables] == numbers
    assert [*source.others] == refused
    for name in refused:
        assert "csv.decimal" in source.others[name]
        assert re.search(r"\d+ with (points|commas) for thousands", source.others[name])


@pytest.mark.parametrize("text", ["1e-400", "-0.5e-500"])
def test_number_too_small_to_be_one_is_not_read_as_zero(table, text):
    source = table(f"t,p\n0,{text}\n1,2\n")
    assert [*source.variables] == ["t"]
    assert text in source.others["p"]


def test_declared_decimal_mark_is_used(table):
    assert columns(table("t;p\n0;990\n1;1,000\n", decimal=","))["p"] == [990.0, 1.0]


def test_three_digits_after_every_comma_are_decimals(table):
    assert columns(table("t;p\n0;1,250\n1;1,500\n"))["p"] == [1.25, 1.5]


def test_missing_values_are_nan(table):
    (values,) = list(table("t,p\n0,\n1,NA\n2, null \n3,nan\n4,5\n").variables.values())[1:]
    assert np.isnan(values[:4]).all()
    assert values[4] == 5.0


def test_number_with_underscores_is_none(table):
    assert "line 3 holds '1_0', not a number" in table("t,p\n0,1\n1,1_0\n").others["p"]


def test_text_without_header_is_numbered(table):
    assert columns(table("0,1.5\n1,2.5\n2,3.5\n")) == {"0": [0, 1, 2], "1": [1.5, 2.5, 3.5]}


def test_numbers_may_be_names_on_a_declared_header_line(table):
    assert columns(table("100,200\n1,2\n", header_line=1)) == {"100": [1], "200": [2]}


def test_lines_of_header_and_data_may_be_given(table):
    text = 'made by a "logger\nt,x\ns,mm\n0,1.5\n1,2.5\n'
    source = table(text, header_line=2, data_line=4)
    assert columns(source) == {"t": [0, 1], "x": [1.5, 2.5]}
    assert source.lines.tolist() == [4, 5]


# --- refusals -------------------------------------------------------------------------------


@pytest.mark.parametrize("row", ["1,2,3", "1", "", "1,2,3,"])
def test_row_with_other_fields_than_the_header_is_refused_with_its_line(refusal, row):
    said = refusal(f"t,x\n0,1\n{row}\n2,3\n")
    count = len(row.rstrip(",").split(",")) if row else 0
    fields = count + row.endswith(",")
    assert f"has 2 fields separated by commas, line 3 has {fields}, and 0 more" in said


def test_column_that_is_no_number_is_named_with_its_line(table):
    source = table("# made by hand\nt,x\n0,1.5\n1,off\n2,3.5\n")
    assert "line 4 holds 'off', not a number" in source.others["x"]


@pytest.mark.parametrize(
    ("content", "said"),
    [
        ("", "no samples"),
        ("# only this", "no samples"),
        ("t,x\n", "no samples below line 1"),
        ("t,t\n0,1\n1,2\n", "column t: occurs twice"),
        ("t,x\0\n", "not a text file"),
        ('t,"x\n0,1\n1,2\n', "line 1 cannot be read"),
        ('t,"x"y\n0,1\n1,2\n', "line 1 cannot be read"),
        ('t,x\n0,"1\n1,"2\n3,4\n', "line 2 cannot be read"),
        ('t,x\n0,"1\n1,2\n3,4"\n', "mark on line 2 is not closed"),
    ],
)
def test_text_that_is_no_table_is_refused(refusal, content, said):
    assert "log.csv: " in refusal(content)
    assert said in refusal(content)


@pytest.mark.parametrize(
    ("told", "said"),
    [
        ({"header_line": 9}, "csv.header_line is past its end"),
        ({"header_line": 2, "data_line": 2}, "csv.data_line = 2; must be below the header"),
        ({"data_line": 9}, "no samples below line 1"),
    ],
)
def test_lines_beyond_the_file_are_refused(refusal, told, said):
    assert said in refusal("t,x\n0,1\n1,2\n", **told)


def test_large_text_is_refused_unread(refusal, monkeypatch):
    monkeypatch.setattr(delimited, "LARGEST_TEXT_BYTES", 8)
    assert "of text; must be at most" in refusal("t,x\n0,1\n1,2\n")


def test_many_columns_are_read(table):
    """With a quadratic search over names this takes a minute for 20,000."""
    names = [f"c{k}" for k in range(20_000)]
    line = ",".join("1.5" for _ in names)
    found = table("\n".join([",".join(names), line, line]))
    assert len(found.variables) == 20_000
    assert found.variables["c19999"].tolist() == [1.5, 1.5]
