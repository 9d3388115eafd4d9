import shutil
import subprocess

import pytest

from fprc.artifacts import commit_of


@pytest.mark.skipif(shutil.which("git") is None, reason="no git here")
def test_code_is_dirty_from_a_change_until_it_is_committed(tmp_path, monkeypatch):
    def git(*arguments):
        user = ["-c", "user.name=Test", "-c", "user.email=test@example.org"]
        command = ["git", "-C", tmp_path, *user, *arguments]
        return subprocess.check_output(command, text=True).strip()

    for name in ("GIT_DIR", "GIT_INDEX_FILE", "GIT_WORK_TREE"):  # of a hook
        monkeypatch.delenv(name, raising=False)
    package = tmp_path / "package"
    package.mkdir()
    (package / "__init__.py").write_text("", encoding="utf-8")
    git("init", "--quiet")
    assert commit_of(package).startswith("unknown")
    git("add", ".")
    git("commit", "--quiet", "--message", "first")
    commit = commit_of(package)
    assert git("rev-parse", "HEAD").startswith(commit)
    assert len(commit) == 12
    (package / "__init__.py").write_text("changed", encoding="utf-8")
    assert commit_of(package) == f"{commit}-dirty"
    monkeypatch.setenv("PATH", str(tmp_path))  # where there is no git
    assert commit_of(package).startswith("unknown")
