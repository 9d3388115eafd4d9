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
from contextlib import ExitStack, contextmanager
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
    missing = [name for name in PROGRAMS if shutil.which(name, path=_path()) is None]
    problems = [
        f"not installed: {', '.join(missing)}" if missing else "",
        "needs root" if os.geteuid() else "",
        f"{CONF} is there: of another Slurm, or of a run that was killed" if CONF.exists() else "",
    ]
    return "; ".join(filter(None, problems))


@contextmanager
def one_node():
    """Start the daemons, wait until the node is idle, and stop them whatever happens."""
    with ExitStack() as stack:
        folder = Path(tempfile.mkdtemp(prefix="slurm_"))
        stack.callback(shutil.rmtree, folder, ignore_errors=True)
        folder.chmod(0o755)  # munge refuses a socket that others cannot reach
        _configure(folder, stack)
        munged = ["munged", "--foreground", "--force", "--num-threads=2"]
        munged += [f"--{name}-file={folder}/munge.{name}" for name in ("key", "pid", "seed", "log")]
        _daemon(stack, [*munged, f"--socket={folder}/munge.socket"], folder)
        _until("munged answers", lambda: (folder / "munge.socket").exists(), folder)
        _daemon(stack, ["slurmctld", "-D", "-i"], folder)
        _daemon(stack, ["slurmd", "-D"], folder)
        _until("the node is idle", lambda: _says("sinfo", "-h", "-o", "%t") == "idle", folder)
        stack.callback(_cancel_all)
        yield


def _configure(folder: Path, stack: ExitStack) -> None:
    for name in ("state", "spool"):
        (folder / name).mkdir()
    key = folder / "munge.key"
    key.touch(mode=0o600)
    key.write_bytes(os.urandom(128))
    memory_mb = os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES") // 2**20
    with socket.socket() as one, socket.socket() as two:
        one.bind(("127.0.0.1", 0))
        two.bind(("127.0.0.1", 0))
        ports = one.getsockname()[1], two.getsockname()[1]
    CONF.parent.mkdir(parents=True, exist_ok=True)
    stack.callback(CONF.unlink, missing_ok=True)
    CONF.write_text(
        CONFIGURATION.format(
            host=socket.gethostname().split(".")[0],
            folder=folder,
            ports=ports,
            cpus=os.cpu_count(),
            memory_mb=int(0.9 * memory_mb),
        )
    )


def _daemon(stack: ExitStack, command: list[str], folder: Path) -> None:
    log = stack.enter_context((folder / f"{command[0]}.out").open("wb"))
    process = subprocess.Popen(command, stdout=log, stderr=log, start_new_session=True)
    stack.callback(_stop, process)


def _stop(process: subprocess.Popen) -> None:
    process.terminate()
    try:
        process.wait(timeout=5)  # its state goes with the folder: nothing is lost by a kill
    except subprocess.TimeoutExpired:
        process.kill()
        process.wait()


def _cancel_all() -> None:
    subprocess.run(["scancel", "--user=root"], check=False)
    deadline = time.monotonic() + 10
    while _says("squeue", "-h", "-t", "all", "-O", "State") and time.monotonic() < deadline:
        states = set(_says("squeue", "-h", "-t", "all", "-o", "%T").split())
        if not states & {"PENDING", "RUNNING", "COMPLETING", "CONFIGURING"}:
            return
        time.sleep(0.2)


def _until(what: str, true, folder: Path, seconds: float = 30) -> None:
    deadline = time.monotonic() + seconds
    while not true():
        if time.monotonic() > deadline:
            logs = "".join(
                f"--- {path.name}\n{path.read_text(errors='replace')[-2000:]}"
                for path in sorted([*folder.glob("*.out"), *folder.glob("*.log")])
            )
            raise SystemExit(f"waited {seconds:g} s until {what}\n{logs}")
        time.sleep(0.1)


def _says(*command: str) -> str:
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    return done.stdout.strip()


def _end(number: int, frame: object) -> None:
    # a second signal must not break off the clean-up
    for ending in (signal.SIGTERM, signal.SIGHUP):
        signal.signal(ending, signal.SIG_IGN)
    sys.exit(128 + number)


def _path() -> str:
    return f"{os.environ['PATH']}:/usr/sbin:/sbin"  # where Debian keeps the daemons


def main(command: list[str]) -> int:
    """Run a command beside the daemons and return its exit code."""
    problem = why_not()
    if command in ([], ["--why-not"]) or problem:
        print(problem or "nothing is missing")
        return 1 if problem else 0
    os.environ["PATH"] = _path()
    for number in (signal.SIGTERM, signal.SIGHUP):
        signal.signal(number, _end)
    with one_node():
        return subprocess.run(command, check=False).returncode


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
