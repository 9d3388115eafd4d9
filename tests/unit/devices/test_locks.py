import errno
import os
import subprocess
import sys

import pytest

from fprc.devices import locks
from fprc.devices.hardware import HardwareRig
from fprc.devices.locks import locked, write_holder
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


def test_board_that_is_in_use_leaves_the_other_free(tmp_path):
    with locked(["AIO001"], str(tmp_path)), pytest.raises(DeviceError), locked(BOARDS, tmp_path):
        pass
    with locked(["AIO000"], str(tmp_path)):
        pass


def test_holder_of_a_lock_is_shown_without_control_characters(tmp_path):
    with locked(["AIO000"], str(tmp_path)) as files:
        write_holder(files, " \x1b[31m(drives the rig)")
        with (
            pytest.raises(DeviceError) as caught,
            locked(["AIO000"], str(tmp_path)),
        ):
            pass
    assert f"process {os.getpid()} \\x1b[31m(drives the rig) of user" in str(caught.value)


def test_lock_ends_with_the_process_that_held_it(tmp_path):
    code = (
        "import os, sys; from fprc.devices.locks import locked\n"
        f"with locked(['AIO000'], {str(tmp_path)!r}): os.kill(os.getpid(), 9)"
    )
    subprocess.run([sys.executable, "-c", code], check=False)
    with locked(["AIO000"], str(tmp_path)):
        pass


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


def test_lock_can_be_written_by_every_user_whatever_the_umask(tmp_path):
    before = os.umask(0o077)
    try:
        with locked(["AIO000"], str(tmp_path)):
            assert (tmp_path / "fprc-AIO000.lock").stat().st_mode & 0o777 == 0o666
    finally:
        os.umask(before)


def test_lock_that_cannot_be_opened_is_no_leave_to_go_on(tmp_path):
    (tmp_path / "fprc-AIO000.lock").symlink_to(tmp_path / "elsewhere")
    with (
        pytest.raises(DeviceError, match=r"fprc-AIO000\.lock cannot be locked .*lock_folder"),
        locked(["AIO000"], str(tmp_path)),
    ):
        pass
    assert not (tmp_path / "elsewhere").exists()


def test_folder_of_the_system_is_used_where_none_is_given(tmp_path, monkeypatch):
    monkeypatch.setattr(locks, "_SHARED", (tmp_path / "absent", tmp_path))
    with locked(["AIO000"]):
        assert (tmp_path / "fprc-AIO000.lock").exists()


def test_missing_folder_is_named(tmp_path):
    with (
        pytest.raises(DeviceError, match=r"create the folder .*/absent"),
        locked(["AIO000"], str(tmp_path / "absent")),
    ):
        pass


def test_file_that_cannot_be_locked_is_not_said_to_be_in_use(tmp_path, monkeypatch):
    def refuse(file, how):
        raise OSError(errno.ENOLCK, os.strerror(errno.ENOLCK))

    monkeypatch.setattr("fcntl.flock", refuse)
    with (
        pytest.raises(DeviceError, match="cannot be locked .No locks available"),
        locked(["AIO000"], str(tmp_path)),
    ):
        pass


def test_lock_holds_where_its_holder_cannot_be_written_down(tmp_path, monkeypatch):
    def refuse(file, text):
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    monkeypatch.setattr(os, "write", refuse)
    with (
        locked(["AIO000"], str(tmp_path)),
        pytest.raises(DeviceError, match="in use by another process"),
        locked(["AIO000"], str(tmp_path)),
    ):
        pass


def test_rig_that_is_opened_from_a_program_has_its_boards_alone(bench, settings):
    hardware = settings["hardware"]

    def build():
        rig = HardwareRig(hardware, bench.elapsed, sleep=bench.wait, now=bench.elapsed)
        return rig

    rig = build()
    calls = bench.shared.calls
    with pytest.raises(DeviceError, match="AIO000 is in use by process"):
        build()
    assert bench.shared.calls == calls
    rig.close()
    build().close()
