import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]

#: What holds times, or is made from them; and what the second build is not asked for.
TIMED = (
    "/timing/",
    "/logs/",
    "fig10_",
    "claims.",
    "report.html",
    "sweeps/epsilon",
    "sweeps/n_c",
    "/sweeps_",
)


class Project:
    """A copy of the workflow in a folder of its own, run with the installed package."""

    def __init__(self, folder: Path):
        self.folder = folder
        for name in ("Snakefile", "all"):
            shutil.copy(ROOT / name, folder)
        for name in ("config", "profiles", "workflow"):
            shutil.copytree(ROOT / name, folder / name)

    def snakemake(self, *arguments: str) -> subprocess.CompletedProcess:
        return self.run([sys.executable, "-m", "snakemake", "--cores", "2", *arguments])

    def run(self, command: list[str], timeout_s: float = 600) -> subprocess.CompletedProcess:
        path = f"{Path(sys.executable).parent}{os.pathsep}{os.environ['PATH']}"
        return subprocess.run(
            command,
            cwd=self.folder,
            env=os.environ | {"PATH": path},
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            text=True,
            timeout=timeout_s,
        )

    def smoke(self, *arguments: str) -> subprocess.CompletedProcess:
        return self.snakemake(*arguments, "--configfile", "config/smoke.yaml")

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


@pytest.fixture(scope="session")
def smoked(tmp_path_factory):
    """Project with a finished smoke run, and what the run printed. Read only."""
    project = Project(tmp_path_factory.mktemp("smoked"))
    # the words in this order are in the README; see the file `all`
    done = project.snakemake("--configfile", "config/smoke.yaml", "all")
    assert done.returncode == 0, done.stdout
    return project, done.stdout


@pytest.fixture
def project(tmp_path):
    return Project(tmp_path)


def _copied(project, folder):
    shutil.copytree(project.folder, folder)
    copy = object.__new__(Project)
    copy.folder = folder
    return copy


@pytest.fixture
def smoked_copy(smoked, tmp_path):
    """Finished smoke run that a test may break."""
    return _copied(smoked[0], tmp_path / "copy")


@pytest.fixture(scope="session")
def calibrated(smoked, tmp_path_factory):
    """Finished smoke run on which the targets outside `all` were made too, and what it printed."""
    copy = _copied(smoked[0], tmp_path_factory.mktemp("calibrated") / "copy")
    # and a sweep again, in chunks this time
    (copy.folder / "results/smoke/sweeps/taps.json").unlink()
    targets = ["ensemble", "targets", "sensitivity", "calibrate"]
    done = copy.smoke(*targets, "results/smoke/sweeps/taps.json", "--config", "sweeps={chunks: 3}")
    assert done.returncode == 0, done.stdout
    return copy, done.stdout
