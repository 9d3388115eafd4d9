import signal
import threading
import time
from types import SimpleNamespace
from unittest.mock import Mock

import pytest

from fprc.apparatus import guardian, hardware
from fprc.apparatus.guardian import BEAT_S, _wait, _watch, vent_until_shown
from fprc.apparatus.hardware import Pneumatics
from fprc.errors import ControlError

VENTED = "both chambers are vented, as their sensors show"


@pytest.fixture
def alive(bench, monkeypatch):
    """A bench whose time advances while the guardian waits."""
    passes = SimpleNamespace(sleep=bench.wait, monotonic=time.monotonic)
    monkeypatch.setattr(guardian, "time", passes)
    monkeypatch.setattr(hardware, "time", SimpleNamespace(monotonic=bench.elapsed))
    return bench


@pytest.fixture
def quick(monkeypatch):
    monkeypatch.setattr(guardian, "_MESSAGE_S", 0.02)
    monkeypatch.setattr(guardian, "_RETRY_S", 0.005)
    # whatever started the tests may ignore it
    monkeypatch.setattr(guardian.signal, "getsignal", lambda number: signal.default_int_handler)


LIMITS = {"stalled_s": 0.5, "opening_s": 3.0}
#: Timeouts after which one more is too many, of a loop that drives the rig or opens the boards.
DRIVEN, OPENED = ([None] * (round(limit_s / BEAT_S) - 1) for limit_s in LIMITS.values())


@pytest.mark.parametrize(
    ("chunks", "end"),
    [
        ([b""], "safe"),  # it ended before anything could move
        ([b"O", b""], "gone"),
        ([b"OS", b""], "safe"),  # a board cannot be opened
        ([b"OA", b""], "gone"),
        ([b"A..", b".", b""], "gone"),
        ([b"A...", b".S", b""], "safe"),
        ([b"OA.S", b"O", b"A..S", b""], "safe"),  # a check: two sessions
        ([b"A.SA", b""], "gone"),
        ([b"A.S", b"A.", b""], "gone"),
        # silence is counted in waits, so that a guardian that was stopped hears first
        ([b"A", *DRIVEN, b".", *DRIVEN, b"S", b""], "safe"),
        ([b"A", *DRIVEN, b".", *DRIVEN, None], "silent"),
        # boards that take long to open are waited for, but not without end
        ([b"O", *OPENED, b"A.S", b""], "safe"),
        ([b"OA.SO", b"...", *OPENED, None], "silent"),
        # and once they are open, silence is no longer tolerated
        ([b"O", *OPENED, b"A", *DRIVEN, None], "silent"),
        ([*4 * OPENED, b"A", b".S", *4 * OPENED, b""], "safe"),
    ],
)
def test_end_of_the_loop_is_derived_from_its_messages(chunks, end):
    assert len(DRIVEN) < len(OPENED)
    process = Mock()
    process.listen.side_effect = chunks  # None: a timeout
    assert _watch(process, LIMITS) == end
    assert process.listen.call_count == process.beat.call_count == len(chunks)


def test_chambers_that_no_sensor_shows_are_not_called_vented(alive, settings):
    settings["hardware"]["boards"]["input_device"] = "AIO007"
    message = vent_until_shown(settings["hardware"])
    assert message.startswith("THE CHAMBERS MAY BE UNDER PRESSURE")
    assert "AIO007" in message
    assert list(alive.shared.outputs[:2]) == [0.0, 0.0]
    assert alive.shared.opened == 0


@pytest.mark.parametrize("failures", [0, 1, 6, 40])
def test_board_that_fails_and_recovers_is_tried_until_it_vents(
    alive, settings, quick, monkeypatch, failures
):
    """Also while the terminal takes no message."""
    held = threading.Event()
    monkeypatch.setattr(guardian.log, "error", lambda *arguments: held.wait(0.5))
    alive.shared.outputs[:2] = [9.0, 9.0]  # as of a loop that was killed
    alive.wait(0.3)
    assert alive.rig.read().p_exp_kpa > 100.0
    alive.fail(failures)
    assert vent_until_shown(settings["hardware"]) == VENTED
    assert alive.shared.failures == failures
    assert list(alive.shared.outputs[:2]) == [0.0, 0.0]
    assert abs(alive.rig.read().p_exp_kpa) < 15.0
    assert failures or alive.shared.opened == 0


def wait_for(true):
    for _ in range(6000):
        if true():
            return
        time.sleep(0.01)
    raise AssertionError("waited in vain")


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGHUP])
def test_venting_is_given_up_only_by_the_user(alive, settings, quick, caplog, number):
    heard = []
    alive.fail(1 << 40)

    def send():
        wait_for(lambda: alive.shared.failures > 5 and len(caplog.messages) >= 5)
        heard.append(number)
        if number != signal.SIGINT:  # a terminal that is closed does not end it
            wait_for(lambda: len(caplog.messages) >= 10)
            alive.shared.fail_count = 0

    person = threading.Thread(target=send, daemon=True)
    person.start()
    message = vent_until_shown(settings["hardware"], heard)
    person.join()
    ends = "THE CHAMBERS MAY BE UNDER PRESSURE" if number == signal.SIGINT else VENTED
    assert message.startswith(ends)
    assert any("failed with code 777" in message for message in caplog.messages)


@pytest.mark.parametrize(
    ("call", "says"), [("exhaust", "the driver has not answered"), ("pressures", "the valves took")]
)
@pytest.mark.parametrize("ignored", [False, True])
@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM, None])
def test_driver_that_never_answers_is_waited_for_until_the_user_gives_up(
    alive, settings, quick, monkeypatch, call, says, ignored, number
):
    """With Ctrl-C; by another signal where that is ignored; after a time if nobody can."""
    never, heard = threading.Event(), []
    handler = signal.SIG_IGN if ignored else signal.default_int_handler
    monkeypatch.setattr(guardian.signal, "getsignal", lambda number: handler)
    monkeypatch.setattr(Pneumatics, call, lambda self: never.wait(30.0))
    settings["hardware"]["valves"]["vent_s"] = 0.1
    signals = [number] if number == signal.SIGINT or ignored else [number, signal.SIGINT]
    send = threading.Timer(0.1, lambda: [(heard.append(each), time.sleep(0.1)) for each in signals])
    send.start()
    message = vent_until_shown(settings["hardware"], heard if number else None)
    never.set()
    send.join()
    assert message.startswith(f"THE CHAMBERS MAY BE UNDER PRESSURE: {says}")


@pytest.mark.parametrize(("end", "times"), [("safe", 0), ("gone", 1), ("silent", 2)])
def test_chambers_are_vented_again_once_a_loop_that_was_killed_has_ended(
    settings, monkeypatch, end, times
):
    """Its last call of the driver may have come after the first venting."""
    processes, alive = [], []

    def watch(process, loop):
        processes.append(process)
        return end

    def vent(hardware, received):
        alive.append(processes[0].returncode is None)
        return VENTED

    monkeypatch.setattr(guardian, "_watch", watch)
    monkeypatch.setattr(guardian, "vent_until_shown", vent)
    with pytest.raises(ControlError):
        guardian.guard({"what": "check", "settings": settings | {"control": {}}, "armed": False})
    assert alive == [True, False][:times]


def test_process_that_does_not_end_is_awaited_until_the_user_gives_up(quick):
    waits, heard = [], []

    def wait(timeout):
        waits.append(timeout)
        if len(waits) == 4:
            heard.append(signal.SIGINT)
        raise guardian.subprocess.TimeoutExpired("rig", timeout)

    assert _wait(Mock(pid=4711, wait=wait), heard) is None
    assert len(waits) == 4
