import errno
import logging
import os
import subprocess
import sys
from functools import partial
from pathlib import Path
from types import SimpleNamespace

import pytest

from fprc.devices import locks
from fprc.devices.hardware import HardwareRig
from fprc.devices.locks import locked
from fprc.errors import DeviceError

BOARDS = ["AIO000", "AIO001"]


def test_board_is_had_by_one_at_a_time_and_its_holder_named(tmp_path):
    with locked(BOARDS, str(tmp_path)):
        with (
            pytest.raises(DeviceError, match=rf"AIO001 is in use by process {os.getpid()} of user"),
            locked(["AIO001"], str(tmp_path)),
        ):
            pass
        with locked(["AIO002"], str(tmp_path)):
            pass
    with locked(BOARDS, str(tmp_path)):
        pass


@pytest.mark.parametrize("system", ["darwin", "win32"])
def test_boards_are_refused_on_a_system_that_cannot_drive_them(tmp_path, monkeypatch, system):
    monkeypatch.setattr(sys, "platform", system)
    with pytest.raises(DeviceError, match="only from Linux"), locked(BOARDS, str(tmp_path)):
        pass
    assert not list(tmp_path.iterdir())


def test_process_that_inherits_a_lock_holds_it_after_the_other_has_gone(tmp_path):
    with locked(["AIO000"], str(tmp_path)) as files:
        heir = subprocess.Popen(["sleep", "60"], pass_fds=files)
    try:
        with pytest.raises(DeviceError, match="in use"), locked(["AIO000"], str(tmp_path)):
            pass
    finally:
        heir.kill()
        heir.wait()
    with locked(["AIO000"], str(tmp_path)):
        pass


def test_lock_that_cannot_be_opened_is_no_leave_to_go_on(tmp_path):
    (tmp_path / "fprc-AIO000.lock").symlink_to(tmp_path / "elsewhere")
    with (
        pytest.raises(DeviceError, match=r"fprc-AIO000\.lock cannot be locked .*lock_folder"),
        locked(["AIO000"], str(tmp_path)),
    ):
        pass
    assert not (tmp_path / "elsewhere").exists()


@pytest.fixture
def folders(tmp_path, monkeypatch):
    """Copies of the folders of the system; ``deny(name, ...)`` makes some read-only for a user."""
    shared = {place.name: tmp_path / place.name for place in locks._SHARED}
    for folder in shared.values():
        folder.mkdir()
    monkeypatch.setattr(locks, "_SHARED", tuple(shared.values()))
    denied, real = set(), os.open

    def open_(path, flags, *mode):
        if flags & os.O_CREAT and Path(path).parent in denied:
            raise PermissionError(errno.EACCES, os.strerror(errno.EACCES))
        return real(path, flags, *mode)

    def deny(*names):
        denied.clear()
        denied.update(shared[name] for name in names)

    monkeypatch.setattr(os, "open", open_)
    return SimpleNamespace(**shared, deny=deny, shared=tuple(shared.values()))


@pytest.mark.parametrize("denied", [(), ("lock",), ("tmp",)])
def test_each_folder_of_the_system_that_can_be_written_has_a_lock(folders, denied, caplog):
    folders.deny(*denied)
    caplog.set_level(logging.INFO)
    with locked(BOARDS) as files:
        found = [folder.name for folder in folders.shared if list(folder.iterdir())]
        assert found == [name for name in ("lock", "tmp") if name not in denied]
        assert len(files) == 2 * len(found)
    assert len(caplog.messages) == len(denied)


@pytest.mark.parametrize("first", [(), ("lock",)])
@pytest.mark.parametrize("second", [(), ("lock",)])
def test_users_of_whom_one_cannot_write_everywhere_exclude_each_other(folders, first, second):
    folders.deny(*first)
    with locked(BOARDS):
        folders.deny(*second)
        with pytest.raises(DeviceError, match="AIO000 is in use by process"), locked(BOARDS):
            pass
    with locked(BOARDS):
        pass


@pytest.mark.parametrize("absent", [False, True])
def test_user_who_can_write_nowhere_is_refused_and_both_folders_are_named(folders, absent):
    folders.deny("lock", "tmp")
    for folder in folders.shared if absent else ():
        folder.rmdir()
    with pytest.raises(DeviceError, match=r"/lock.*/tmp.*lock_folder"), locked(BOARDS):
        pass


def test_rig_that_is_opened_from_a_program_has_its_boards_alone(bench, settings):
    clock = {"sleep": bench.wait, "now": bench.elapsed}
    build = partial(HardwareRig, settings["hardware"], bench.elapsed, **clock)
    rig = build()
    calls = bench.shared.calls
    with pytest.raises(DeviceError, match="AIO000 is in use by process"):
        build()
    assert bench.shared.calls == calls
    rig.close()
    build().close()
