import ctypes
import errno
import gc
import os
from types import SimpleNamespace

import pytest

from fprc.control.realtime import request_realtime


@pytest.fixture(autouse=True)
def collector():
    yield
    gc.enable()


@pytest.fixture
def system(monkeypatch):
    """An operating system that grants and records every request."""
    asked = []

    def lock(flags):
        asked.append(("mlockall", flags))
        return 0

    monkeypatch.setattr(
        os,
        "sched_setscheduler",
        lambda *request: asked.append(("priority", request[2].sched_priority)),
        raising=False,
    )
    monkeypatch.setattr(ctypes, "CDLL", lambda *a, **k: SimpleNamespace(mlockall=lock))
    return asked


def test_granted_requests_are_reported(system):
    assert request_realtime(50) == ["real-time priority 50", "memory locked"]
    assert system == [("priority", 50), ("mlockall", 3)]


def test_garbage_is_collected_before_and_not_during_the_run(system):
    before = gc.get_freeze_count()
    request_realtime(0)
    assert not gc.isenabled()
    assert gc.get_freeze_count() > before
    assert system == []


def test_refused_priority_is_reported_with_its_remedy_and_memory_is_still_locked(
    system, monkeypatch
):
    def refuse(*request):
        raise PermissionError(errno.EPERM, "Operation not permitted")

    monkeypatch.setattr(os, "sched_setscheduler", refuse)
    priority, memory = request_realtime(42)
    assert priority.startswith(
        "no real-time priority (Operation not permitted); continuing without"
    )
    assert "rtprio 42" in priority
    assert "/etc/security/limits.conf" in priority
    assert memory == "memory locked"


def test_refused_lock_is_reported_with_its_reason_and_remedy(system, monkeypatch):
    def refuse(flags):
        ctypes.set_errno(errno.ENOMEM)
        return -1

    monkeypatch.setattr(ctypes, "CDLL", lambda *a, **k: SimpleNamespace(mlockall=refuse))
    _, memory = request_realtime(1)
    assert memory.startswith(f"memory not locked ({os.strerror(errno.ENOMEM)}); continuing without")
    assert "memlock unlimited" in memory


@pytest.mark.parametrize("raised", [OSError, AttributeError, TypeError])
def test_system_without_either_is_reported(system, monkeypatch, raised):
    def refuse(*arguments, **more):
        raise raised

    monkeypatch.delattr(os, "sched_setscheduler")
    monkeypatch.setattr(ctypes, "CDLL", refuse)
    priority, memory = request_realtime(1)
    assert "this system has no SCHED_FIFO; continuing without" in priority
    assert "this system has no mlockall; continuing without" in memory
    assert not gc.isenabled()
