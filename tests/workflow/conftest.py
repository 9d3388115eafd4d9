"""Builds that the tests look at: the paper, and smoke runs for what changes something."""

import fcntl
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
STUDIES = ("--snakefile", "workflow/studies/Snakefile")
#: Jobs print what they have in their logs.
ENVIRONMENT = os.environ | {
    "PATH": f"{Path(sys.executable).parent}{os.pathsep}{os.environ['PATH']}",
    "FPRC_MESSAGES": "all",
}


class Project:
    """A copy of the workflow in a folder of its own, run with the installed package."""

    def __init__(self, folder: Path, *, new: bool = True):
        self.folder = folder
        if new:
            folder.mkdir(parents=True, exist_ok=True)
            for name in ("config", "profiles", "workflow"):
                shutil.copytree(ROOT / name, folder / name)
            shutil.copy(ROOT / "Snakefile", folder)

    def run(self, *command: str, **environment: str) -> subprocess.CompletedProcess:
        return subprocess.run(
            command, cwd=self.folder, env=ENVIRONMENT | environment, stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT, text=True, timeout=1800,
        )  # fmt: skip

    def snakemake(self, *arguments: str, **environment: str) -> subprocess.CompletedProcess:
        return self.run(*SNAKEMAKE, "--cores", "2", *arguments, **environment)

    def smoke(self, *arguments: str, **environment: str) -> subprocess.CompletedProcess:
        return self.snakemake(*arguments, "--configfile", "config/smoke.yaml", **environment)

    def planned(self, *arguments: str, **environment: str) -> dict[str, int]:
        """Jobs of a dry run, by rule."""
        done = self.snakemake("--dry-run", *arguments, **environment)
        assert done.returncode == 0, done.stdout
        counts = re.findall(r"^(\w+) +(\d+)$", done.stdout, flags=re.MULTILINE)
        return {rule: int(count) for rule, count in counts if rule != "total"}

    def rules(self, *arguments: str) -> set[str]:
        return set(self.snakemake("--list-rules", *arguments).stdout.split())

    def killed(self, jobs: int, seconds: float = 0.0, **environment: str) -> int | None:
        """Kill a smoke run some time after so many jobs have ended; return its code if it ended.

        Then recover by the command of the docs, word by word.
        """
        output = self.folder / "printed.txt"
        with output.open("w") as file:
            run = subprocess.Popen(
                [*SNAKEMAKE, "--cores", "2", "all", "--configfile", "config/smoke.yaml"],
                cwd=self.folder, env=ENVIRONMENT | environment, stdout=file,
                stderr=subprocess.STDOUT, start_new_session=True,
            )  # fmt: skip
        while run.poll() is None and output.read_text().count("Finished jobid") < jobs:
            time.sleep(0.05)
        with suppress(subprocess.TimeoutExpired):
            run.wait(seconds)
        status = run.poll()
        with suppress(ProcessLookupError):
            os.killpg(run.pid, signal.SIGKILL)
        run.wait(60)
        text = (ROOT / "docs/running.md").read_text(encoding="utf-8")
        done = self.run(*re.search("After a kill, run `(snakemake [^`]+)`", text)[1].split())
        assert done.returncode == 0, done.stdout
        return status

    def differences_but_times(self, first: "Project") -> str:
        """Make a smoke run again with the measured times of another; say which files differ."""
        ours, theirs = (project.folder / "results/smoke" for project in (self, first))
        for times in (theirs / "timing").glob("times*.json"):
            shutil.copy(times, ours / "timing")
        done = self.smoke("all")
        assert done.returncode == 0, done.stdout
        diff = ["diff", "--recursive", "--brief", "--exclude", "logs", theirs, ours]
        return subprocess.run(diff, capture_output=True, text=True, check=False).stdout

    def files(self, *folders: str) -> dict[str, bytes]:
        return {
            str(path.relative_to(self.folder)): path.read_bytes()
            for folder in folders
            for path in sorted((self.folder / folder).rglob("*"))
            if path.is_file()
        }

    def copy(self, folder: Path) -> "Project":
        # the lock of a run of another process, which comes and goes, would stop a run of the copy
        shutil.copytree(self.folder, folder, ignore=shutil.ignore_patterns("locks"))
        return Project(folder, new=False)


@pytest.fixture(scope="session")
def built(tmp_path_factory):
    """Return what makes a project once, by its name, and gives it and what the run printed.

    Several processes share them below FPRC_SMOKED.
    """
    shared = Path(os.environ.get("FPRC_SMOKED") or tmp_path_factory.mktemp("shared"))

    def once(name, make) -> tuple[Project, str]:
        folder, printed = shared / name, shared / f"{name}.txt"
        with (shared / f"{name}.lock").open("w") as lock:
            fcntl.flock(lock, fcntl.LOCK_EX)
            if not printed.exists():
                shutil.rmtree(folder, ignore_errors=True)
                done = make(folder)
                assert done.returncode == 0, done.stdout
                printed.write_text(done.stdout, encoding="utf-8")
        return Project(folder, new=False), printed.read_text(encoding="utf-8")

    return once


@pytest.fixture(scope="session")
def paper(built):
    """The paper itself, with the words of README.md, and what the run printed. Read only."""
    return built("paper", lambda folder: Project(folder).snakemake("all"))


@pytest.fixture(scope="session")
def smoked(built):
    """Project with a finished smoke run, with the words of docs/running.md. Read only."""
    smoke = ("--workflow-profile", "smoke", "all")
    return built("smoked", lambda folder: Project(folder).snakemake(*smoke))[0]


@pytest.fixture(scope="session")
def studied(smoked, built):
    """Smoke run on which the studies were made too, and what that printed."""
    # a job with one thread starts no workers, each of which would import the libraries
    asked = (*STUDIES, "families", "beyond", "online", "--max-threads", "1")
    return built("studied", lambda folder: smoked.copy(folder).smoke(*asked))


@pytest.fixture
def project(tmp_path):
    return Project(tmp_path)


@pytest.fixture
def smoked_copy(smoked, tmp_path):
    """Finished smoke run that a test may break."""
    return smoked.copy(tmp_path / "copy")


@pytest.fixture(scope="session")
def in_folder():
    """Return what runs the workflow in a folder that exists."""
    return lambda folder: Project(folder, new=False)
