import logging

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
