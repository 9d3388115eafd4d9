import shutil
import subprocess

import pytest

from fprc.apparatus.contec import Board, load_library
from fprc.errors import DeviceError


@pytest.fixture
def library(bench, driver):
    return str(driver)


def test_boards_read_and_write_the_channels_asked_for(bench, library):
    bench.shared.inputs[:4] = [1.25, -10.0, 9.5, 7.0]
    board = Board(library, "AIO000", "Ai")
    assert list(board.read(3)) == [1.25, -10.0, 9.5]
    board = Board(library, "AIO001", "Ao")
    board.write(1, 2.5)
    board.write(0, -10.0)
    assert [row[1:] for row in bench.writes()] == [(1, 2.5), (0, -10.0)]
    assert list(bench.shared.outputs[:2]) == [-10.0, 2.5]


def test_board_is_reset_unless_its_outputs_must_hold(bench, library):
    Board(library, "AIO001", "Ao").close()
    calls = bench.shared.calls
    Board(library, "AIO001", "Ao", reset=False).close()
    assert bench.shared.calls - calls == calls - 1


@pytest.mark.parametrize(("code", "words"), [(20000, "\\ufffd+u"), (20001, "no description")])
def test_words_that_cannot_be_read_and_none_are_no_crash(bench, library, code, words):
    board = Board(library, "AIO000", "Ai")
    bench.fail(code=code)
    with pytest.raises(DeviceError, match=rf"failed with code {code} \({words}\)"):
        board.read(1)


@pytest.mark.skipif(shutil.which("cc") is None, reason="no C compiler, cc")
@pytest.mark.parametrize("name", ["", "/none/lib\0caio.so", "other.so"])
def test_missing_or_wrong_library_is_named_with_its_setting(tmp_path, monkeypatch, name):
    source = tmp_path / "other.c"
    source.write_text("long AioInit(void) { return 0; }\nlong AioExit(void) { return 0; }\n")
    subprocess.run(["cc", "-shared", "-fPIC", "-o", tmp_path / "other.so", source], check=True)
    monkeypatch.chdir(tmp_path)
    with pytest.raises(DeviceError, match="^driver .*caio|other") as caught:
        load_library(name and str(tmp_path / name))
    assert "hardware.boards.library" in str(caught.value)
