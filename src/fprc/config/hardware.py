"""The real rig: boards, sensors, limits. Used only with ``source: rig``."""

from collections.abc import Iterator
from typing import Annotated

from pydantic import AfterValidator, Field

from fprc.config.section import Rising, Section, quantity


def _hold_a_vented_chamber(limits: tuple[float, float]) -> tuple[float, float]:
    if not limits[0] < 0.0 < limits[1]:
        raise ValueError(f"{limits} excludes 0 kPa, as of a vented chamber; begin below 0")
    return limits


def _reads_something(gain: float) -> float:
    if abs(gain) < 0.1:
        raise ValueError(f"{gain}: must be 0.1 or more, or -0.1 or less")
    return gain


#: Limits of a chamber that is vented, and a gain that is not nearly 0.
Vented = Annotated[Rising, AfterValidator(_hold_a_vented_chamber)]
Gain = Annotated[float, AfterValidator(_reads_something)]


# fmt: off
class Boards(Section):
    """Contec analog boards and the wiring of their channels."""

    library: str = Field("", description="the driver's shared library; empty: libcaio.so")
    input_device: str = Field("AIO000", min_length=1, max_length=32, description="input board")
    output_device: str = Field("AIO001", min_length=1, max_length=32, description="output board")
    p_exp_input: int = quantity(0, (0, 63), "channel of the actuator's pressure sensor")
    p_i_input: int = quantity(1, (0, 63), "channel of PAM A's pressure sensor")
    p_o_input: int = quantity(2, (0, 63), "channel of PAM B's pressure sensor")
    main_output: int = quantity(0, (0, 63), "channel of the actuator's valve")
    reservoir_output: int = quantity(1, (0, 63), "channel of the reservoir's valve")
    heartbeat_output: int | None = quantity(None, (0, 63),
        "channel that toggles between 0 and 5 V at every sample, for a watchdog relay that vents "
        "when the toggling stops; null: no relay")

    def _problems(self) -> Iterator[str]:
        for kind in ("input", "output", "device"):
            given = [value for name, value in self if name.endswith(f"_{kind}")]
            if len(set(given)) < len(given):
                yield f"{kind}s {given} are not different; give each its own"


class Transducer(Section):
    """Calibration of a pressure sensor: P = (V - zero_v) * gain_kpa_per_v."""

    zero_v: float = quantity(1, (-10, 10), "output at 0 kPa gauge", "data sheet: 1-5 V")
    gain_kpa_per_v: float = quantity(250, (50, 1000), "gain", "data sheet: 0-1 MPa")


class AngleSensor(Section):
    """Bend Labs one-axis sensor on an I2C bus."""

    bus: int = quantity(1, (0, 63), "number of the I2C bus, as in /dev/i2c-1")
    address: int = quantity(0x12, (0x08, 0x77), "I2C address; that of the factory is 0x12, 18")
    offset_deg: float = quantity(0, (-180, 180), "added after the gain")
    gain: Gain = quantity(1, (-10, 10), "factor on the reading, before the offset")


class Valves(Section):
    """Voltages of the two proportional valves."""

    neutral_v: float = quantity(5, (4.5, 5.5), "closes the valve", "data sheet")
    # the pressure loops fill a chamber with more voltage; 2 V below neutral opens the valve by 40 %
    vent_v: float = quantity(0, (0, 2.5), "opens to the atmosphere, at 0 V fully", "data sheet")
    vented_kpa: float = quantity(15, (1, 25), "largest reading of a vented chamber",
        "twice the sensor's 0.7 %")
    vent_s: float = quantity(5, (0.1, 60), "longest time for a chamber to vent")


class Limits(Section):
    """Allowed values; else a run ends: both valves go to neutral, then both chambers are vented."""

    p_exp_kpa: Vented = quantity((-20, 480), (-100, 1000), "pressure readings of the actuator")
    p_i_kpa: Vented = quantity((-20, 480), (-100, 1000), "pressure readings of PAM A")
    p_o_kpa: Rising = quantity((20, 400), (-100, 1000),
        "pressure readings of PAM B, sealed at 100 kPa")
    theta_deg: Rising = quantity((-20, 100), (-360, 360), "readings of the actuator's angle")
    phi_deg: Rising = quantity((-120, 120), (-360, 360), "readings of the reservoir's angle")
    pressure_step_kpa: float = quantity(60, (1, 1000), "largest change from sample to sample")
    angle_step_deg: float = quantity(15, (0.1, 360), "largest change from sample to sample")
    stale_s: float = quantity(0.25, (0.01, 10), "longest time without a new value from a sensor")
    overruns_in_a_row: int = quantity(5, (0, 1000), "missed ticks allowed in a row", unit="ticks")


class Loop(Section):
    """Real-time settings of the control loop."""

    stalled_s: float = quantity(0.5, (0.2, 10),
        "if the control loop is silent for longer, the guardian process kills it and vents; if the "
        "guardian is silent for longer, the loop vents and ends")
    opening_s: float = quantity(10, (1, 120),
        "if the control loop has not opened boards and sensors by then, the guardian kills it and "
        "vents")


class Hardware(Section):
    """The real rig."""

    boards: Boards = Boards()
    p_exp: Transducer = Transducer()
    p_i: Transducer = Transducer()
    p_o: Transducer = Transducer()
    theta: AngleSensor = AngleSensor()
    #: on the reservoir, for Fig. 17; null: none
    phi: AngleSensor | None = AngleSensor(address=0x13)
    valves: Valves = Valves()
    limits: Limits = Limits()
    loop: Loop = Loop()
    # fmt: on

    def _problems(self) -> Iterator[str]:
        remedy = "check zero_v, gain_kpa_per_v and limits"
        for name in ("p_exp", "p_i", "p_o"):
            sensor, (low, high) = getattr(self, name), getattr(self.limits, f"{name}_kpa")
            off, full = ((volts - sensor.zero_v) * sensor.gain_kpa_per_v for volts in (0.0, 5.0))
            if off >= min(low, -self.valves.vented_kpa):
                yield f"{name}: with a broken cable, 0 V, it reads a valid {off:g} kPa; {remedy}"
            if full <= high:
                yield f"{name}: at its full 5 V it reads {full:g} kPa, below its limit; {remedy}"
        theta, phi = self.theta, self.phi
        if phi and (theta.bus, theta.address) == (phi.bus, phi.address):
            yield (
                f"theta and phi share address {theta.address:#x} on I2C bus {theta.bus}; give one "
                "sensor another address or bus, or set phi: null if there is none"
            )
