"""A locked folder is refused in one line before any job."""

import os
import subprocess

import pytest


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
    assert "results: cannot be written to" in done.stdout
    assert "Traceback" not in done.stdout
    assert not locked.files("results")
    done = locked.snakemake(
        "table1", "--config", "folders={results: elsewhere, raw: elsewhere/raw}"
    )
    assert done.returncode == 0, done.stdout
