import os
import subprocess
from pathlib import Path

import pytest

from fprc.config import check
from fprc.config.folders import PROJECT_FOLDERS
from fprc.errors import ConfigError

ROOT = Path(__file__).parents[3]


def refused(**folders):
    with pytest.raises(ConfigError) as caught:
        check({"folders": folders})
    return str(caught.value)


@pytest.fixture
def project(tmp_path, monkeypatch):
    """The folder that commands are run in, below the home folder's."""
    home = tmp_path / "home"
    project = tmp_path / "work/project"
    for folder in (home, project):
        folder.mkdir(parents=True)
    monkeypatch.setenv("HOME", str(home))
    monkeypatch.chdir(project)
    return project


@pytest.mark.parametrize(
    "folder",
    ["/", ".", "..", "{project}", "../project", "{home}", "src", "tests/out", "{project}/docs/x",
     "results/../workflow", ".git", "./.venv", "a\nb", "a{b}", " a", "~/results", "-rf"],
)  # fmt: skip
def test_folder_that_would_do_harm_is_refused(project, folder):
    folder = (
        folder.format(project=project, home=os.environ["HOME"]) if "{b" not in folder else folder
    )
    first, *others = refused(raw=folder, results=folder).splitlines()
    assert first == "2 errors in the configuration:"
    assert [line.split(":")[0] for line in others] == ["  folders.raw", "  folders.results"]


@pytest.mark.parametrize(
    ("raw", "results", "reason"),
    [("results", "results", "raw and results are both results"),
     ("a/../results", "results", "each its own folder"),
     ("{here}/results", "results", "each its own folder"),
     ("mine", "mine/results", "is inside raw = mine"),
     ("data/raw", "{here}/data/raw/x", "is inside raw = data/raw"),
     ("results/data", "results", "use results/raw"), ("out/mine", "{here}/out", "/out/raw")],
)  # fmt: skip
def test_raw_logs_and_results_that_would_mix_are_refused(project, raw, results, reason):
    raw, results = (folder.replace("{here}", str(project)) for folder in (raw, results))
    message = refused(raw=raw, results=results)
    assert message.startswith("1 error in the configuration:\n  folders: ")
    assert reason in message


@pytest.mark.parametrize(
    ("raw", "results"),
    [("data/raw", "results"), ("results/smoke/raw", "results/smoke"),
     ("results/mine/raw", "results"), ("mylogs", "results/mine"), ("data/raw", "results/blocked"),
     ("/mnt/disk/raw", "/mnt/disk/results"), ("../logs", "../results of mine"),
     ("raw-2026.05", "Ergebnisse/für Lösung 3"), ("raw", "results, second; it's a try"),
     ("configs", "source"), ("data/.hidden", "out/src")],
)  # fmt: skip
def test_folders_that_do_no_harm_are_taken_as_they_are(project, raw, results):
    folders = check({"folders": {"raw": raw, "results": results}}).folders
    assert (folders.raw, folders.results) == (raw, results)


def test_own_folders_are_those_of_the_repository():
    listed = subprocess.run(["git", "ls-files"], cwd=ROOT, capture_output=True, text=True)
    if listed.returncode:
        pytest.skip("not in a git repository")
    folders = {line.split("/")[0] for line in listed.stdout.splitlines() if "/" in line}
    hidden = {name for name in folders if name.startswith(".")}
    assert folders - hidden - {"data", "results"} == PROJECT_FOLDERS
