import signal
from types import SimpleNamespace
from unittest.mock import Mock

import pytest

from fprc.apparatus import session
from fprc.apparatus.guardian import HEARTBEAT
from fprc.apparatus.session import Stop
from fprc.errors import DeviceError

LISTEN = Stop._listen


@pytest.fixture
def clock(monkeypatch):
    """Time that the session reads."""
    clock = SimpleNamespace(s=100.0, monotonic=lambda: clock.s)
    monkeypatch.setattr(session, "time", clock)
    return clock


@pytest.fixture
def sent(monkeypatch):
    """Messages to the guardian; the handlers and pipes of the tests' process are left alone."""
    sent = []
    monkeypatch.setattr(Stop, "_listen", lambda self: None)
    monkeypatch.setattr(signal, "signal", lambda *_: None)
    monkeypatch.setattr(session, "notify", sent.append)
    return sent


@pytest.fixture
def stop(clock, sent):
    return Stop(0.5)


def test_heartbeat_is_sent_when_the_loop_asks_and_one_is_due(stop, clock, sent):
    for _ in range(21):
        stop()
        clock.s += 0.01
    assert sent == 4 * [HEARTBEAT]


def test_guardian_that_is_silent_ends_the_run(stop, clock):
    clock.s += 0.49
    assert stop() == ""
    clock.s += 0.02
    assert "has been silent for 0.51 s (hardware.loop.stalled_s)" in stop()
    # and a later heartbeat does not change that
    stop._heartbeat_s = clock.s
    assert "has been silent for 0.51 s" in stop()


@pytest.mark.parametrize(("silent_s", "ended", "tries_on"), [(0, 0, 0), (0, 1, 1), (0.6, 0, 1)])
def test_rig_that_cannot_be_vented_is_left_to_a_guardian_that_is_there(
    stop, clock, settings, monkeypatch, silent_s, ended, tries_on
):
    """The guardian is there, or has ended, or was stopped."""

    def run(device, metronome, *given, **named):
        clock.s += silent_s
        if ended:
            LISTEN(stop)
        return {}

    rig = Mock(close=Mock(side_effect=DeviceError("board AIO001 failed")))
    tried = Mock(return_value="")
    monkeypatch.setattr(session, "HardwareRig", lambda *given, **named: rig)
    monkeypatch.setattr(session, "run", run)
    monkeypatch.setattr(session.os, "read", lambda *_: b"")  # the pipe of a guardian that ended
    monkeypatch.setattr(session, "vent_until_shown", tried)
    found = session.on_rig(settings, lambda k, now: (0.0, 0.0), 1, stop)
    assert "AIO001" in found.unvented
    assert tried.call_count == tries_on
