"""Clock of a real rig, with absolute deadlines and a count of missed ticks."""

import time
from collections.abc import Callable
from dataclasses import KW_ONLY, dataclass, field

import numpy as np

from fprc.errors import ControlError


@dataclass(eq=False, repr=False)
class Metronome:
    """Ticks at start + k * period on a monotonic clock, so that lateness does not add up.

    A tick that is late by a period or more is skipped: the loop continues with
    the tick now due. The first tick is due one period after the first call.

    Parameters
    ----------
    period_s : float
        Time between two ticks.
    overruns_in_a_row : int
        Most ticks that may be missed before the loop is on time again.
    spin_s : float
        Busy waiting before each deadline, s, which reduces jitter.
    now, sleep : callable
        Monotonic time in s, and a sleep function.

    Attributes
    ----------
    overruns : int
        Missed ticks so far.
    """

    period_s: float
    _: KW_ONLY
    overruns_in_a_row: int
    spin_s: float = 0.0
    now: Callable[[], float] = time.perf_counter
    sleep: Callable[[float], None] = time.sleep
    overruns: int = field(default=0, init=False)
    _start_s: float | None = field(default=None, init=False)
    _in_a_row: int = field(default=0, init=False)
    _late_s: list[float] = field(default_factory=list, init=False)

    def elapsed(self) -> float:
        """Return the time since tick 0, s; 0 before the first call of ``wait_for``."""
        return 0.0 if self._start_s is None else self.now() - self._start_s

    def wait_for(self, tick: int) -> int:
        """Wait until this tick is due; return the tick now due, a later one if some were missed.

        Raises
        ------
        ControlError
            More ticks than allowed were missed, with none on time between them.
        """
        if self._start_s is None:
            self._start_s = self.now() + self.period_s - tick * self.period_s
        due_s = self._start_s + tick * self.period_s
        late_s = self.now() - due_s
        if late_s < 0.0:
            self._in_a_row = 0
            while (left_s := due_s - self.now()) > 0.0:
                if left_s > self.spin_s:
                    self.sleep(left_s - self.spin_s)
        else:
            missed = int(late_s / self.period_s)
            self.overruns += missed
            self._in_a_row += missed
            if self._in_a_row > self.overruns_in_a_row:
                raise ControlError(
                    f"{self._in_a_row} ticks of {1e3 * self.period_s:g} ms were missed, and none "
                    f"was on time between them; the limit is {self.overruns_in_a_row} "
                    "(hardware.limits.overruns_in_a_row); close other programs, or use a faster "
                    "model"
                )
            tick += missed
            due_s += missed * self.period_s
        self._late_s.append(self.now() - due_s)
        return tick

    def statistics(self) -> dict[str, float]:
        """Return the counts of ticks and overruns, and percentiles of the lateness of ticks, s."""
        late_s = np.array(self._late_s or [0.0])
        p50, p99, p999 = np.percentile(late_s, [50.0, 99.0, 99.9]).tolist()
        return {
            "ticks": len(self._late_s),
            "overruns": self.overruns,
            "jitter_p50_s": p50,
            "jitter_p99_s": p99,
            "jitter_p99_9_s": p999,
            "jitter_max_s": float(late_s.max()),
        }
