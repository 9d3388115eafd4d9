import time as time_module
from contextlib import nullcontext

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from fprc.apparatus.clock import Metronome
from fprc.errors import ControlError

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
    return Metronome(PERIOD_S, allowed, now=time.now, sleep=time.sleep)


@pytest.mark.parametrize(
    ("stall", "tick", "late"),
    # just below one period late, at one and above it
    [(0.0, 1, 0.0), (1.25, 1, 0.25), (1.875, 1, 0.875), (2.0, 2, 0.0), (2.125, 2, 0.125),
     (9.5, 9, 0.5), (700.0, 700, 0.0)],
)  # fmt: skip
def test_stall_gives_up_the_ticks_that_are_a_period_late(time, stall, tick, late):
    clock = metronome(time)
    clock.wait_for(0)
    time.pass_(stall)
    assert clock.wait_for(1) == tick
    assert clock.statistics()["overruns"] == tick - 1
    assert time.s == 1000.0 + (1 + tick + late) * PERIOD_S
    # and continues on the original grid
    assert clock.wait_for(tick + 1) == tick + 1
    assert time.s == 1000.0 + (2 + tick) * PERIOD_S


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
