"""Interface of every rig, simulated or real."""

from typing import Protocol

from fprc.channels import Readings


class Device(Protocol):
    """A rig at the level of valve voltages and sensor readings."""

    def read(self) -> Readings:
        """Return the latest reading of every sensor."""

    def write(self, main_v: float, reservoir_v: float) -> None:
        """Set the voltages of the actuator's and the reservoir's valve."""

    def safe(self) -> None:
        """Vent both chambers; may be called at any time, and repeatedly."""


class Clock(Protocol):
    """Clock of a rig."""

    def wait_for(self, tick: int) -> int:
        """Wait until this tick is due; return the tick now due, a later one if some were missed."""
