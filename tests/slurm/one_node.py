"""Run a command on a Slurm of one node, and stop Slurm afterwards.

    python tests/slurm/one_node.py snakemake --workflow-profile slurm ...
    python tests/slurm/one_node.py --why-not     # prints what is missing, if anything

munged, slurmctld and slurmd run as root, in a temporary folder, on free ports. The only other file
written is /etc/slurm/slurm.conf, because the executor clears SLURM_CONF for the steps of a job. If
the machine already has that file, it has its own Slurm, and nothing is started.
"""

import os
import shutil
import signal
import socket
import subprocess
import sys
import tempfile
import time
from contextlib import ExitStack
from pathlib import Path

CONF = Path("/etc/slurm/slurm.conf")
PROGRAMS = ("munged", "slurmctld", "slurmd", "sbatch", "srun", "squeue", "sinfo", "scancel")
CONFIGURATION = """\
ClusterName=one
SlurmctldHost={host}(127.0.0.1)
SlurmctldPort={ports[0]}
SlurmdPort={ports[1]}
SlurmUser=root
AuthType=auth/munge
AuthInfo=socket={folder}/munge.socket
StateSaveLocation={folder}/state
SlurmdSpoolDir={folder}/spool
SlurmctldPidFile={folder}/slurmctld.pid
SlurmdPidFile={folder}/slurmd.pid
SlurmctldLogFile={folder}/slurmctld.log
SlurmdLogFile={folder}/slurmd.log
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
JobAcctGatherType=jobacct_gather/none
AccountingStorageType=accounting_storage/none
MpiDefault=none
ReturnToService=2
SelectType=select/cons_tres
SelectTypeParameters=CR_CPU_Memory
SchedulerParameters=batch_sched_delay=0,sched_interval=1,sched_min_interval=0
MinJobAge=600
KillWait=2
NodeName={host} NodeAddr=127.0.0.1 CPUs={cpus} RealMemory={memory_mb} State=UNKNOWN
PartitionName=all Nodes={host} Default=YES MaxTime=INFINITE State=UP
"""


def why_not() -> str:
    """Return what keeps Slurm from running here, or nothing."""
    missing = [name for name in PROGRAMS if shutil.which(name) is None]
    problems = [
        f"not installed: {', '.join(missing)}" if missing else "",
        "needs root" if os.geteuid() else "",
        f"{CONF} is there: of another Slurm, or of a run that was killed" if CONF.exists() else "",
    ]
    return "; ".join(filter(None, problems))


def start(stack: ExitStack) -> None:
    """Start the daemons and wait until the node is idle; the stack stops them."""
    folder = Path(tempfile.mkdtemp(prefix="slurm_"))
    stack.callback(shutil.rmtree, folder, ignore_errors=True)
    folder.chmod(0o755)  # munge refuses a socket that others cannot reach
    for name in ("state", "spool"):
        (folder / name).mkdir()
    key = folder / "munge.key"
    key.touch(mode=0o600)
    key.write_bytes(os.urandom(128))
    memory_mb = os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES") // 2**20
    with (
        socket.create_server(("127.0.0.1", 0)) as one,
        socket.create_server(("127.0.0.1", 0)) as two,
    ):
        ports = [found.getsockname()[1] for found in (one, two)]
    CONF.parent.mkdir(parents=True, exist_ok=True)
    stack.callback(CONF.unlink, missing_ok=True)
    CONF.write_text(
        CONFIGURATION.format(
            host=socket.gethostname().split(".")[0], folder=folder, ports=ports,
            cpus=os.cpu_count(), memory_mb=int(0.9 * memory_mb),
        )
    )  # fmt: skip

    def daemon(*command: str) -> None:
        log = stack.enter_context((folder / f"{command[0]}.out").open("wb"))
        process = subprocess.Popen(command, stdout=log, stderr=log, start_new_session=True)
        # its state goes with the folder: nothing is lost by a kill
        stack.callback(process.wait)
        stack.callback(process.kill)

    files = [f"--{name}-file={folder}/munge.{name}" for name in ("key", "pid", "seed", "log")]
    socket_file = f"--socket={folder}/munge.socket"
    daemon("munged", "--foreground", "--force", "--num-threads=2", *files, socket_file)
    until("munged answers", lambda: (folder / "munge.socket").exists())
    daemon("slurmctld", "-D", "-i")
    daemon("slurmd", "-D")
    until("the node is idle", lambda: says("sinfo", "-h", "-o", "%t") == "idle")
    stack.callback(cancel_all)


def cancel_all() -> None:
    """Cancel every job, and wait some seconds for the last to end."""
    subprocess.run(["scancel", "--user=root"], check=False)
    for _ in range(50):
        states = set(says("squeue", "-h", "-t", "all", "-o", "%T").split())
        if not states & {"PENDING", "RUNNING", "COMPLETING", "CONFIGURING"}:
            return
        time.sleep(0.2)


def until(what: str, true) -> None:
    """Wait for something, half a minute at most."""
    for _ in range(300):
        if true():
            return
        time.sleep(0.1)
    raise SystemExit(f"waited in vain until {what}")


def says(*command: str) -> str:
    """Return what a command prints."""
    return subprocess.run(command, capture_output=True, text=True, check=False).stdout.strip()


def end(number: int, frame: object) -> None:
    """End; a second signal must not break off the clean-up."""
    for ending in (signal.SIGTERM, signal.SIGHUP):
        signal.signal(ending, signal.SIG_IGN)
    sys.exit(128 + number)


def main(command: list[str]) -> int:
    """Run a command beside the daemons and return its exit code."""
    os.environ["PATH"] += ":/usr/sbin:/sbin"  # where Debian keeps the daemons
    problem = why_not()
    if command in ([], ["--why-not"]) or problem:
        print(problem or "nothing is missing")
        return 1 if problem else 0
    for number in (signal.SIGTERM, signal.SIGHUP):
        signal.signal(number, end)
    with ExitStack() as stack:
        start(stack)
        return subprocess.run(command, check=False).returncode


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
