import pytest
from hypothesis import given
from hypothesis import strategies as st

from fprc.errors import LogError
from fprc.escape import visible


@pytest.mark.parametrize(
    ("text", "shown"),
    [
        ("theta [°], 角度", "theta [°], 角度"),
        ("\x1b[31mred\x07", r"\x1b[31mred\x07"),
        ("two\nlines\r", r"two\nlines\r"),
        ("\udce9", r"\udce9"),
        ("abc\u202etxt.exe", r"abc\u202etxt.exe"),
    ],
)
def test_what_cannot_be_printed_is_shown_as_its_escape(text, shown):
    assert visible(text) == shown


@given(st.text(st.characters(codec=None)))
def test_any_text_becomes_one_printable_line_that_can_be_encoded(text):
    assert visible(text).isprintable()
    visible(text).encode("utf-8")


def test_messages_keep_their_lines_and_cannot_command_the_terminal():
    assert str(LogError("a.h5: \x1b[2J\nb.h5: ok")) == "a.h5: \\x1b[2J\nb.h5: ok"
