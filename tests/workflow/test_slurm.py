"""The workflow gives the same bytes with and without Slurm.

SLURM_TARGETS names the targets; `all` makes the whole smoke run. By default there is one
job of each kind: a group of logs and one of drawings, a further seed, and a model.
"""

import os
import subprocess
import sys
from pathlib import Path

import pytest

SMALL = "fig4 results/smoke/crossval/sweep_esn.json results/smoke/replicates/grids_101.json"
TARGETS = os.environ.get("SLURM_TARGETS", SMALL).split()
#: Where `.ci/programs` puts the executor.
PLUGIN = Path(sys.prefix) / "slurm"
ONE_NODE = str(Path(__file__).parents[1] / "slurm/one_node.py")
#: Snakemake that asks for the state of its jobs every second. The executor would wait ten seconds
#: longer each time that no job has ended.
SNAKEMAKE = """
from snakemake.cli import main
from snakemake_interface_executor_plugins.executors.remote import RemoteExecutor
RemoteExecutor.next_seconds_between_status_checks = property(lambda _: 1, lambda _, seconds: None)
main()
"""
#: What a node of this size and a Slurm without accounts need beside the profile.
HERE = """
    --workflow-profile slurm --cores 2 --max-threads 2 --slurm-status-command squeue
    --slurm-no-account --slurm-init-seconds-before-status-checks 2
""".split()

pytestmark = pytest.mark.slow


def test_slurm_gives_the_same_bytes(project, request):
    if not list(PLUGIN.glob("snakemake_executor_plugin_slurm")):
        pytest.skip("snakemake-executor-plugin-slurm is not installed; `.ci/programs` does it")
    done = subprocess.run([sys.executable, ONE_NODE, "--why-not"], capture_output=True, text=True)
    if done.returncode:
        pytest.skip(f"Slurm: {done.stdout.strip()}; `.ci/programs` installs it on Debian, as root")
    # not Python's timeout, which kills: the daemons must be stopped
    command = ["timeout", "1500", sys.executable, ONE_NODE, sys.executable, "-c", SNAKEMAKE]
    settings = ["--configfile", "config/smoke.yaml"]
    path = os.pathsep.join(filter(None, [str(PLUGIN), os.environ.get("PYTHONPATH")]))
    done = project.run(*command, *HERE, *TARGETS, *settings, PYTHONPATH=path)
    assert done.returncode == 0, done.stdout
    assert done.stdout.count("has been submitted with SLURM jobid") >= 4
    listed = subprocess.run(["ps", "-e", "-o", "stat=,comm="], capture_output=True, text=True)
    running = {line.split()[1] for line in listed.stdout.splitlines() if not line.startswith("Z")}
    assert not {"munged", "slurmctld", "slurmd", "slurmstepd"} & running
    assert not Path("/etc/slurm/slurm.conf").exists()
    # not earlier, so that another process makes it in the meantime
    local, through_slurm = request.getfixturevalue("smoked").untimed(), project.untimed()
    assert len(through_slurm) > 10
    assert through_slurm.keys() <= local.keys()
    assert [name for name in through_slurm if through_slurm[name] != local[name]] == []
