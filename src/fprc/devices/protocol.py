"""Interface of every rig: read sensors, write valve voltages, make safe, close."""

from typing import NamedTuple, Protocol

#: Voltage that closes a proportional valve.
NEUTRAL_V = 5.0


class Readings(NamedTuple):
    """One sample of all sensors. Pressures are gauge; phi is the reservoir's bending angle."""

    time_s: float
    p_exp_kpa: float
    theta_deg: float
    p_i_kpa: float
    p_o_kpa: float
    phi_deg: float


class Device(Protocol):
    """A rig at the level of valve voltages and sensor readings."""

    def read(self) -> Readings:
        """Return the latest reading of every sensor."""

    def write(self, main_v: float, reservoir_v: float) -> None:
        """Set the voltages of both valves, actuator and reservoir."""

    def safe(self) -> None:
        """Bring the rig to its safe state; may be called at any time, and repeatedly."""

    def close(self) -> None:
        """Make safe and release the hardware."""


class Clock(Protocol):
    """Clock of a rig."""

    def wait_for(self, tick: int) -> int:
        """Wait until this tick is due; return the tick now due, a later one if some were missed."""
