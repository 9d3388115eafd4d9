"""Whatever a user names in place of a file: it is opened, or refused at once."""

import os

import pytest

from fprc.errors import ConfigError, FprcError
from fprc.given import open_given, read_given


@pytest.fixture
def inside(tmp_path, monkeypatch):
    """A folder with a file, a link to it, and what is no file."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / "file").write_bytes(b"content")
    (tmp_path / "folder").mkdir()
    os.mkfifo("pipe")
    for name, target in {
        "link": "file", "loop": "loop", "nowhere": "none", "endless": "/dev/zero", "to pipe": "pipe"
    }.items():  # fmt: skip
        os.symlink(target, name)
    return tmp_path


@pytest.mark.parametrize(
    "name", ["none", "file/more", "folder", "loop", "x" * 300, "a\0b", "pipe", "to pipe", "endless"]
)
def test_all_else_is_refused(inside, name):
    for read in (open_given, read_given):
        with pytest.raises(ConfigError) as no:
            read(name, error=ConfigError)
        assert (name or "''").encode("unicode_escape").decode() in str(no.value)


def test_large_file_is_refused_unread(inside):
    assert read_given("file", most_bytes=7) == b"content"
    with pytest.raises(FprcError, match="file: has 7 bytes; must have at most 6"):
        read_given("file", most_bytes=6)
