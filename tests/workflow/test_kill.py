"""After a kill at any moment the workflow continues and gives the same results.

FPRC_KILLS is the number of random kills; `.ci/weekly` makes twenty. Every run of the tests
kills the second build of test_twice.py once.
"""

import os
import random
import re
import shutil
import subprocess
import time
from contextlib import suppress

import pytest

pytestmark = pytest.mark.slow

KILLS = int(os.environ.get("FPRC_KILLS", "0"))
SEED = int(os.environ.get("FPRC_KILL_SEED", "1"))
#: What jobs print of their progress, and Snakemake of their end; some 320 lines in a whole run.
PROGRESS = re.compile(r"^(?:\[[a-z_0-9]+[] ]|Finished jobid)", re.MULTILINE)


def wait_for(run, progress, seconds):
    """Wait until the jobs have reported so often, and some time more; or until the run ends."""
    while run.process.poll() is None:
        if len(PROGRESS.findall(run.printed())) >= progress:
            with suppress(subprocess.TimeoutExpired):
                run.process.wait(seconds)
            return
        time.sleep(0.05)


@pytest.mark.skipif(not KILLS, reason="random kills take long; `.ci/weekly` makes them")
def test_killed_at_random_moments_the_run_ends_the_same(smoked, project):
    moments = random.Random(SEED)
    kills = 0
    while kills < KILLS:
        run = project.begin("--configfile", "config/smoke.yaml")
        wait_for(run, moments.randint(1, 200), moments.uniform(0, 1))
        status = run.process.poll()
        run.kill()
        kills += status is None
        project.recover()
        if status is not None:
            assert status == 0, run.printed()
            assert project.differences_but_times(smoked[0]) == ""
            shutil.rmtree(project.folder / "results")
    done = project.smoke("all")
    assert done.returncode == 0, done.stdout
    assert project.differences_but_times(smoked[0]) == ""
