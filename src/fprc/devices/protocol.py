"""What every rig can do: read sensors, write valve voltages, be safe, close."""

from typing import NamedTuple, Protocol

#: Voltage that closes a proportional valve.
NEUTRAL_V = 5.0


class Readings(NamedTuple):
    """One sample of all sensors. Pressures are gauge; phi is the reservoir's bending."""

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
        """Hold these voltages on the valves of actuator and reservoir."""

    def safe(self) -> None:
        """Bring the rig to its safe state; may be called at any time, twice too."""

    def close(self) -> None:
        """Make safe and release the hardware."""


class Clock(Protocol):
    """The clock that a rig lives by."""

    def wait_for(self, tick: int) -> int:
        """Return when this tick is due, and which is: a later one if some were missed."""
