"""After a kill at any moment the workflow continues and gives the same results.

FPRC_KILLS is the number of random kills; `make test-kill` makes twenty. Every run of the tests
kills the second build of test_twice.py once.
"""

import json
import os
import random
import re
import shutil
import subprocess
import time
from contextlib import suppress

import pytest

from tools import twice

pytestmark = pytest.mark.slow

KILLS = int(os.environ.get("FPRC_KILLS", "0"))
SEED = int(os.environ.get("FPRC_KILL_SEED", "1"))
#: What jobs print of their progress, and Snakemake of their end; some 320 lines in a whole run.
PROGRESS = re.compile(r"^(?:\[[a-z_0-9]+[] ]|Finished jobid)", re.MULTILINE)


def cells(printed):
    """Yield the job, the number of its finished cells and of all, in the order of printing."""
    for job, done, total in re.findall(
        r"^\[([^]]+)\] \[#* *\] (\d+) of (\d+) cells$", printed, re.M
    ):
        yield job, int(done), int(total)


def assert_no_cell_again(runs):
    """Refuse a job that counts from lower again, unless it had counted to its end."""
    furthest = {}
    for printed in runs:
        for job, done, total in cells(printed):
            assert done > furthest.get(job, 0), f"{job}: {done} of {total} again"
            furthest[job] = 0 if done == total else done


def assert_same_results(project, smoked):
    first, second = (p.folder / "results/smoke" for p in (smoked[0], project))
    twice.give_measurements(first, second)
    done = project.smoke("all")
    assert done.returncode == 0, done.stdout
    assert twice.differences(twice.files(first), twice.files(second)) == []


def wait_for(run, progress, seconds):
    """Wait until the jobs have reported so often, and some time more; or until the run ends."""
    while run.process.poll() is None:
        if len(PROGRESS.findall(run.printed())) >= progress:
            with suppress(subprocess.TimeoutExpired):
                run.process.wait(seconds)
            return
        time.sleep(0.05)


@pytest.mark.skipif(not KILLS, reason="random kills take long; `make test-kill` makes them")
def test_killed_at_random_moments_the_run_ends_the_same(smoked, project):
    moments = random.Random(SEED)
    runs, kills = [], 0
    while kills < KILLS:
        run = project.begin("--configfile", "config/smoke.yaml")
        wait_for(run, moments.randint(1, 200), moments.uniform(0, 1))
        status = run.process.poll()
        run.kill()
        runs.append(run.printed())
        kills += status is None
        project.recover()
        if status is not None:
            assert status == 0, run.printed()
            assert_no_cell_again(runs)
            assert_same_results(project, smoked)
            shutil.rmtree(project.folder / "results")
            runs = []
    done = project.smoke("all")
    assert done.returncode == 0, done.stdout
    assert_no_cell_again([*runs, done.stdout])
    assert_same_results(project, smoked)


def finished_cells(checkpoint):
    try:
        return checkpoint.read_text(encoding="utf-8").splitlines()[1:]
    except FileNotFoundError:
        return []


def test_killed_grid_continues_at_its_next_cell(smoked_copy):
    results = smoked_copy.folder / "results/smoke"
    grid = "results/smoke/grids/taps.json"
    assert smoked_copy.smoke(grid).returncode == 0
    expected = (results / "grids/taps.json").read_bytes()
    (results / "grids/taps.json").unlink()
    checkpoint = results / "grids/taps.partial.jsonl"
    run = smoked_copy.begin("--cores", "1", grid, "--configfile", "config/smoke.yaml")
    deadline = time.monotonic() + 120
    while not (before := finished_cells(checkpoint)) and time.monotonic() < deadline:
        time.sleep(0.005)
    run.kill()
    assert before, "no cell was finished in time"
    assert not (results / "grids/taps.json").exists()
    kept = [json.loads(line)[1]["cell"] for line in finished_cells(checkpoint)]
    assert 1 <= len(kept) < 9

    smoked_copy.recover()
    done = smoked_copy.smoke(grid)
    assert done.returncode == 0, done.stdout
    assert "Grid of taps" in done.stdout
    assert len([*cells(done.stdout)]) == 9 - len(kept)
    assert (results / "grids/taps.json").read_bytes() == expected
    assert not checkpoint.exists()
