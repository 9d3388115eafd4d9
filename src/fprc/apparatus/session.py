"""A session with the real rig: open it with safety limits and clock, make it safe at the end."""

import math
import os
import signal
import threading
import time
from collections.abc import Mapping
from contextlib import suppress
from types import SimpleNamespace
from typing import Any, NamedTuple

import numpy as np

from fprc.apparatus.clock import Metronome
from fprc.apparatus.guardian import ARMED, BEAT_S, HEARTBEAT, OPENING, SAFE, vent_until_shown
from fprc.apparatus.hardware import HardwareRig
from fprc.apparatus.safety import CheckedRig
from fprc.config.settings import Control
from fprc.control import Law, RunAbortedError, run
from fprc.devices import Device
from fprc.errors import DeviceError


class Session(NamedTuple):
    """Outcome of a session with the real rig."""

    channels: dict[str, np.ndarray]
    timing: dict[str, float]  #: statistics of the clock
    stopped: str  #: why the run was stopped; empty if it was not
    unvented: str  #: error of closing the rig; empty if readings show that it is vented


def on_rig(
    settings: Mapping[str, Any],
    law: Law,
    samples: int,
    stop: "Stop",
    *,
    moves: bool = True,
    **recording: Any,
) -> Session:
    """Open the real rig with its safety limits and clock; run a law; make it safe and release it.

    Unless the law ``moves`` the rig, its voltages are not written. ``stop`` also tells whether the
    guardian was heard lately; if not, it does not vent in our place. ``law``, ``samples`` and
    ``recording`` are those of ``fprc.control.run``.

    Raises
    ------
    DeviceError
        A part cannot be opened; or an unexpected exception came, and closing failed too.
    """
    control, hardware = Control(**settings["control"]), settings["hardware"]
    limits, period_s = hardware["limits"], 1.0 / control.sample_rate_hz
    clock = Metronome(
        period_s, overruns_in_a_row=limits["overruns_in_a_row"], spin_s=hardware["loop"]["spin_s"]
    )
    notify(OPENING)  # the guardian then notices a call that hangs
    try:
        # the locks are inherited from the guardian
        opened = HardwareRig(hardware, clock.elapsed, has_lock=True, sleep=_wait)
    except DeviceError:
        notify(SAFE)  # nothing was moved
        raise
    notify(ARMED)
    timing: dict[str, float] = {}
    stopped = unvented = ""
    try:
        device: Device
        device = checked = CheckedRig(opened, limits, period_s, phi=bool(hardware["phi"]))
        if not moves:
            device = SimpleNamespace(
                read=checked.read, write=lambda *volts: None, safe=lambda: None
            )
        neutral_v = hardware["valves"]["neutral_v"]
        try:
            channels = run(
                device, clock, law, samples, control, neutral_v=neutral_v, stop=stop, **recording
            )
        except RunAbortedError as aborted:
            channels, stopped = aborted.channels, str(aborted)
        timing = clock.statistics()
    finally:
        try:
            opened.close()
            notify(SAFE)
        except DeviceError as closing:
            unvented = str(closing)
            if not stop.guarded():  # else only this process can vent
                unvented += f"\n{vent_until_shown(hardware)}"
            if not timing:
                raise DeviceError(unvented) from closing
    return Session(channels, timing, stopped, unvented)


def _wait(seconds: float) -> None:
    """Send a heartbeat, then sleep."""
    notify(HEARTBEAT)
    time.sleep(seconds)


#: File descriptors of the messages to the guardian, and of its heartbeats.
_pipes = {"out": 1, "in": 0}


def reserve_pipes() -> None:
    """Reserve the guardian's pipes for messages, and send what libraries print to stderr."""
    _pipes.update(out=os.dup(1), **{"in": os.dup(0)})
    os.dup2(2, 1)
    with open(os.devnull, "rb") as nothing:
        os.dup2(nothing.fileno(), 0)


def notify(message: bytes) -> None:
    """Send a message to the guardian. If it has ended, ``Stop`` ends the run."""
    with suppress(BrokenPipeError):
        os.write(_pipes["out"], message)


class Stop:
    """Reason to stop: a signal, or a guardian that ended or is silent.

    The loop asks at every tick, and each time the guardian gets a heartbeat if one is due.
    ``stalled_s`` is the longest time between the guardian's.
    """

    def __init__(self, stalled_s: float) -> None:
        self._reason = ""
        self._stalled_s = stalled_s
        self._heartbeat_s = self._sent_s = time.monotonic()
        for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
            signal.signal(number, self._signalled)
        threading.Thread(target=self._listen, daemon=True).start()

    def __call__(self) -> str:
        """Send a heartbeat; return the reason, empty if there is none."""
        now_s = time.monotonic()
        if now_s - self._sent_s >= BEAT_S:
            self._sent_s = now_s
            notify(HEARTBEAT)
        if not self.guarded() and not self._reason:
            self._reason = (
                f"the guardian process has been silent for {now_s - self._heartbeat_s:.2f} s "
                "(hardware.loop.stalled_s)"
            )
        return self._reason

    def guarded(self) -> bool:
        """Return whether the guardian was heard lately; it may have ended, or been stopped."""
        return time.monotonic() - self._heartbeat_s <= self._stalled_s

    def _signalled(self, number: int, frame: Any) -> None:
        self._reason = self._reason or "stopped by Ctrl-C or a signal"

    def _listen(self) -> None:
        while os.read(_pipes["in"], 64):
            self._heartbeat_s = time.monotonic()
        self._reason = self._reason or "the guardian process has ended"
        self._heartbeat_s = -math.inf
