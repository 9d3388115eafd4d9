"""`tools/release.sh`: what it refuses, and the archive and packages of a smoke run."""

import os
import shutil
import subprocess
import tarfile
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
TOOLS = ROOT / ".venv/release/bin/python"
VERSION = "99.0"

pytestmark = pytest.mark.slow


def git(folder, *arguments):
    who = ["-c", "user.name=test", "-c", "user.email=test@localhost", "-c", "commit.gpgsign=false"]
    asked = ["git", *who, *arguments]
    return subprocess.run(asked, cwd=folder, check=True, capture_output=True, text=True).stdout


@pytest.fixture
def clone(tmp_path):
    """The checkout of a version, which a test may break."""
    folder = tmp_path / "clone"
    for name in filter(None, git(ROOT, "ls-files", "-z").split("\0")):
        if (ROOT / name).is_file():
            (folder / name).parent.mkdir(parents=True, exist_ok=True)
            shutil.copy2(ROOT / name, folder / name)
    version, changelog = folder / "src/fprc/__init__.py", folder / "CHANGELOG.md"
    version.write_text(f'"""A version."""\n\n__version__ = "{VERSION}"\n')
    heading = f"## Unreleased\n\n## {VERSION} (2030-01-02)"
    changelog.write_text(changelog.read_text("utf-8").replace("## Unreleased", heading, 1), "utf-8")
    git(folder, "init", "--quiet")
    git(folder, "add", "--all")
    git(folder, "commit", "--quiet", "--message", "Release")
    return folder


def release(folder, **options):
    """Run ``tools/release.sh`` with the libraries and tools of this checkout."""
    environment = os.environ | {"TOOLS": str(TOOLS)} | options
    return subprocess.run(["tools/release.sh"], cwd=folder, env=environment, capture_output=True)


@pytest.mark.parametrize("wrong", ["uncommitted", "no heading", "tag", "dist"])
def test_what_forbids_a_release_stops_it_before_anything_is_made(clone, wrong):
    if wrong == "uncommitted":
        (clone / "new").touch()
    elif wrong == "tag":
        git(clone, "tag", f"v{VERSION}")
    elif wrong == "dist":
        (clone / "dist").mkdir()
    else:
        shutil.copy2(ROOT / "CHANGELOG.md", clone)
        git(clone, "commit", "--quiet", "--all", "--message", "No heading")
    assert release(clone).returncode != 0
    assert list((clone / "dist").rglob("*")) == []


@pytest.mark.skipif(not TOOLS.exists(), reason="the tools that `tools/release.sh` installs")
def test_archive_and_packages_of_a_smoke_run(clone):
    done = release(clone, SMOKE="--workflow-profile smoke")
    assert done.returncode == 0, done.stderr.decode()
    name = f"fprc-{VERSION}"
    archive, *packages = sorted(clone.glob("dist/*with-results.tar.gz"))
    assert packages == []
    made = {path.name for path in (clone / "dist").iterdir()} - {archive.name}
    assert made == {f"{name}.tar.gz", f"{name}-py3-none-any.whl"}
    with tarfile.open(archive) as packed:
        held = {member.name for member in packed.getmembers()}
    assert {"README.md", "results/smoke/raw/sweep.h5", "results/smoke/report.html"} <= held
    assert not any("/logs/" in name for name in held if name.startswith("results"))
