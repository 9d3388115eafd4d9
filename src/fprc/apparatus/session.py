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
) -> Session:
    """Open the real rig with its safety limits and clock; run a law; make it safe and release it.

    Unless the law ``moves`` the rig, its voltages are not written. If the guardian is not there to
    vent in our place, we try until readings show it. ``law``, ``samples`` and ``recording`` are
    those of ``fprc.control.run``.

    Raises
    ------
    DeviceError
        A part cannot be opened; or an unexpected exception came, and closing failed too.
    """
    control, hardware = Control(**settings["control"]), settings["hardware"]
    limits, period_s = hardware["limits"], 1.0 / control.sample_rate_hz
    clock = Metronome(period_s, limits["overruns_in_a_row"])

    def wait(seconds: float) -> None:
        guardian.notify(HEARTBEAT)
        time.sleep(seconds)

    guardian.notify(OPENING)  # it then notices a call that hangs
    try:
        opened = HardwareRig(hardware, clock.elapsed, sleep=wait)
    except DeviceError:
        guardian.notify(SAFE)  # nothing was moved
        raise
    guardian.notify(ARMED)
    timing: dict[str, float] = {}
    stopped = unvented = ""
    try:
        device: Device
        device = checked = CheckedRig(opened, limits, period_s, phi=bool(hardware["phi"]))
        if not moves:
            device = SimpleNamespace(
                read=checked.read, write=lambda *volts: None, safe=lambda: None
            )
        more = recording | {"neutral_v": hardware["valves"]["neutral_v"], "stop": guardian}
        try:
            channels = run(device, clock, law, samples, control, **more)
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
    return Session(channels, timing, stopped, unvented)
