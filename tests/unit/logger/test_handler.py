import logging
from types import SimpleNamespace

import pytest
from snakemake_interface_logger_plugins.common import LogEvent

from snakemake_logger_plugin_fprc import LogHandler


@pytest.fixture
def handler(tmp_path, monkeypatch, capsys):
    """Return what makes a handler of a run, and what it prints."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("FPRC_MESSAGES", "")

    def make(**given):
        settings = {"stdout": True, "nocolor": True, "quiet": set(), "show_failed_logs": False}
        settings |= dict.fromkeys(("debug_dag", "verbose", "dryrun", "printshellcmds"), False)
        return LogHandler(SimpleNamespace(**settings | given), None)

    return make


def tell(handler, message, level=logging.INFO, **said):
    record = logging.LogRecord("snakemake", level, "", 0, message, (), None)
    vars(record).update(said)
    handler.handle(record)


JOB = {"rule_name": "judge", "rule_msg": "Judgement", "jobid": 1, "log": ["judge.log"]}
FAILED = {"rule_name": "judge", "rule_msg": None, "jobid": 1, "input": [], "output": ["a.csv"],
          "log": ["judge.log"], "conda_env": None, "shellcmd": None, "aux": {}}  # fmt: skip


def test_errors_are_shown_in_full_and_routine_is_not(handler, capsys):
    run = handler()
    tell(run, "Job stats", event=LogEvent.RUN_INFO, stats={"judge": 1, "total": 1})
    tell(run, "Building DAG of jobs...")
    tell(run, "Rule: judge", event=LogEvent.JOB_INFO, **JOB)
    tell(run, "", logging.ERROR, event=LogEvent.JOB_ERROR, **FAILED)
    tell(run, "Shutting down, this might take some time.", logging.WARNING)
    run.close()
    printed = capsys.readouterr().out
    assert printed.startswith("1 job;")
    assert "Error in rule judge" in printed
    assert "output: a.csv" in printed
    assert "judge.log (check log file(s) for error details)" in printed
    assert "Shutting down" in printed
    assert "Building DAG" not in printed


def test_durations_are_kept_for_the_next_run(handler, tmp_path):
    (tmp_path / ".snakemake").mkdir()
    run = handler()
    tell(run, "", event=LogEvent.RUN_INFO, stats={"judge": 1, "total": 1})
    tell(run, "", event=LogEvent.JOB_INFO, **JOB)
    tell(run, "", event=LogEvent.JOB_FINISHED, job_id=1)
    run.close()
    assert "judge" in (tmp_path / ".snakemake/seconds.json").read_text()
