import os
import signal
from types import SimpleNamespace
from unittest.mock import Mock

import pytest

from fprc.apparatus import session
from fprc.apparatus.guardian import HEARTBEAT
from fprc.apparatus.session import Guardian
from fprc.errors import DeviceError


@pytest.fixture
def clock(monkeypatch):
    """Time that the session reads."""
    clock = SimpleNamespace(s=100.0, monotonic=lambda: clock.s)
    monkeypatch.setattr(session, "time", clock)
    return clock


@pytest.fixture
def guardian(clock, monkeypatch):
    """A guardian at pipes of this process, whose signals are left alone; ``end`` closes one."""
    monkeypatch.setattr(signal, "signal", lambda *_: None)
    monkeypatch.setattr(session.threading, "Thread", Mock())
    (heartbeats, to_loop), (from_loop, messages) = os.pipe(), os.pipe()
    guardian = Guardian(0.5, messages, heartbeats)
    guardian.heard = lambda: os.read(from_loop, 1000)
    yield guardian
    for file in (heartbeats, to_loop, from_loop, messages):
        os.close(file)


def end(guardian, monkeypatch):
    monkeypatch.setattr(session.os, "read", lambda *_: b"")  # a pipe that was closed
    guardian._listen()


def test_heartbeat_is_sent_when_the_loop_asks_and_one_is_due(guardian, clock):
    for _ in range(21):
        guardian()
        clock.s += 0.01
    assert guardian.heard() == 4 * HEARTBEAT


def test_guardian_that_is_silent_ends_the_run(guardian, clock):
    clock.s += 0.49
    assert guardian() == ""
    clock.s += 0.02
    assert "silent" in guardian()
    # and a later heartbeat does not change that
    guardian._heartbeat_s = clock.s
    assert "silent" in guardian()


@pytest.mark.parametrize(("silent_s", "ended", "tries_on"), [(0, 0, 0), (0, 1, 1), (0.6, 0, 1)])
def test_rig_that_cannot_be_vented_is_left_to_a_guardian_that_is_there(
    guardian, clock, settings, monkeypatch, silent_s, ended, tries_on
):
    """The guardian is there, or has ended, or was stopped."""

    def run(*given, **named):
        clock.s += silent_s
        if ended:
            end(guardian, monkeypatch)
            assert "ended" in guardian()
        return {}

    rig = Mock(close=Mock(side_effect=DeviceError("board AIO001 failed")))
    tried = Mock(return_value="")
    monkeypatch.setattr(session, "HardwareRig", lambda *given, **named: rig)
    monkeypatch.setattr(session, "run", run)
    monkeypatch.setattr(session, "vent_until_shown", tried)
    found = session.on_rig(settings, lambda k, now: (0.0, 0.0), 1, guardian)
    assert "AIO001" in found.unvented
    assert tried.call_count == tries_on
