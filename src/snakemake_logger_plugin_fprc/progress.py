"""What a run prints: a line for each finished job, and a bar on a terminal. Knows no Snakemake."""

import json
import shutil
import time
from collections import Counter
from collections.abc import Callable, Mapping
from contextlib import suppress
from dataclasses import dataclass, field
from pathlib import Path
from typing import TextIO

#: Time between two progress lines where no job ends, outside a terminal.
QUIET_S = 60.0


@dataclass
class Job:
    """A job that runs; without a label, it only names a target."""

    rule: str
    label: str
    log: Path | None
    began_s: float


@dataclass
class Progress:
    """Lines about the jobs of a run.

    Parameters
    ----------
    stream : text file
        Where the lines go.
    terminal : bool
        Whether ``stream`` is a terminal, and shows a bar in its last line.
    seconds : Mapping of str to float
        Duration of a job of each rule, from earlier runs.
    clock : callable
        Time in s.
    """

    stream: TextIO
    terminal: bool
    seconds: Mapping[str, float] = field(default_factory=dict)
    clock: Callable[[], float] = time.monotonic
    running: dict[int, Job] = field(default_factory=dict)
    measured: dict[str, float] = field(default_factory=dict)

    def begin(self, jobs: Mapping[str, int]) -> None:
        """Take the number of jobs of each rule."""
        self._began_s = self._spoke_s = self.clock()
        self._left = Counter(jobs)
        self._total = sum(jobs.values())
        self._busy_s = 0.0
        count = f"{self._total} job{'s' * (self._total > 1)}"
        self.say(f"{count}; what each says is in its log, below results/logs")

    def start(self, number: int, rule: str, label: str, log: Path | None) -> None:
        """Record that a job has started."""
        self.running[number] = Job(rule, label, log, self.clock())
        self.show()

    def finish(self, number: int) -> None:
        """Print the line of a job that has succeeded."""
        job = self.running.pop(number, None)
        if job is None:
            return
        took_s = self.clock() - job.began_s
        self._left[job.rule] -= 1
        self._busy_s += took_s
        self.measured[job.rule] = took_s
        if job.label:
            self.say(f"{self._head()}  {job.label} ({took_s:.0f} s)")
        if not self._left.total():
            self.say(f"{self._total} of {self._total} jobs done in {_clock(self._elapsed_s())}")

    def say(self, line: str) -> None:
        """Print a line, above the bar if there is one."""
        self._spoke_s = self.clock()
        self.stream.write(f"{self._cleared()}{line}\n")
        self.show()

    def show(self) -> None:
        """Draw the bar; outside a terminal, name a running job after a minute without a line."""
        if self.terminal and self.running:
            width = shutil.get_terminal_size().columns - 1
            filled = round(10 * (self._total - self._left.total()) / self._total)
            bar = f"{'#' * filled:.<10} {self._head()}  {self._now()}"
            self.stream.write(f"{self._cleared()}{bar[:width]}")
        elif self.running and self.clock() - self._spoke_s >= QUIET_S:
            self._spoke_s = self.clock()
            self.stream.write(f"{self._head()}  {self._now()}\n")
        self.stream.flush()

    def end(self) -> None:
        """Remove the bar."""
        self.stream.write(self._cleared())
        self.stream.flush()

    def remaining_s(self) -> float | None:
        """Estimate the time that is left; None unless the duration of every rule is known."""
        known = {**self.seconds, **self.measured}
        left = {rule: count for rule, count in self._left.items() if count > 0}
        if not self._busy_s or not left.keys() <= known.keys():
            return None
        now = self.clock()
        work_s = sum(count * known[rule] for rule, count in left.items())
        for job in self.running.values():
            work_s -= min(now - job.began_s, known[job.rule])
        return work_s / max(1.0, self._busy_s / self._elapsed_s())

    def _head(self) -> str:
        done = self._total - self._left.total()
        left_s = self.remaining_s()
        about = "" if not left_s or left_s < 5 else f", about {_clock(left_s)} left"
        width = len(str(self._total))
        return f"[{done:{width}}/{self._total}] {_clock(self._elapsed_s())}{about}"

    def _elapsed_s(self) -> float:
        return self.clock() - self._began_s

    def _now(self) -> str:
        job = min(self.running.values(), key=lambda job: (not job.label, job.began_s))
        more = f" and {len(self.running) - 1} more" if len(self.running) > 1 else ""
        last = _last_line(job.log)
        return f"{job.label}{more}{f': {last}' if last else ''}"

    def _cleared(self) -> str:
        return "\r\x1b[K" if self.terminal else ""


def read_seconds(path: Path) -> dict[str, float]:
    """Return the durations that ``write_seconds`` kept; none if the file cannot be used."""
    with suppress(OSError, ValueError, AttributeError):
        kept = json.loads(path.read_text(encoding="utf-8"))
        return {str(rule): float(s) for rule, s in kept.items()}
    return {}


def write_seconds(path: Path, *durations: Mapping[str, float]) -> None:
    """Keep the durations of rules, the later ones first; a failure costs an estimate only."""
    merged: dict[str, float] = {}
    for newer in durations:
        merged |= newer
    with suppress(OSError):
        path.write_text(json.dumps(merged), encoding="utf-8")


def _clock(seconds: float) -> str:
    minutes, rest = divmod(round(seconds), 60)
    hours, minutes = divmod(minutes, 60)
    return f"{hours}:{minutes:02}:{rest:02}" if hours else f"{minutes}:{rest:02}"


def _last_line(log: Path | None) -> str:
    if log is None:
        return ""
    with suppress(OSError), log.open("rb") as file:
        file.seek(max(0, log.stat().st_size - 2000))
        lines = file.read().decode("utf-8", errors="replace").splitlines()
        return lines[-1].rpartition("] ")[2] if lines else ""
    return ""
