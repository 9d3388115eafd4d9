"""Clock of a real rig, with absolute deadlines and a count of missed ticks."""

import time
from collections.abc import Callable

import numpy as np

from fprc.errors import ControlError


def _now_s() -> float:
    """Return a monotonic time that goes on while the computer is suspended, s."""
    return time.clock_gettime(time.CLOCK_BOOTTIME)


class Metronome:
    """Ticks at start + k * period on a monotonic clock, so that lateness does not add up.

    A tick that is late by a period or more is skipped: the loop continues with
    the tick now due. The first tick is due one period after the first call.
    ``overruns_in_a_row`` is the most that may be missed before the loop is on time again.
    """

    def __init__(
        self,
        period_s: float,
        overruns_in_a_row: int,
        *,
        now: Callable[[], float] = _now_s,
        sleep: Callable[[float], None] = time.sleep,
    ):
        self._period_s, self._allowed = period_s, overruns_in_a_row
        self._now, self._sleep = now, sleep
        self._start_s: float | None = None
        self._overruns = self._in_a_row = 0
        self._late_s: list[float] = []

    def elapsed(self) -> float:
        """Return the time since tick 0, s; 0 before the first call of ``wait_for``."""
        return 0.0 if self._start_s is None else self._now() - self._start_s

    def wait_for(self, tick: int) -> int:
        """Wait until this tick is due; return the tick now due, a later one if some were missed.

        Raises
        ------
        ControlError
            More ticks than allowed were missed, with none on time between them.
        """
        if self._start_s is None:
            self._start_s = self._now() + self._period_s - tick * self._period_s
        due_s = self._start_s + tick * self._period_s
        if self._now() < due_s:
            self._in_a_row = 0
        while (late_s := self._now() - due_s) < 0.0:
            self._sleep(-late_s)
        missed = int(late_s / self._period_s)
        self._overruns += missed
        self._in_a_row += missed
        if self._in_a_row > self._allowed:
            raise ControlError(
                f"{self._in_a_row} ticks of {1e3 * self._period_s:g} ms were missed, and none was "
                f"on time between them; the limit is {self._allowed} (hardware.limits."
                "overruns_in_a_row); close other programs, use a faster model, and keep the "
                "computer from being suspended"
            )
        self._late_s.append(late_s - missed * self._period_s)
        return tick + missed

    def statistics(self) -> dict[str, float]:
        """Return the counts of ticks and overruns, and how late the ticks were, s."""
        p50, p99_9, most = np.percentile(self._late_s or [0.0], [50.0, 99.9, 100.0]).tolist()
        counts = {"ticks": len(self._late_s), "overruns": self._overruns}
        return counts | {"jitter_p50_s": p50, "jitter_p99_9_s": p99_9, "jitter_max_s": most}
