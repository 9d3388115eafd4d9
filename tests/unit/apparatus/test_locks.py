import os
import subprocess
import sys
from functools import partial

import pytest

from fprc.apparatus.hardware import HardwareRig
from fprc.apparatus.locks import locked
from fprc.errors import DeviceError

#: Of this process alone: other tests run beside it.
BOARDS = [f"BOARD{k}-{os.getpid()}" for k in range(3)]


def test_board_is_had_by_one_at_a_time():
    with locked(BOARDS[:2]):
        with pytest.raises(DeviceError, match=f"{BOARDS[1]} is in use"), locked([BOARDS[1]]):
            pass
        # one that was free is released if another is in use
        with pytest.raises(DeviceError, match="is in use"), locked(reversed(BOARDS)):
            pass
        with locked([BOARDS[2]]):
            pass
    with locked(BOARDS):
        pass


@pytest.mark.parametrize("system", ["darwin", "win32"])
def test_boards_are_refused_on_a_system_that_cannot_drive_them(monkeypatch, system):
    monkeypatch.setattr(sys, "platform", system)
    with pytest.raises(DeviceError, match="only from Linux"), locked(BOARDS):
        pass


@pytest.mark.parametrize("inherits", [True, False])
def test_only_a_process_that_inherits_a_lock_holds_it_after_the_other_has_gone(inherits):
    with locked(BOARDS[:1]) as files:
        heir = subprocess.Popen(["sleep", "60"], pass_fds=files if inherits else ())
    try:
        free = locked(BOARDS[:1])
        if inherits:
            with pytest.raises(DeviceError, match="in use"), free:
                pass
        else:
            with free:
                pass
    finally:
        heir.kill()
        heir.wait()
    with locked(BOARDS[:1]):
        pass


def test_rig_that_is_opened_from_a_program_has_its_boards_alone(bench, settings):
    clock = {"sleep": bench.wait, "now": bench.elapsed}
    build = partial(HardwareRig, settings["hardware"], bench.elapsed, **clock)
    rig = build()
    calls = bench.shared.calls
    with pytest.raises(DeviceError, match=r"AIO00\d-\d+ is in use"):
        build()
    assert bench.shared.calls == calls
    rig.close()
    build().close()
