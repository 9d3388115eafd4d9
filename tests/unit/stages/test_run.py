import logging
import shutil
import subprocess
from pathlib import Path
from types import SimpleNamespace

import pytest
from threadpoolctl import threadpool_info

from fprc.errors import ControlError
from fprc.provenance import changed_results
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
        output=Files(
            pdf=str(tmp_path / "fig99.pdf"),
            png=str(tmp_path / "fig99.png"),
        ),
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


#: What may happen to a result, and whether it is still the same.
DAMAGE = {
    "nothing": (lambda content: content, True),
    "empty": (lambda content: b"", False),
    "another digit": (lambda content: content.replace(b"1.5", b"2.5"), False),
    "longer": (lambda content: content + b" ", False),
}


@pytest.mark.parametrize("name", ["crossval/a.json", "tables/table2.csv", "fig.png", "a b'.md"])
@pytest.mark.parametrize("what", DAMAGE)
def test_result_that_was_changed_is_refused_by_the_next_stage(job, run, tmp_path, name, what):
    written = tmp_path / name
    written.parent.mkdir(exist_ok=True)
    job.output = Files(result=str(written))
    run(lambda result, **inputs: Path(result).write_bytes(b'{"x": 1.5}'))
    damage, same = DAMAGE[what]
    written.write_bytes(damage(written.read_bytes()))
    assert changed_results(tmp_path) == ([] if same else [str(written)])
    job.input, job.output = job.output, Files(page=str(tmp_path / "page.html"))
    if same:
        run(lambda result, page, **params: Path(page).touch())
    else:
        with pytest.raises(SystemExit):
            run(lambda **arguments: pytest.fail("was run"))
        assert f"{written}: " in Path(job.log[0]).read_text(encoding="utf-8")
        assert not Path(job.output.page).exists()


def test_result_has_no_digest_while_it_is_written(job, run, tmp_path):
    job.output = Files(first=str(tmp_path / "a.json"), second=str(tmp_path / "b.json"))

    def half(first, second, **inputs):
        Path(first).write_text("new")
        raise ZeroDivisionError

    run(lambda first, second, **inputs: [Path(path).touch() for path in (first, second)])
    with pytest.raises(ZeroDivisionError):
        run(half)
    assert changed_results(tmp_path) == []


@pytest.mark.skipif(shutil.which("sha256sum") is None, reason="no sha256sum here")
def test_digests_are_read_by_sha256sum(job, run, tmp_path):
    run(Stage())
    digests = sorted((tmp_path / "digests").iterdir())
    text = "".join(path.read_text(encoding="utf-8") for path in digests)
    for edit, code in ((b"", 0), (b"x", 1)):
        with open(job.output.png, "ab") as file:
            file.write(edit)
        assert subprocess.run(["sha256sum", "--check"], input=text.encode()).returncode == code
