"""A full disk or a locked folder gives a one-line error and no incomplete file."""

import os
import resource
import subprocess

import pytest


def errors(printed):
    return [line for line in printed.splitlines() if "] error: " in line]


@pytest.mark.slow
def test_file_that_may_not_grow_is_one_line_and_leaves_nothing_half_written(smoked_copy):
    raw = smoked_copy.folder / "results/smoke/raw"
    before = smoked_copy.files("results/smoke/raw")
    (raw / "sweep.h5").unlink()
    limit = 100_000
    run = smoked_copy.begin("logs", "--configfile", "config/smoke.yaml")
    resource.prlimit(run.process.pid, resource.RLIMIT_FSIZE, (limit, limit))
    assert run.process.wait(300) != 0
    (line,) = errors(run.printed())
    assert "raw/sweep.h5: " in line
    assert "(File too large)" in line
    assert "Traceback" not in run.printed()
    assert not [
        path for path in raw.iterdir() if "sweep.h5" in path.name and "track" not in path.name
    ]
    done = smoked_copy.smoke("logs")
    assert done.returncode == 0, done.stdout
    assert smoked_copy.files("results/smoke/raw") == before


@pytest.fixture
def locked(project):
    """Project whose results folder nobody may write to, not even root."""
    folder = project.folder / "results"
    folder.mkdir(mode=0o555)
    if os.access(folder, os.W_OK):
        command = ["chattr", "+i", str(folder)]
        if subprocess.run(command, capture_output=True, check=False).returncode:
            pytest.skip("no way to lock a folder against root here")
    yield project
    subprocess.run(["chattr", "-i", str(folder)], capture_output=True, check=False)


def test_locked_results_are_refused_before_any_job(locked):
    done = locked.snakemake("table1")
    assert done.returncode != 0
    assert "results cannot be written to" in done.stdout
    assert "Traceback" not in done.stdout
    assert not locked.files("results")
    done = locked.snakemake(
        "table1", "--config", "folders={results: elsewhere, raw: elsewhere/raw}"
    )
    assert done.returncode == 0, done.stdout
