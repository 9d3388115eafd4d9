"""A release of a smoke run: the archive, the packages, refusals."""

import shutil
import subprocess
import zipfile
from pathlib import Path

import pytest

from tools import release

ROOT = Path(__file__).parents[2]
TOOLS = ROOT / ".venv/release/bin/python"
SMOKE = ["--configfile", "config/smoke.yaml"]
VERSION = "99.0"

pytestmark = pytest.mark.slow


def git(folder, *arguments):
    who = ["-c", "user.name=test", "-c", "user.email=test@localhost", "-c", "commit.gpgsign=false"]
    done = subprocess.run(
        ["git", *who, *arguments], cwd=folder, check=True, capture_output=True, text=True
    )
    return done.stdout


@pytest.fixture
def copying(smoked, monkeypatch):
    """Copy the results of the smoke run instead of running the workflow."""

    def build(clone, circumstances, *arguments):
        assert (circumstances[0], list(arguments)) == ("2", SMOKE)
        shutil.copytree(smoked[0].folder / "results/smoke", clone / "results/smoke")
        (clone / "src/fprc/__pycache__").mkdir()
        (clone / "src/fprc/__pycache__/compiled").write_text("")

    monkeypatch.setattr(release.twice, "build", build)


@pytest.fixture
def no_tools(copying, monkeypatch):
    """Leave out the tools; the last test has them."""
    monkeypatch.setattr(release, "build_packages", lambda *_: None)


@pytest.fixture
def clone(tmp_path, monkeypatch):
    """The checkout of a version, which a test may break."""
    folder = tmp_path / "clone"
    for name in filter(None, git(ROOT, "ls-files", "-z").split("\0")):
        if (ROOT / name).is_file():
            (folder / name).parent.mkdir(parents=True, exist_ok=True)
            shutil.copy2(ROOT / name, folder / name)
    for name, old, new in (
        (release.CHANGELOG, "## Unreleased", f"## Unreleased\n\n## {VERSION} (2030-01-02)"),
        (release.VERSION, release.version_of(folder), VERSION),
    ):
        text = (folder / name).read_text(encoding="utf-8")
        (folder / name).write_text(text.replace(old, new, 1), encoding="utf-8")
    git(folder, "init", "--quiet")
    git(folder, "add", "--all")
    git(folder, "commit", "--quiet", "--message", "Release")
    monkeypatch.chdir(folder)
    return folder


@pytest.mark.usefixtures("no_tools")
def test_archive_has_the_files_of_the_commit_and_the_results(clone, smoked, capsys):
    assert release.main(SMOKE) == 0
    assert "git tag -a v99.0" in capsys.readouterr().out
    with zipfile.ZipFile(clone / f"dist/{VERSION}/fprc-{VERSION}.zip") as archive:
        held = {name: archive.read(name) for name in archive.namelist()}
        assert len(held) == len(archive.namelist())
    results = {
        str(path.relative_to(smoked[0].folder))
        for path in (smoked[0].folder / "results/smoke").rglob("*")
        if path.is_file() and "logs" not in path.parts
    }
    tracked = {name for name in git(clone, "ls-files").splitlines() if (clone / name).is_file()}
    assert held.keys() == results | tracked
    assert {"results/smoke/raw/sweep.h5", "results/smoke/digests/claims.json.sha256"} <= results
    assert "src/fprc/logs/__init__.py" in tracked
    assert held["README.md"] == (clone / "README.md").read_bytes()


@pytest.mark.usefixtures("no_tools")
def test_everything_that_forbids_a_release_is_said_at_once(clone, capsys):
    path = clone / "src/fprc/__init__.py"
    path.write_text(path.read_text().replace(VERSION, "99.1"))
    git(clone, "tag", "v99.1")
    (clone / "dist/99.1").mkdir(parents=True)
    assert release.main(SMOKE) == 1
    printed = capsys.readouterr().err
    for what in ("uncommitted", "CHANGELOG.md", "tag v99.1", "dist/99.1"):
        assert what in printed
    assert list((clone / "dist").rglob("*")) == [clone / "dist/99.1"]


@pytest.mark.usefixtures("no_tools")
def test_nothing_is_left_when_a_tool_refuses(clone, monkeypatch):
    monkeypatch.setattr(release, "build_packages", lambda *_: subprocess.run(["false"], check=True))
    assert release.main(SMOKE) == 1
    assert list((clone / "dist").iterdir()) == []


@pytest.mark.skipif(not TOOLS.exists(), reason="the tools that `make release-tools` installs")
@pytest.mark.usefixtures("copying")
def test_tools_accept_the_packages(clone):
    assert release.main(["--tools", str(TOOLS), *SMOKE]) == 0
    assert sorted(path.name for path in (clone / f"dist/{VERSION}").iterdir()) == [
        f"fprc-{VERSION}-py3-none-any.whl",
        f"fprc-{VERSION}.tar.gz",
        f"fprc-{VERSION}.zip",
    ]
