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
    )
    monkeypatch.setattr(ctypes, "CDLL", lambda *a, **k: SimpleNamespace(mlockall=lock))
    return asked


def test_garbage_is_collected_before_and_not_during_the_run(system):
    before = gc.get_freeze_count()
    request_realtime(0)
    assert not gc.isenabled()
    assert gc.get_freeze_count() > before
    assert system == []


def test_what_is_refused_is_reported_and_the_other_still_asked_for(system, monkeypatch):
    def refuse(*request):
        raise PermissionError(errno.EPERM, "Operation not permitted")

    def keep_unlocked(flags):
        ctypes.set_errno(errno.ENOMEM)
        return -1

    assert request_realtime(50) == ""
    assert system == [("priority", 50), ("mlockall", 3)]
    monkeypatch.setattr(os, "sched_setscheduler", refuse)
    refused = request_realtime(42)
    assert "rtprio 42" in refused
    assert system[2:] == [("mlockall", 3)]
    monkeypatch.setattr(ctypes, "CDLL", lambda *a, **k: SimpleNamespace(mlockall=keep_unlocked))
    assert os.strerror(errno.ENOMEM) in request_realtime(1)
