import os
import shutil
import subprocess
import sys

import pytest

from fprc.apparatus.contec import Board, locked
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


@pytest.mark.skipif(shutil.which("cc") is None, reason="no C compiler, cc")
@pytest.mark.parametrize("name", ["", "/none/lib\0caio.so", "other.so"])
def test_missing_or_wrong_library_is_named_with_its_setting(tmp_path, monkeypatch, name):
    source = tmp_path / "other.c"
    source.write_text("long AioInit(void) { return 0; }\n")
    subprocess.run(["cc", "-shared", "-fPIC", "-o", tmp_path / "other.so", source], check=True)
    with pytest.raises(DeviceError, match="hardware.boards.library"):
        Board(name and str(tmp_path / name), "AIO000", "Ai")


def boards(*numbers):
    """Return the settings of boards of this process alone: other tests run beside it."""
    names = (f"BOARD{k}-{os.getpid()}" for k in numbers)
    return {"boards": dict(zip(("input_device", "output_device"), names, strict=True))}


def test_board_is_had_by_one_at_a_time():
    with locked(boards(0, 1)):
        # one that was free is released if another is in use
        for numbers in ((1, 2), (2, 1)):
            with pytest.raises(DeviceError, match="BOARD1-.* in use"), locked(boards(*numbers)):
                pass
        with locked(boards(2, 3)):
            pass
    with locked(boards(0, 1)):
        pass


def test_boards_are_refused_on_a_system_that_cannot_drive_them(monkeypatch):
    monkeypatch.setattr(sys, "platform", "win32")
    with pytest.raises(DeviceError, match="only from Linux"), locked(boards(0, 1)):
        pass


@pytest.mark.parametrize("inherits", [True, False])
def test_only_a_process_that_inherits_a_lock_holds_it_after_the_other_has_gone(inherits):
    with locked(boards(0, 1)) as files:
        heir = subprocess.Popen(["sleep", "60"], pass_fds=files if inherits else ())
    free = True
    try:
        with locked(boards(0, 1)):
            pass
    except DeviceError:
        free = False
    finally:
        heir.kill()
        heir.wait()
    assert free is not inherits
    with locked(boards(0, 1)):
        pass
