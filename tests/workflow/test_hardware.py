import re

from fprc.channels import RAW_CHANNELS
from fprc.logs import write_raw

OF_THEIR_OWN = ["source=rig", "folders={raw: bench/raw, results: bench/results}"]


def put(project, name, source):
    """Write a raw log as if it had been recorded."""
    time_s = [k / 200.0 for k in range(400)]
    write_raw(
        project.folder / f"bench/raw/{name}.h5",
        dict.fromkeys(RAW_CHANNELS, time_s),
        experiment=name,
        source=source,
        sample_rate_hz=200.0,
        seed=1,
        software="test",
        rig={},
    )


def test_whole_paper_is_planned_on_the_real_rig(project):
    jobs = project.planned("all", "--config", *OF_THEIR_OWN)
    assert jobs["record_on_rig"] == 2 + 15
    assert not {"record", "track", "replicate"} & jobs.keys()
    assert "draw_loops" in jobs


def test_log_that_is_there_is_not_recorded_again(project):
    put(project, "sweep", "rig")
    done = project.snakemake("--dry-run", "--forceall", "table2", "--config", *OF_THEIR_OWN)
    assert done.returncode == 0, done.stdout
    assert re.search(r"^record_on_rig +1$", done.stdout, re.MULTILINE)
    assert "experiment sweep on the real rig" not in done.stdout.lower()


def test_simulated_log_is_not_taken_for_the_real_rigs(project):
    put(project, "sweep", "sim")
    done = project.snakemake("--dry-run", "table2", "--config", *OF_THEIR_OWN)
    assert done.returncode != 0
    assert re.search(r"sweep\.h5: its source is not rig.*folders\.raw", done.stdout)


def test_real_rig_is_not_started_unless_armed(project):
    done = project.snakemake("bench/raw/sweep.h5", "--config", *OF_THEIR_OWN)
    assert done.returncode != 0
    assert "sweep: not armed, nothing was moved" in done.stdout
    assert not list((project.folder / "bench/raw").glob("*"))
