import logging

import pytest

from fprc.commands.terminal import messages_on_terminal


@messages_on_terminal()
def say(text):
    logging.getLogger("fprc.some.module").info(text)
    logging.getLogger("matplotlib").info("of another library")


def test_messages_go_to_the_standard_error_of_each_call(capsys):
    ours = logging.getLogger("fprc")
    before = list(ours.handlers), ours.level
    for text in ("first", "second"):
        say(text)
        assert capsys.readouterr().err == f"{text}\n"
    assert (list(ours.handlers), ours.level) == before


def test_handler_is_taken_off_after_an_error(capsys):
    with pytest.raises(KeyError), messages_on_terminal():
        raise KeyError
    logging.getLogger("fprc").error("later")
    assert "later" not in capsys.readouterr().err
