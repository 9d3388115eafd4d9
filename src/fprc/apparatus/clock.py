"""Clock of a real rig, with absolute deadlines and a count of missed ticks."""

import time
from collections.abc import Callable
from dataclasses import KW_ONLY, dataclass, field

import numpy as np

from fprc.errors import ControlError


def _now_s() -> float:
    """Return a monotonic time that goes on while the computer is suspended, s."""
    return time.clock_gettime(time.CLOCK_BOOTTIME)


@dataclass(eq=False, repr=False)
class Metronome:
    """Ticks at start + k * period on a monotonic clock, so that lateness does not add up.

    A tick that is late by a period or more is skipped: the loop continues with
    the tick now due. The first tick is due one period after the first call.
    """

    period_s: float
    _: KW_ONLY
    overruns_in_a_row: int  #: most ticks that may be missed before the loop is on time again
    spin_s: float = 0.0  #: busy waiting before each deadline, which reduces jitter
    now: Callable[[], float] = _now_s
    sleep: Callable[[float], None] = time.sleep
    overruns: int = field(default=0, init=False)  #: missed ticks so far
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
        if self.now() < due_s:
            self._in_a_row = 0
        while (late_s := self.now() - due_s) < 0.0:
            if -late_s > self.spin_s:
                self.sleep(-late_s - self.spin_s)
        missed = int(late_s / self.period_s)
        self.overruns += missed
        self._in_a_row += missed
        if self._in_a_row > self.overruns_in_a_row:
            raise ControlError(
                f"{self._in_a_row} ticks of {1e3 * self.period_s:g} ms were missed, and none was "
                f"on time between them; the limit is {self.overruns_in_a_row} (hardware.limits."
                "overruns_in_a_row); close other programs, use a faster model, and keep the "
                "computer from being suspended"
            )
        self._late_s.append(late_s - missed * self.period_s)
        return tick + missed

    def statistics(self) -> dict[str, float]:
        """Return the counts of ticks and overruns, and percentiles of the lateness of ticks, s."""
        shares = {"p50": 50.0, "p99": 99.0, "p99_9": 99.9, "max": 100.0}
        late_s = np.percentile(self._late_s or [0.0], list(shares.values())).tolist()
        names = [f"jitter_{name}_s" for name in shares]
        counts = {"ticks": len(self._late_s), "overruns": self.overruns}
        return counts | dict(zip(names, late_s, strict=True))
