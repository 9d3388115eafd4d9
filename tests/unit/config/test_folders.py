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


@pytest.mark.parametrize("key", ["raw", "results"])
@pytest.mark.parametrize(
    ("folder", "reason"),
    [
        ("/", "contains it"),
        ("//", "contains it"),
        (".", "is the project's folder"),
        ("..", "contains it"),
        ("../..", "contains it"),
        ("{project}", "is the project's folder"),
        ("{project}/..", "contains it"),
        ("../project", "is the project's folder"),
        ("{home}", "is your home folder"),
        ("src", "is in src"),
        ("config", "is in config"),
        ("tests/out", "is in tests"),
        ("{project}/docs/images", "is in docs"),
        ("results/../workflow", "is in workflow"),
        (".git", "is in .git"),
        (".snakemake/x", "is in .snakemake"),
        ("./.venv", "is in .venv"),
        ("a\0b", "contains the character NUL"),
        ("a\nb", "cannot be printed"),
        ("a\x1b[31mb", "cannot be printed"),
        ("a\u2028b", "cannot be printed"),
        ("a{b}", "a brace"),
        ("a}", "a brace"),
        (" a", "a blank"),
        ("a /b", "a blank"),
        (" ", "a blank"),
        ("~", "begins with ~"),
        ("~/results", "begins with ~"),
        ("-rf", "begins with -"),
    ],
)
def test_folder_that_would_do_harm_is_refused_with_a_reason(project, key, folder, reason):
    places = {"{project}": str(project), "{home}": os.environ["HOME"]}
    for name, place in places.items():
        folder = folder.replace(name, place)
    message = refused(**{key: folder})
    assert message.startswith(f"1 error in the configuration:\n  folders.{key}: ")
    assert reason in message
    assert len(message.splitlines()) == 2
    assert message.replace("\n", "").isprintable()
    assert len(message) < 300


def test_every_reason_is_given_at_once():
    message = refused(raw="src/{x\n", results="~")
    assert message.startswith("2 errors in the configuration:\n")
    for reason in ("a brace", "cannot be printed", "is in src", "begins with ~"):
        assert reason in message


@pytest.mark.parametrize(
    ("raw", "results", "reason"),
    [
        ("results", "results", "raw and results are both results"),
        ("a/../results", "results", "each its own folder"),
        ("{here}/results", "results", "each its own folder"),
        ("mine", "mine/results", "is inside raw = mine"),
        ("data/raw", "{here}/data/raw/x", "is inside raw = data/raw"),
        ("results/data", "results", "use results/raw"),
        ("out/mine", "{here}/out", "/out/raw"),
    ],
)
def test_raw_logs_and_results_that_would_mix_are_refused(project, raw, results, reason):
    raw, results = (folder.replace("{here}", str(project)) for folder in (raw, results))
    message = refused(raw=raw, results=results)
    assert message.startswith("1 error in the configuration:\n  folders: ")
    assert reason in message


@pytest.mark.parametrize(
    ("raw", "results"),
    [
        ("data/raw", "results"),
        ("results/smoke/raw", "results/smoke"),
        ("results/mine/raw", "results"),
        ("mylogs", "results/mine"),
        ("data/raw", "results/blocked"),
        ("/mnt/disk/raw", "/mnt/disk/results"),
        ("../logs", "../results of mine"),
        ("raw-2026.05", "Ergebnisse/für Lösung 3"),
        ("raw", "results, second; it's a try"),
        ("configs", "source"),
        ("data/.hidden", "out/src"),
    ],
)
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
