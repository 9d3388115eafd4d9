"""After a kill at any moment, and elsewhere, the workflow gives the same results.

FPRC_KILLS is the number of random kills; `.ci/weekly` makes twenty.
"""

import os
import random
import shutil

import pytest

pytestmark = pytest.mark.slow

KILLS = int(os.environ.get("FPRC_KILLS", "0"))
SEED = int(os.environ.get("FPRC_KILL_SEED", "1"))
ELSEWHERE = {
    "TZ": "Pacific/Kiritimati", "LC_ALL": "C", "PYTHONUTF8": "0", "PYTHONCOERCECLOCALE": "0",
    "PYTHONHASHSEED": "4711",
}  # fmt: skip


def test_second_build_elsewhere_that_was_killed_gives_the_same_bytes(smoked, project):
    """One core, another folder, time zone, locale and hash seed."""
    assert project.killed(3, **ELSEWHERE) is None
    done = project.smoke("--cores", "1", "all", **ELSEWHERE)
    assert done.returncode == 0, done.stdout
    first, second = (p.folder / "results/smoke" for p in (smoked, project))
    for name in ("report.html", "claims.json", "figures/fig10_settings.pdf"):
        assert (second / name).exists()
    times = "timing/times.json"
    assert (first / times).read_bytes() != (second / times).read_bytes()
    assert project.differences_but_times(smoked) == ""


@pytest.mark.skipif(not KILLS, reason="random kills take long; `.ci/weekly` makes them")
def test_killed_at_random_moments_the_run_ends_the_same(smoked, project):
    moments = random.Random(SEED)
    kills = 0
    while kills < KILLS:
        status = project.killed(moments.randint(0, 28), moments.uniform(0, 1))
        kills += status is None
        if status is not None:
            assert status == 0
            assert project.differences_but_times(smoked) == ""
            shutil.rmtree(project.folder / "results")
    assert project.differences_but_times(smoked) == ""
