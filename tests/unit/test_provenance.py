import os
import shutil
import subprocess

import pytest

from fprc.provenance import commit_of, hash_of

needs_git = pytest.mark.skipif(shutil.which("git") is None, reason="no git here")


@pytest.fixture(autouse=True)
def no_settings_of_the_user(monkeypatch):
    for name in [name for name in os.environ if name.startswith("GIT_")]:
        monkeypatch.delenv(name)
    monkeypatch.setenv("GIT_CONFIG_GLOBAL", os.devnull)
    monkeypatch.setenv("GIT_CONFIG_NOSYSTEM", "1")
    for role in ("AUTHOR", "COMMITTER"):
        monkeypatch.setenv(f"GIT_{role}_NAME", "Test")
        monkeypatch.setenv(f"GIT_{role}_EMAIL", "test@example.org")


def git(folder, *arguments):
    return subprocess.check_output(["git", "-C", folder, *arguments], text=True).strip()


def add_package(folder):
    folder.mkdir(parents=True)
    (folder / "__init__.py").write_text("", encoding="utf-8")
    (folder / "module.py").write_text("x = 1\n", encoding="utf-8")
    return folder


@pytest.fixture
def repository(tmp_path):
    """A repository with one commit, in which results/ and .venv/ are ignored."""
    root = tmp_path / "project"
    add_package(root / "src" / "package")
    (root / ".gitignore").write_text("results/\n.venv/\n", encoding="utf-8")
    git(tmp_path, "init", "--quiet", "project")
    git(root, "add", ".")
    git(root, "commit", "--quiet", "--message", "First")
    return root


@needs_git
def test_code_is_dirty_from_the_first_change_until_it_is_committed(repository):
    package = repository / "src" / "package"
    first = commit_of(package)
    assert git(repository, "rev-parse", "HEAD").startswith(first)
    assert len(first) == 12
    (package / "module.py").write_text("x = 2\n", encoding="utf-8")
    assert commit_of(package) == f"{first}-dirty"
    git(repository, "add", ".")
    assert commit_of(package) == f"{first}-dirty"
    git(repository, "commit", "--quiet", "--message", "Second")
    second = commit_of(package)
    assert git(repository, "rev-parse", "HEAD").startswith(second)
    (package / "module.py").unlink()
    assert commit_of(package) == f"{second}-dirty"


@needs_git
def test_package_outside_git_or_in_an_ignored_folder_has_no_commit(repository, monkeypatch):
    for folder in (repository.parent / "package", repository / ".venv/site-packages/package"):
        assert commit_of(add_package(folder)).startswith("unknown")
    monkeypatch.setenv("PATH", str(repository))  # where there is no git
    assert commit_of(repository / "src/package").startswith("unknown")


def test_hash_of_settings_does_not_depend_on_the_order_of_keys():
    settings = {"seed": 1, "rig": {"drift": [{"x": 0.1, "y": "a"}], "valve": None}}
    turned = {"rig": {"valve": None, "drift": [{"y": "a", "x": 0.1}]}, "seed": 1}
    assert hash_of(turned) == hash_of(settings) != hash_of(settings | {"seed": 2})
