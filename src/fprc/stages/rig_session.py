"""A session with the real rig: opened, guarded, on its clock, and made safe at the end."""

import logging
import os
import signal
import sys
import threading
from collections.abc import Iterator, Mapping
from contextlib import contextmanager, suppress
from typing import Any

from fprc.control import PressurePI
from fprc.control.clock import Metronome
from fprc.control.realtime import be_punctual
from fprc.devices.hardware import HardwareRig
from fprc.devices.safety import Guarded
from fprc.stages.guardian import HOT, SAFE

log = logging.getLogger("fprc.rig")

_LOOPS = ("main_loop", "reservoir_loop")


@contextmanager
def rig(hardware: Mapping[str, Any], period_s: float) -> Iterator[tuple[Guarded, Metronome]]:
    """Open the real rig, guarded, and its clock; make it safe and release it at the end.

    Raises
    ------
    DeviceError
        A part cannot be opened, or the rig could not be made safe.
    """
    limits = hardware["limits"]
    clock = Metronome(
        period_s, overruns_in_a_row=limits["overruns_in_a_row"], spin_s=hardware["loop"]["spin_s"]
    )
    opened = HardwareRig(hardware, clock.elapsed)
    for line in be_punctual(hardware["loop"]["priority"]):
        log.info("%s", line)
    try:
        sign(HOT)
        yield Guarded(opened, limits, period_s, phi=bool(hardware["phi"])), clock
    finally:
        opened.close()
        sign(SAFE)


def loops(control: Mapping[str, Any]) -> dict[str, PressurePI]:
    """Return both pressure loops as ``fprc.control.run`` takes them."""
    period_s = 1.0 / control["sample_rate_hz"]
    return {name: PressurePI(**control[name], period_s=period_s) for name in _LOOPS}


def sign(what: bytes) -> None:
    """Tell the guardian; if it is gone, ``Stop`` knows."""
    with suppress(BrokenPipeError):
        os.write(sys.stdout.fileno(), what)


class Stop:
    """Reason to stop, once a signal has come or the guardian is gone."""

    def __init__(self) -> None:
        self._reason = ""
        for number in (signal.SIGINT, signal.SIGTERM):
            signal.signal(number, self._signalled)
        threading.Thread(target=self._wait_for_end, daemon=True).start()

    def __call__(self) -> str:
        """Return the reason; empty if there is none."""
        return self._reason

    def _signalled(self, number: int, frame: Any) -> None:
        self._reason = self._reason or f"stopped by {signal.Signals(number).name}"

    def _wait_for_end(self) -> None:
        sys.stdin.read()
        self._reason = self._reason or "the process that watches this one is gone"
