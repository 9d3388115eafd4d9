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


@needs_git
def test_code_is_dirty_from_the_first_change_until_it_is_committed(tmp_path, monkeypatch):
    package = tmp_path / "project/package"
    package.mkdir(parents=True)
    module = package / "__init__.py"
    module.write_text("", encoding="utf-8")
    git(tmp_path, "init", "--quiet", "project")
    assert commit_of(package).startswith("unknown")
    for text in ("x = 1\n", "x = 2\n"):
        module.write_text(text, encoding="utf-8")
        git(package, "add", ".")
        git(package, "commit", "--quiet", "--message", text)
        commit = commit_of(package)
        assert git(package, "rev-parse", "HEAD").startswith(commit)
        assert len(commit) == 12
        module.write_text("changed\n", encoding="utf-8")
        assert commit_of(package) == f"{commit}-dirty"
    monkeypatch.setenv("PATH", str(tmp_path))  # where there is no git
    assert commit_of(package).startswith("unknown")


def test_hash_of_settings_does_not_depend_on_the_order_of_keys():
    settings = {"seed": 1, "rig": {"drift": [{"x": 0.1, "y": "a"}], "valve": None}}
    turned = {"rig": {"valve": None, "drift": [{"y": "a", "x": 0.1}]}, "seed": 1}
    assert hash_of(turned) == hash_of(settings) != hash_of(settings | {"seed": 2})
