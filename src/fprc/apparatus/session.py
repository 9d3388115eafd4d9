"""A session with the real rig: its clock and limits, and how it is opened, run and made safe."""

import math
import os
import signal
import threading
import time
from collections.abc import Mapping
from contextlib import nullcontext, suppress
from functools import partial
from typing import Any

import numpy as np

from fprc.apparatus.guardian import ARMED, BEAT_S, HEARTBEAT, OPENING, SAFE, vent_until_shown
from fprc.apparatus.hardware import HardwareRig
from fprc.channels import SENSORS, Readings, unit_of
from fprc.config.settings import Control
from fprc.control import Law, RunAbortedError, run
from fprc.control_laws import HIGHEST_V
from fprc.devices import Device
from fprc.errors import ControlError, DeviceError


class Metronome:
    """Ticks at start + k * period on a monotonic clock, so that lateness does not add up.

    A tick that is late by a period or more is skipped: the loop continues with the tick now due.
    The first tick is due one period after the first call. ``overruns_in_a_row`` is the most that
    may be missed before the loop is on time again.
    """

    def __init__(self, period_s: float, overruns_in_a_row: int):
        self._period_s, self._allowed = period_s, overruns_in_a_row
        self._now = partial(time.clock_gettime, time.CLOCK_BOOTTIME)  # also runs while suspended
        self._sleep = time.sleep
        self._start_s: float | None = None
        self._overruns = self._in_a_row = 0
        self._late_s: list[float] = []

    def elapsed(self) -> float:
        """Return the time since tick 0, s; 0 before the first call of ``wait_for``."""
        return 0.0 if self._start_s is None else self._now() - self._start_s

    def wait_for(self, tick: int) -> int:
        """Wait until this tick is due; return the tick now due, a later one if some were missed.

        ControlError: more were missed than allowed, with none on time between them.
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


class CheckedRig:
    """A rig whose readings and commands are checked at every sample against ``hardware.limits``.

    A reading stops the run if it is no number, is out of range, jumps further than the rig can
    move between two samples, or stays constant for too long (a working sensor has noise). Limits on
    jumps are per period: after a missed tick a reading may change by more. Unless it ``moves``, no
    command is passed on.
    """

    def __init__(
        self, device: Device, hardware: Mapping[str, Any], period_s: float, *, moves: bool = True
    ):
        limits = hardware["limits"]
        self._device, self._moves = device, moves
        self._period_s, self._stale_s = period_s, limits["stale_s"]
        steps = {"kPa": limits["pressure_step_kpa"], "deg": limits["angle_step_deg"]}
        self._watched = [
            (name, *limits[name], steps[unit_of(name)])
            for name in SENSORS
            if hardware["phi"] or name != "phi_deg"
        ]
        self._last: Readings | None = None
        self._changed_s: dict[str, float] = {}

    def read(self) -> Readings:
        """Return the readings; ControlError lists each beyond its limits, with the limit's key."""
        now = self._device.read()
        last, self._last = self._last or now, now
        periods = max((now.time_s - last.time_s) / self._period_s, 1.0)
        problems = []
        for name, low, high, step in self._watched:
            value, before = getattr(now, name), getattr(last, name)
            if not low <= value <= high:  # NaN too
                problems.append(f"{name} = {value:.1f} is outside {low:g} to {high:g} ({name})")
            if abs(value - before) > step * periods:
                problems.append(
                    f"{name} jumped from {before:.1f} to {value:.1f} in {periods:.1f} samples, "
                    f"more than {step:g} per sample (pressure_step_kpa, angle_step_deg)"
                )
            if value != before or name not in self._changed_s:
                self._changed_s[name] = now.time_s
            elif (held_s := now.time_s - self._changed_s[name]) > self._stale_s:
                problems.append(f"{name} has been {value:g} for {held_s:.2f} s (stale_s)")
        if problems:
            problems.append("check the sensor's cable, channel and calibration, or hardware.limits")
            raise ControlError("; ".join(problems))
        return now

    def write(self, main_v: float, reservoir_v: float) -> None:
        """Set the voltages of both valves; ControlError, before any is written: not 0 to 10 V."""
        if not (0.0 <= main_v <= HIGHEST_V and 0.0 <= reservoir_v <= HIGHEST_V):
            raise ControlError(f"valves take 0 to {HIGHEST_V:g} V, not {main_v}, {reservoir_v}")
        if self._moves:
            self._device.write(main_v, reservoir_v)

    def safe(self) -> None:
        """Vent both chambers."""
        if self._moves:
            self._device.safe()


class Guardian:
    """The guardian as the loop sees it; called at every tick, it tells why to stop.

    It is a signal, or a guardian that ended or is silent for longer than ``stalled_s``.
    ``messages`` is the file descriptor of the messages to it, ``heartbeats`` that of its own.
    """

    def __init__(self, stalled_s: float, messages: int, heartbeats: int = 0) -> None:
        self._reason = ""
        self._stalled_s, self._messages, self._heartbeats = stalled_s, messages, heartbeats
        self._heartbeat_s = self._sent_s = time.monotonic()
        for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
            signal.signal(number, lambda *_: self._stop("stopped by Ctrl-C or a signal"))
        threading.Thread(target=self._listen, daemon=True).start()

    def __call__(self) -> str:
        """Send a heartbeat if one is due; return the reason to stop, empty if there is none."""
        if time.monotonic() - self._sent_s >= BEAT_S:
            self.notify(HEARTBEAT)
        if not self.is_there():
            self._stop("the guardian process has been silent for too long (hardware.loop)")
        return self._reason

    def notify(self, message: bytes) -> None:
        """Send a message to the guardian."""
        self._sent_s = time.monotonic()
        with suppress(BrokenPipeError):  # it has ended, which stops the run
            os.write(self._messages, message)

    def is_there(self) -> bool:
        """Return whether the guardian was heard lately; it may have ended, or been stopped."""
        return time.monotonic() - self._heartbeat_s <= self._stalled_s

    def _stop(self, reason: str) -> None:
        self._reason = self._reason or reason

    def _listen(self) -> None:
        while os.read(self._heartbeats, 64):
            self._heartbeat_s = time.monotonic()
        self._stop("the guardian process has ended")
        self._heartbeat_s = -math.inf


def on_rig(
    settings: Mapping[str, Any],
    law: Law,
    samples: int,
    guardian: Guardian,
    *,
    moves: bool = True,
    **recording: Any,
) -> tuple[dict[str, np.ndarray], dict[str, float], str, str]:
    """Open the real rig with its safety limits and clock; run a law; make it safe and release it.

    Returns channels, statistics of the clock, why the run was stopped, and the error of closing the
    rig; the last two are empty if it ended as planned, and if readings show that it is vented. If
    the guardian is not there to vent in our place, we try until they do. Unless the law ``moves``
    the rig, its voltages are not written. ``recording`` is that of ``fprc.control.run``.
    DeviceError: a part cannot be opened; or an unexpected exception came, and closing failed too.
    """
    control, hardware = Control(**settings["control"]), settings["hardware"]
    period_s = 1.0 / control.sample_rate_hz
    clock = Metronome(period_s, hardware["limits"]["overruns_in_a_row"])

    def wait(seconds: float) -> None:
        guardian.notify(HEARTBEAT)
        time.sleep(seconds)

    guardian.notify(OPENING)  # it then notices a call that hangs
    try:
        # the locks are those of the guardian, which this process has inherited
        opened = HardwareRig(hardware, clock.elapsed, wait, nullcontext())
    except DeviceError:
        guardian.notify(SAFE)  # nothing was moved
        raise
    guardian.notify(ARMED)
    timing: dict[str, float] = {}
    stopped = unvented = ""
    try:
        device = CheckedRig(opened, hardware, period_s, moves=moves)
        recording |= {"neutral_v": hardware["valves"]["neutral_v"], "stop": guardian}
        try:
            channels = run(device, clock, law, samples, control, **recording)
        except RunAbortedError as aborted:
            channels, stopped = aborted.channels, str(aborted)
        timing = clock.statistics()
    finally:
        try:
            opened.close()
            guardian.notify(SAFE)
        except DeviceError as closing:
            unvented = str(closing)
            if not guardian.is_there():  # else it vents
                unvented += f"\n{vent_until_shown(hardware)}"
            if not timing:
                raise DeviceError(unvented) from closing
    return channels, timing, stopped, unvented
