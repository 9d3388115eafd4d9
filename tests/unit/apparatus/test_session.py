import signal
from types import SimpleNamespace

import pytest

from fprc.apparatus import session
from fprc.apparatus.guardian import HEARTBEAT
from fprc.apparatus.session import Stop
from fprc.errors import DeviceError

LISTEN = Stop._listen


@pytest.fixture
def clocks(monkeypatch):
    """Times of a computer that runs and is suspended, which the session reads."""
    clocks = SimpleNamespace(ran_s=100.0, suspended_s=7.0, CLOCK_BOOTTIME=7)
    clocks.monotonic = lambda: clocks.ran_s
    clocks.clock_gettime = lambda which: clocks.ran_s + clocks.suspended_s
    monkeypatch.setattr(session, "time", clocks)
    return clocks


@pytest.fixture(autouse=True)
def own_signals(monkeypatch):
    """Leave the signal handlers, the input and the output of the tests' process alone."""
    monkeypatch.setattr(Stop, "_listen", lambda self: None)
    monkeypatch.setattr(signal, "signal", lambda *_: None)
    monkeypatch.setattr(session, "notify", lambda message: None)


@pytest.fixture
def stop(clocks):
    return Stop(0.5)


def test_heartbeat_is_sent_when_the_loop_asks_and_one_is_due(stop, clocks, monkeypatch):
    sent = []
    monkeypatch.setattr(session, "notify", sent.append)
    for _ in range(21):
        stop()
        clocks.ran_s += 0.01
    assert sent == 4 * [HEARTBEAT]


@pytest.mark.parametrize(("silent_s", "ended", "tries_on"), [(0, 0, 0), (0, 1, 1), (0.6, 0, 1)])
def test_rig_that_cannot_be_vented_is_left_to_a_guardian_that_is_there(
    stop, clocks, settings, monkeypatch, silent_s, ended, tries_on
):
    """The guardian is there, or has ended, or was stopped."""

    class Rig:
        def __init__(self, *given, **named):
            pass

        read = write = safe = None

        def close(self):
            raise DeviceError("board AIO001 failed")

    def run(device, clock, *given, **named):
        clocks.ran_s += silent_s
        if ended:
            LISTEN(stop)
        clock.wait_for(0)
        return {}

    tried = []
    monkeypatch.setattr(session, "HardwareRig", Rig)
    monkeypatch.setattr(session, "run", run)
    monkeypatch.setattr(session.os, "read", lambda *_: b"")  # the pipe of a guardian that ended
    monkeypatch.setattr(session, "vent_until_shown", lambda hardware: tried.append(1))
    found = session.on_rig(settings, lambda k, now: (0.0, 0.0), 1, stop)
    assert "AIO001" in found.unvented
    assert len(tried) == tries_on


def test_guardian_that_is_silent_ends_the_run(stop, clocks):
    clocks.ran_s += 0.49
    assert stop() == ""
    clocks.ran_s += 0.02
    assert "has been silent for 0.51 s (hardware.loop.stalled_s)" in stop()
    # and a later heartbeat does not change that
    stop._heartbeat_s = clocks.ran_s
    assert "has been silent for 0.51 s" in stop()


@pytest.mark.parametrize(("seconds", "ends"), [(0.05, False), (0.2, True), (3600.0, True)])
def test_computer_that_was_suspended_ends_the_run(stop, clocks, seconds, ends):
    clocks.suspended_s += seconds
    assert ("the computer was suspended for" in stop()) is ends


def test_pause_between_the_two_clocks_does_not_pass_for_a_suspension(clocks):
    def boottime(which):
        clocks.ran_s += 0.3  # the process is not run for a while
        return clocks.ran_s - 0.3

    clocks.clock_gettime = boottime
    stop = Stop(10.0)
    assert stop() == ""
