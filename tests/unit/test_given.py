"""Whatever a user names in place of a file: it is opened, or refused at once."""

import os

import pytest

from fprc.errors import ConfigError, FprcError
from fprc.given import open_given, read_given


@pytest.mark.parametrize("name", ["none", "file/more", "folder", "loop", "a\0b", "pipe", "endless"])
def test_all_but_a_file_is_refused(name, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "file").write_bytes(b"content")
    (tmp_path / "folder").mkdir()
    os.mkfifo("pipe")
    os.symlink("loop", "loop")
    os.symlink("/dev/zero", "endless")
    with pytest.raises(ConfigError, match=name.replace("\0", r"\\x00")):
        open_given(name, error=ConfigError)


def test_large_file_is_refused_unread(tmp_path):
    (tmp_path / "file").write_bytes(b"content")
    assert read_given(tmp_path / "file", most_bytes=7) == b"content"
    with pytest.raises(FprcError, match="file: has 7 bytes"):
        read_given(tmp_path / "file", most_bytes=6)
