import logging

from fprc.cli import main
from fprc.commands import configuration


def say():
    logging.getLogger("fprc.some.module").info("ours")
    logging.getLogger("matplotlib").info("of another library")


def test_messages_go_to_the_standard_error_of_each_command(monkeypatch, capsys):
    monkeypatch.setattr(configuration, "published", say)
    for _ in range(2):
        assert main(["config", "published"]) == 0
        assert capsys.readouterr().err == "ours\n"
