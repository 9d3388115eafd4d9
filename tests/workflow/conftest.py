import fcntl
import json
import os
import re
import shutil
import signal
import subprocess
import sys
import time
from contextlib import suppress
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
SNAKEMAKE = [sys.executable, "-m", "snakemake"]
#: Runs print what Snakemake and the jobs print, instead of a line for each job.
MESSAGES = {"FPRC_MESSAGES": "all"}
STARTS = Path(__file__).parent / "starts.py"
ENVIRONMENT = os.environ | {
    "PATH": f"{Path(sys.executable).parent}{os.pathsep}{os.environ['PATH']}"
}


class Run:
    """Workflow in a session of its own, which may be killed."""

    def __init__(self, folder: Path, command: list[str], environment: dict[str, str]):
        self._output = folder / "printed.txt"
        with self._output.open("w") as output:
            self.process = subprocess.Popen(
                command,
                cwd=folder,
                env=ENVIRONMENT | environment,
                stdout=output,
                stderr=subprocess.STDOUT,
                start_new_session=True,
            )

    def kill(self) -> None:
        """Kill every process of the session, and see that none is left."""
        deadline = time.monotonic() + 60
        while self._members() and time.monotonic() < deadline:
            for member in self._members():
                with suppress(ProcessLookupError):
                    os.kill(member, signal.SIGKILL)
            time.sleep(0.05)
        assert not self._members()
        self.process.wait(60)

    def _members(self) -> list[int]:
        found = []
        for path in Path("/proc").glob("[0-9]*/stat"):
            with suppress(OSError):
                state, _, _, session = path.read_text().rpartition(")")[2].split()[:4]
                if int(session) == self.process.pid and state != "Z":
                    found.append(int(path.parent.name))
        return found

    def printed(self) -> str:
        return self._output.read_text(encoding="utf-8", errors="replace")


#: What holds times, or is made from them.
TIMED = ("/timing/", "/logs/", "fig10_", "report.html")


#: Processes that start Snakemake in forks, by what their environment has beside this one's.
STARTERS: dict[tuple[tuple[str, str], ...], subprocess.Popen] = {}


def starter(**begun_with: str) -> subprocess.Popen:
    """Return the process that starts Snakemake in forks, one for each environment."""
    key = tuple(sorted(begun_with.items()))
    if key not in STARTERS:
        STARTERS[key] = subprocess.Popen(
            [sys.executable, STARTS],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            text=True,
            env=os.environ | begun_with,
        )
    return STARTERS[key]


@pytest.fixture(scope="session", autouse=True)
def _end_of_starters():
    yield
    for process in STARTERS.values():
        process.communicate()


#: Prints the rules that run a stage: name, stage, and names of inputs, outputs and params.
LISTED = """
import json
include: "workflow/studies/Snakefile"
for known in workflow.rules:
    if known.script:
        named = [*known.input.keys(), *known.output.keys(), *known.params.keys()]
        print(json.dumps([known.name, known.params.stage, named]))
"""


class Project:
    """A copy of the workflow in a folder of its own, run with the installed package."""

    def __init__(self, folder: Path):
        self.folder = folder
        for name in ("config", "profiles", "workflow"):
            shutil.copytree(ROOT / name, folder / name)
        shutil.copy(ROOT / "Snakefile", folder)

    def snakemake(
        self,
        *arguments: str,
        cores: tuple[str, ...] = ("--cores", "2"),
        begun_with: dict[str, str] | None = None,
        **environment: str,
    ) -> subprocess.CompletedProcess:
        """Run Snakemake in a fork that has it imported; use ``run`` for a process of its own.

        Its jobs are forks too, unless ``environment`` has more than a PYTHONPATH.
        Python reads some variables only at its start: give these in ``begun_with``.
        """
        begun_with = begun_with or {}
        environment = MESSAGES | environment
        forked = environment.keys() <= {"PYTHONPATH", *MESSAGES}
        known = ENVIRONMENT | begun_with | environment
        asked = [str(self.folder), [*cores, *arguments], known, forked]
        starts = starter(**begun_with)
        starts.stdin.write(json.dumps(asked) + "\n")
        starts.stdin.flush()
        code, printed = json.loads(starts.stdout.readline())
        return subprocess.CompletedProcess(asked[1], code, printed)

    def stages(self) -> dict[str, tuple[str, set[str]]]:
        """Stage of each rule that runs one, and names of its inputs, outputs and params."""
        (self.folder / "listed.smk").write_text(LISTED, encoding="utf-8")
        listed = self.snakemake("--snakefile", "listed.smk", "--list-rules").stdout
        found = map(json.loads, re.findall(r"^\[.*\]$", listed, flags=re.MULTILINE))
        return {name: (stage, set(named)) for name, stage, named in found}

    def run(self, *command: str, **environment: str) -> subprocess.CompletedProcess:
        return subprocess.run(
            command,
            cwd=self.folder,
            env=ENVIRONMENT | environment,
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            text=True,
            timeout=1800,
        )

    def studies(self, *arguments: str, **options) -> subprocess.CompletedProcess:
        """Run the Snakefile of the studies, with the settings of the smoke run."""
        return self.smoke("--snakefile", "workflow/studies/Snakefile", *arguments, **options)

    def smoke(self, *arguments: str, **options) -> subprocess.CompletedProcess:
        return self.snakemake(*arguments, "--configfile", "config/smoke.yaml", **options)

    def planned(self, *arguments: str, **options) -> dict[str, int]:
        """Jobs of a dry run, by rule."""
        done = self.snakemake("--dry-run", *arguments, **options)
        assert done.returncode == 0, done.stdout
        counts = re.findall(r"^(\w+) +(\d+)$", done.stdout, flags=re.MULTILINE)
        return {rule: int(count) for rule, count in counts if rule != "total"}

    def begin(self, *arguments: str, **environment: str) -> "Run":
        command = [*SNAKEMAKE, "--cores", "2", *arguments]
        return Run(self.folder, command, MESSAGES | environment)

    def recover(self) -> None:
        """Give the command of the docs for after a kill, word by word."""
        text = (ROOT / "docs/running.md").read_text(encoding="utf-8")
        command = re.search("After a kill, run `(snakemake [^`]+)`", text)
        done = self.run(*command[1].split())
        assert done.returncode == 0, done.stdout

    def files(self, *folders: str) -> dict[str, bytes]:
        return {
            str(path.relative_to(self.folder)): path.read_bytes()
            for folder in folders
            for path in sorted((self.folder / folder).rglob("*"))
            if path.is_file()
        }

    def untimed(self) -> dict[str, bytes]:
        """Results that hold no times and are not made from them; logs name processes."""
        return {
            name: content
            for name, content in self.files("results").items()
            if not any(part in name for part in TIMED)
        }

    def differences_but_times(self, first: "Project") -> str:
        """Make a smoke run again with the measured times of another; say which files differ."""
        ours, theirs = (project.folder / "results/smoke" for project in (self, first))
        for times in (theirs / "timing").glob("times*.json"):
            shutil.copy(times, ours / "timing")
        done = self.smoke("all")
        assert done.returncode == 0, done.stdout
        diff = ["diff", "--recursive", "--brief", "--exclude", "logs", theirs, ours]
        return subprocess.run(diff, capture_output=True, text=True, check=False).stdout


@pytest.fixture(scope="session")
def shared(tmp_path_factory):
    """Folder for what several processes share: FPRC_SMOKED, or one of this process alone."""
    return Path(os.environ.get("FPRC_SMOKED") or tmp_path_factory.mktemp("smoked"))


def once(shared: Path, name: str, make) -> tuple[Project, str]:
    """Return a project of that name that ``make(folder)`` prepares once, and what it printed."""
    folder, printed = shared / name, shared / f"{name}.txt"
    with (shared / f"{name}.lock").open("w") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        if not printed.exists():
            shutil.rmtree(folder, ignore_errors=True)
            done = make(folder)
            assert done.returncode == 0, done.stdout
            printed.write_text(done.stdout, encoding="utf-8")
    return _existing(folder), printed.read_text(encoding="utf-8")


@pytest.fixture(scope="session")
def smoked(shared):
    """Project with a finished smoke run, and what the run printed. Read only."""

    def make(folder):
        folder.mkdir()
        # the words of docs/running.md
        return Project(folder).snakemake("--workflow-profile", "smoke", "all")

    return once(shared, "project", make)


@pytest.fixture(scope="session")
def rebuilt(tmp_path_factory):
    """Second cold build under other circumstances.

    Its first jobs are processes of their own; it is killed after three of them, and goes on.
    """
    folder = tmp_path_factory.mktemp("rebuilt") / "a folder"
    folder.mkdir()
    project = Project(folder)
    circumstances = {
        "TZ": "Pacific/Kiritimati", "LC_ALL": "C", "PYTHONUTF8": "0", "PYTHONCOERCECLOCALE": "0",
        "PYTHONHASHSEED": "4711",
    }  # fmt: skip
    run = project.begin("--configfile", "config/smoke.yaml", **circumstances)
    while run.process.poll() is None and run.printed().count("Finished jobid") < 3:
        time.sleep(0.05)
    assert run.process.poll() is None, run.printed()
    run.kill()
    project.recover()
    done = project.smoke("--cores", "1", "all", begun_with=circumstances)
    assert done.returncode == 0, done.stdout
    return project


@pytest.fixture
def project(tmp_path):
    return Project(tmp_path)


def _existing(folder):
    project = object.__new__(Project)
    project.folder = folder
    return project


def _copied(project, folder):
    # the lock of a run of another process, which comes and goes, would stop a run of the copy
    shutil.copytree(project.folder, folder, ignore=shutil.ignore_patterns("locks"))
    return _existing(folder)


@pytest.fixture(scope="session")
def in_folder():
    """Return what runs the workflow in a folder that exists."""
    return _existing


@pytest.fixture(scope="session")
def copied():
    """Return what copies a project into a folder."""
    return _copied


@pytest.fixture
def smoked_copy(smoked, tmp_path):
    """Finished smoke run that a test may break."""
    return _copied(smoked[0], tmp_path / "copy")


@pytest.fixture(scope="session")
def studied(smoked, shared):
    """Finished smoke run on which the targets outside `all` were made too, and what it printed."""

    def make(folder):
        copy = _copied(smoked[0], folder)
        # a job with one thread starts no workers, each of which would import the libraries
        single = ("--cores", "2", "--max-threads", "1")
        return copy.studies("families", "beyond", "online", cores=single)

    return once(shared, "studied", make)
