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
    """The folder that commands are run in."""
    (tmp_path / "work/project").mkdir(parents=True)
    monkeypatch.chdir(tmp_path / "work/project")
    return tmp_path / "work/project"


@pytest.mark.parametrize(
    "folder",
    ["/", ".", "..", "HERE", "../project", "src", "tests/out", "HERE/docs/x", ".git", "./.venv",
     "results/../workflow", "a\nb", "a{b}", " a", "~/results", "-rf"],
)  # fmt: skip
def test_folder_that_would_do_harm_is_refused(project, folder):
    folder = folder.replace("HERE", str(project))
    first, *others = refused(raw=folder, results=folder).splitlines()
    assert first == "2 errors in the configuration:"
    assert [line.split(":")[0] for line in others] == ["  folders.raw", "  folders.results"]


@pytest.mark.parametrize(
    ("raw", "results", "mixed"),
    [("results", "results", True), ("a/../results", "results", True),
     ("HERE/results", "results", True), ("mine", "mine/results", True),
     ("data/raw", "HERE/data/raw/x", True), ("results/data", "results", True),
     ("data/raw", "results", False), ("results/mine/raw", "results", False),
     ("mylogs", "results/mine", False), ("/mnt/disk/raw", "/mnt/disk/results", False),
     ("../logs", "../results of mine", False), ("raw-2026.05", "für Lösung, it's 3", False),
     ("configs", "source", False), ("data/.hidden", "out/src", False)],
)  # fmt: skip
def test_raw_logs_and_results_may_be_anywhere_but_must_not_mix(project, raw, results, mixed):
    raw, results = (folder.replace("HERE", str(project)) for folder in (raw, results))
    if mixed:
        assert "\n  folders: " in refused(raw=raw, results=results)
    else:
        folders = check({"folders": {"raw": f"./{raw}" if raw[0].isalpha() else raw,
                                     "results": f"{results}/"}}).folders  # fmt: skip
        assert (folders.raw, folders.results) == (raw, results)


def test_own_folders_are_those_of_the_repository():
    listed = subprocess.run(["git", "ls-files"], cwd=ROOT, capture_output=True, text=True)
    if listed.returncode:
        pytest.skip("not in a git repository")
    folders = {line.split("/")[0] for line in listed.stdout.splitlines() if "/" in line}
    hidden = {name for name in folders if name.startswith(".")}
    assert folders - hidden - {"data", "results"} == PROJECT_FOLDERS
