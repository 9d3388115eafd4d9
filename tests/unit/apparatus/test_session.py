import os
import signal
import time as time_module
from contextlib import nullcontext
from types import SimpleNamespace
from unittest.mock import Mock

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from fprc.apparatus import session
from fprc.apparatus.guardian import HEARTBEAT
from fprc.apparatus.session import CheckedRig, Guardian, Metronome
from fprc.channels import Readings
from fprc.config import Settings
from fprc.errors import ControlError, DeviceError

# --- the clock --------------------------------------------------------------------------------

# a power of two: sums of deadlines are exact
PERIOD_S = 2.0**-8


class Time:
    """Time that advances in ``sleep`` and ``pass_``."""

    s = 1000.0

    def now(self):
        return self.s

    def sleep(self, seconds):
        assert seconds > 0.0
        self.s += seconds

    def pass_(self, periods):
        self.s += periods * PERIOD_S


@pytest.fixture
def time():
    return Time()


def metronome(time, allowed=1000):
    clock = Metronome(PERIOD_S, allowed)
    clock._now, clock._sleep = time.now, time.sleep
    return clock


@pytest.mark.parametrize("asleep", [False, True])
@pytest.mark.parametrize(("missed", "ends"), [(3, False), (4, True), (1e6, True)])
def test_more_missed_ticks_than_allowed_end_the_run(time, missed, ends, asleep):
    """Whether the loop took too long, or the computer was suspended while it waited."""
    sleep = time.sleep
    clock = metronome(time, allowed=3)
    clock.wait_for(0)
    if asleep:
        clock._sleep = lambda seconds: sleep(seconds + missed * PERIOD_S)
    time.pass_(0.5 if asleep else 1 + missed)
    refusal = pytest.raises(ControlError, match=f"{missed:.0f} ticks.*overruns_in_a_row")
    with refusal if ends else nullcontext():
        assert clock.wait_for(1) == 1 + missed


def test_time_of_a_suspended_computer_counts():
    """As of Linux's boot time, and not of Python's usual clocks."""
    before = time_module.clock_gettime(time_module.CLOCK_BOOTTIME)
    now = Metronome(1.0, 1)._now()
    assert before <= now <= time_module.clock_gettime(time_module.CLOCK_BOOTTIME)


def test_missed_ticks_are_in_a_row_until_the_loop_has_caught_up(time):
    clock = metronome(time, allowed=3)
    clock.wait_for(0)
    for tick in (1, 6):
        time.pass_(4)
        assert clock.wait_for(tick) == tick + 3
        assert clock.wait_for(tick + 4) == tick + 4  # on time, and as many may be missed again
    time.pass_(3.5)
    assert clock.wait_for(11) == 13  # two missed, half a period late
    time.pass_(0.75)
    assert clock.wait_for(14) == 14  # late, none missed: not caught up
    time.pass_(2.75)
    with pytest.raises(ControlError, match="4 ticks"):
        clock.wait_for(15)


@given(st.lists(st.integers(0, 5000), min_size=1, max_size=60))
def test_ticks_rise_none_begins_early_or_a_period_late_and_all_are_counted(works):
    time = Time()
    clock = metronome(time)
    ticks, lates = [-1], []
    for work in works:
        ticks.append(clock.wait_for(ticks[-1] + 1))
        assert ticks[-1] > ticks[-2]
        lates.append((time.s - 1000.0) / PERIOD_S - 1 - ticks[-1])
        assert 0.0 <= lates[-1] < 1.0
        time.pass_(work / 1024)
    percentiles = np.percentile(lates, [50.0, 99.9, 100.0]) * PERIOD_S
    assert [*clock.statistics().values()] == pytest.approx(
        [len(works), ticks[-1] + 1 - len(works), *percentiles], abs=1e-12
    )


# --- the limits ------------------------------------------------------------------------------

REST = {"p_exp_kpa": 0.1, "theta_deg": 0.2, "p_i_kpa": -0.3, "p_o_kpa": 100.0, "phi_deg": 0.4}
SENSORS = pytest.mark.parametrize("name", REST)


@pytest.fixture
def limits():
    return Settings().model_dump()["hardware"]["limits"]


class Watched:
    """A checked rig whose sensors have noise, but for those that are given a value."""

    def __init__(self, limits, phi=True):
        self.rig, self.k = Mock(), 0
        self.checked = CheckedRig(self.rig, {"limits": limits, "phi": phi}, PERIOD_S)
        self.read()

    def read(self, ticks=1, **values):
        for _ in range(ticks):
            self.k += 1
            noisy = {name: value + 0.01 * (self.k % 2) for name, value in REST.items()}
            self.rig.read.return_value = Readings(self.k * PERIOD_S, **noisy | values)
            now = self.checked.read()
        return now

    def refusal(self, **values):
        with pytest.raises(ControlError) as caught:
            self.read(**values)
        return str(caught.value)


@SENSORS
def test_every_reading_is_stopped_beyond_either_limit_and_if_it_is_no_number(limits, name):
    limits |= {"pressure_step_kpa": 1e6, "angle_step_deg": 1e6}
    low, high = limits[name]
    for edge, beyond in ((low, low - 0.1), (high, high + 0.1), (high, float("nan"))):
        rig = Watched(limits)
        assert rig.read(**{name: edge})
        assert rig.refusal(**{name: beyond}).startswith(f"{name} = {beyond:.1f} is outside ")


def test_first_reading_is_checked_too(limits):
    with pytest.raises(ControlError, match=r"p_o_kpa = 100\.0 is outside 120 to 400"):
        Watched(limits | {"p_o_kpa": (120.0, 400.0)})  # PAM B was not filled


@pytest.mark.parametrize(("name", "jump"), [("p_exp_kpa", 60.0), ("theta_deg", 15.0)])
@pytest.mark.parametrize("periods", [1, 4])
def test_jump_is_judged_by_the_time_that_passed(limits, name, jump, periods):
    rig = Watched(limits)
    rig.read(**{name: 1.0})
    rig.k += periods - 1
    rig.read(**{name: 1.0 + 0.99 * jump * periods})
    rig.k += periods - 1
    text = rig.refusal(**{name: 1.0 - 0.03 * jump * periods})
    assert all(part in text for part in (name, f"in {periods:.1f} samples", f"{jump:g} per"))


@SENSORS
def test_sensor_that_repeats_one_value_is_stopped_after_the_time_allowed(limits, name):
    rig, held = Watched(limits), {name: REST[name] + 0.5}
    rig.read(65, **held)  # the first of them is new
    text = rig.refusal(**held)
    assert all(part in text for part in (name, f"{held[name]:g} for 0.25 s", "stale_s"))


def test_reservoir_without_angle_sensor_is_not_asked_for_one(limits):
    rig = Watched(limits, phi=False)
    rig.read(100, phi_deg=float("nan"))


@pytest.mark.parametrize("wrong", [-1e-9, 10.0 + 1e-9, float("nan"), float("inf")])
@pytest.mark.parametrize("at", [0, 1])
def test_voltage_that_no_valve_takes_is_never_written(limits, wrong, at):
    rig = Watched(limits)
    with pytest.raises(ControlError):
        rig.checked.write(*[(wrong, 5.0), (5.0, wrong)][at])
    rig.rig.write.assert_not_called()


# --- the guardian ----------------------------------------------------------------------------


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
    monkeypatch.setattr(session, "Metronome", Mock())
    *_, unvented = session.on_rig(settings, lambda k, now: (0.0, 0.0), 1, guardian)
    assert "AIO001" in unvented
    assert tried.call_count == tries_on
