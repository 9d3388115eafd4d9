import logging
from pathlib import Path
from types import SimpleNamespace

import pytest
from threadpoolctl import threadpool_info

from fprc.errors import ControlError
from fprc.stages import run as runner


@pytest.fixture(autouse=True)
def no_handler_left():
    """Take off the handlers that a stage leaves to its process."""
    logger = logging.getLogger("fprc")
    yield
    for handler in list(logger.handlers):
        logger.removeHandler(handler)
        handler.close()
    logger.setLevel(logging.NOTSET)


@pytest.fixture
def run(tmp_path, monkeypatch):
    """Run a function as the stage of a job; return the job's log."""

    def call(stage):
        monkeypatch.setattr(runner, "resolve_name", {"fprc.loops:draw": stage}.__getitem__)
        params = SimpleNamespace(stage="loops.draw")
        params.items = {"stage": "loops.draw", "quiet_s": 12.0, "code": "0123"}.items
        log = tmp_path / "fig99.log"
        try:
            runner.run_stage(
                SimpleNamespace(
                    input={"sweep": "s.h5", "runs": ["a.h5", "b.h5"], "made_from": ["a.h5"]},
                    output={"pdf": "fig99.pdf"},
                    params=params, wildcards=["201"], log=[str(log)], rule="loops",
                )
            )  # fmt: skip
        finally:
            call.kept = Path(log).read_text(encoding="utf-8")

    return call


def test_stage_is_given_files_and_params_that_it_reads(run):
    def stage(**arguments):
        given.update(arguments)
        assert {pool["num_threads"] for pool in threadpool_info()} <= {1}

    given = {}
    run(stage)
    assert given == {
        "sweep": "s.h5", "runs": ["a.h5", "b.h5"], "pdf": "fig99.pdf", "quiet_s": 12.0
    }  # fmt: skip


def test_stage_that_fails_ends_with_its_message(run, capsys):
    def stage(**arguments):
        raise ControlError("P_i = 500 kPa; reduce it")

    with pytest.raises(SystemExit) as ended:
        run(stage)
    assert ended.value.code == 1
    assert capsys.readouterr().err == "[loops 201] error: P_i = 500 kPa; reduce it\n"
    assert "error: P_i = 500 kPa; reduce it" in run.kept
    assert "Traceback" in run.kept
