"""Fixtures: the fake driver, and a simulated rig connected to it."""

import gc
import logging
import shutil
from functools import partial
from pathlib import Path
from types import SimpleNamespace

import pytest

from fprc.apparatus import hardware, session
from fprc.config import Settings

# libraries and thousands of tests stay: to look through them for garbage takes a tenth of the time
gc.disable()


def pytest_collection_finish():
    gc.freeze()
    gc.enable()


@pytest.fixture(autouse=True)
def silence_after():
    """Let messages no longer go where a command of this test sent them."""
    yield
    messages = logging.getLogger("fprc")
    messages.handlers = []
    messages.setLevel(logging.NOTSET)


@pytest.fixture(scope="session")
def compiled_driver(tmp_path_factory):
    """The fake driver's shared library."""
    if shutil.which("cc") is None:
        pytest.skip("no C compiler, cc, for the stand-in of the driver")
    from bench import compile_driver  # which few tests need, and which imports the simulator

    return compile_driver(tmp_path_factory.mktemp("driver"))


@pytest.fixture
def driver(compiled_driver, tmp_path):
    """A copy of the library for this test alone: a loaded library keeps its bench."""
    return Path(shutil.copy(compiled_driver, tmp_path))


@pytest.fixture
def settings(driver):
    """Default settings of a rig behind the fake driver."""
    found = Settings().model_dump(mode="json")
    from bench import BOARDS

    found["hardware"]["boards"] |= {"library": str(driver), **BOARDS}
    return found


@pytest.fixture
def make_bench(tmp_path, monkeypatch):
    """Return what builds the simulated rig behind the fake driver, once in a test."""
    from bench import Bench

    monkeypatch.setenv("FAKE_BENCH", str(tmp_path / "bench"))
    return partial(Bench, tmp_path / "bench")


@pytest.fixture
def bench(make_bench, settings):
    """Simulated rig of the default settings behind the fake driver."""
    return make_bench(settings)


class Session:
    """Clock of one session on a bench: its ticks begin at 0.

    ``at(tick)`` is called at each tick, once the rig has lived until then; ``clean_tick`` is the
    last tick before which no call of the driver had failed.
    """

    def __init__(self, bench, at, begin):
        self._bench, self._at, self._begin = bench, at, begin
        self.statistics = bench.statistics
        self.tick = self.clean_tick = -1

    def wait_for(self, tick):
        self._bench.wait_for(self._begin + tick)
        self.tick = tick
        if not self._bench.shared.failures:
            self.clean_tick = tick
        self._at(tick)
        return tick

    def elapsed(self):
        return (self._bench.tick - self._begin) * self._bench.period_s


class StandIn:
    """Stands for the guardian of a run; it is there, or has gone."""

    def __init__(self, stop, guarded):
        self._stop, self._guarded, self.messages = stop, guarded, []

    def __call__(self):
        return self._stop()

    def notify(self, message):
        self.messages.append(message)

    def is_there(self):
        return self._guarded


@pytest.fixture
def live_by(monkeypatch):
    """Let sessions with the rig live by the clock of a bench, in this process.

    Gives the list of the sessions, and the stand-in for their guardian.
    """
    sessions, waited_s = [], [0.0]

    def live_by(bench, at=lambda tick: None, *, stop=lambda: "", guarded=True):
        def begin(*arguments):
            sessions.append(Session(bench, at, bench.tick + 1 if sessions else 0))
            return sessions[-1]

        def wait(seconds):
            if sessions and sessions[-1].tick >= 0:  # the session begins once the rig is open
                bench.wait(seconds)
            else:
                waited_s[0] += seconds

        now = SimpleNamespace(monotonic=lambda: waited_s[0] + bench.elapsed())
        monkeypatch.setattr(hardware, "time", now)
        monkeypatch.setattr(session, "Metronome", begin)
        monkeypatch.setattr(session, "time", SimpleNamespace(sleep=wait))
        return sessions, StandIn(stop, guarded)

    return live_by
