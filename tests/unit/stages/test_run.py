import logging
from pathlib import Path
from types import SimpleNamespace

import pytest
from threadpoolctl import threadpool_info

from fprc.errors import ControlError
from fprc.stages import run as runner
from fprc.stages.run import run_stage


@pytest.fixture(autouse=True)
def no_handler_left():
    """Take off the handlers that a stage leaves to its process."""
    logger = logging.getLogger("fprc")
    level = logger.level
    yield
    for handler in list(logger.handlers):
        logger.removeHandler(handler)
        handler.close()
    logger.setLevel(level)


class Files(list):
    """What Snakemake gives to a script: all files or values in a row, and their names."""

    def __init__(self, **named):
        self.named = named
        for value in named.values():
            self.extend(value if isinstance(value, list) else [value])

    def __getattr__(self, name):
        return self.named[name]

    def keys(self):
        return self.named.keys()

    def items(self):
        return self.named.items()


@pytest.fixture
def job(tmp_path):
    """A job with one input, a list of inputs and two outputs."""
    for name in ("sweep.h5", "a.h5", "b.h5"):
        (tmp_path / name).write_text(f"content of {name}", encoding="utf-8")
    return SimpleNamespace(
        input=Files(
            sweep=str(tmp_path / "sweep.h5"),
            runs=[str(tmp_path / "a.h5"), str(tmp_path / "b.h5")],
            made_from=[str(tmp_path / "a.h5")],
        ),
        output=Files(pdf=str(tmp_path / "fig99.pdf"), png=str(tmp_path / "fig99.png")),
        params=Files(stage="loops.draw", quiet_s=12.0, code="0123"),
        wildcards=["201"],
        log=[str(tmp_path / "logs" / "fig99.log")],
        rule="loops",
    )


class Stage:
    """Draws two files, and remembers what it was given."""

    def __call__(self, **arguments):
        self.arguments = arguments
        self.threads = {pool["num_threads"] for pool in threadpool_info()}
        Path(arguments["pdf"]).write_bytes(b"%PDF")
        Path(arguments["png"]).write_bytes(b"\x89PNG")


@pytest.fixture
def run(job, monkeypatch):
    """Run a function as the stage of the job."""

    def call(stage):
        monkeypatch.setattr(runner, "stage_of", {"loops.draw": stage}.__getitem__)
        run_stage(job)

    return call


def test_stage_is_given_files_and_params_that_it_reads(job, run):
    stage = Stage()
    run(stage)
    assert stage.arguments == {
        "sweep": job.input.sweep,
        "runs": job.input.runs,
        "pdf": job.output.pdf,
        "png": job.output.png,
        "quiet_s": 12.0,
    }
    assert stage.threads <= {1}


def test_stage_that_fails_ends_with_its_message(job, run, capsys):
    def stage(**arguments):
        raise ControlError("P_i = 500 kPa; reduce it")

    with pytest.raises(SystemExit) as ended:
        run(stage)
    assert ended.value.code == 1
    shown = capsys.readouterr().err
    assert shown == "[loops 201] error: P_i = 500 kPa; reduce it\n"
    kept = Path(job.log[0]).read_text(encoding="utf-8")
    assert "error: P_i = 500 kPa; reduce it" in kept
    assert "Traceback" in kept
