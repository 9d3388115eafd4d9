"""The channels of a log: their kinds, units and plausible values, and the logs that need them."""

import math
from typing import Literal, NamedTuple

from fprc.errors import LogError

#: Unit of a channel by the ending of its name.
UNITS = {"_kpa": "kPa", "_deg": "deg", "_s": "s", "_v": "V", "_norm": "-"}


class Channel(NamedTuple):
    """One channel of a log."""

    name: str  #: ends with its unit, see ``UNITS``
    kind: Literal["time", "command", "sensor", "valve", "tracking", "learning"]
    meaning: str
    #: Lowest and highest plausible value, or the key under ``quality`` in the configuration that
    #: holds them; None: any value is plausible.
    plausible: str | tuple[float, float] | None
    #: Sources whose logs need it. A closed-loop run needs the channels of kind ``tracking``, and no
    #: other log does.
    needed: tuple[str, ...]


_ALL, _RECORDED, _SIMULATED = ("sim", "rig", "import"), ("sim", "rig"), ("sim",)
_EFFORT_KPA = (-1000.0, 1000.0)

# fmt: off
#: Every channel, in the order of a log. A sensor that is needed by no source may be added without
#: making earlier logs incomplete; ``Readings`` has a field for each sensor.
CHANNELS = (
    Channel("time_s", "time", "time of the sample", None, _ALL),
    Channel("p_exp_command_kpa", "command", "commanded pressure of the actuator, P_exp",
            "pressure_range_kpa", _RECORDED),
    Channel("p_exp_kpa", "sensor", "measured pressure of the actuator",
            "pressure_range_kpa", _RECORDED),
    Channel("theta_deg", "sensor", "bending angle", "angle_range_deg", _ALL),
    Channel("p_i_command_kpa", "command", "commanded pressure of PAM A, K_in theta",
            "pressure_range_kpa", _RECORDED),
    Channel("p_i_kpa", "sensor", "measured pressure of PAM A", "pressure_range_kpa", _RECORDED),
    Channel("p_o_kpa", "sensor", "pressure of the sealed PAM B", "pressure_range_kpa", _RECORDED),
    Channel("phi_deg", "sensor", "bending angle of the reservoir itself",
            (-120.0, 120.0), _SIMULATED),
    Channel("valve_main_v", "valve", "voltage written to the actuator's valve",
            (0.0, 10.0), _RECORDED),
    Channel("valve_reservoir_v", "valve", "voltage written to the reservoir's valve",
            (0.0, 10.0), _RECORDED),
    Channel("theta_d_deg", "tracking", "reference", "angle_range_deg", _ALL),
    Channel("p_ff_kpa", "tracking", "feedforward", _EFFORT_KPA, _ALL),
    Channel("p_fb_kpa", "tracking", "feedback", _EFFORT_KPA, _ALL),
    Channel("p_learned_kpa", "learning", "part of the feedforward that was learned in the run",
            _EFFORT_KPA, ()),
    Channel("learned_norm", "learning", "Euclidean norm of what the weights have learned",
            (0.0, 1e9), ()),
)
# fmt: on


class Readings(NamedTuple):
    """One sample of all sensors; pressures are gauge. A sensor that a rig lacks reads NaN."""

    time_s: float
    p_exp_kpa: float
    theta_deg: float
    p_i_kpa: float
    p_o_kpa: float
    phi_deg: float = math.nan


def _names(*kinds: str) -> tuple[str, ...]:
    return tuple(channel.name for channel in CHANNELS if channel.kind in kinds)


#: Names of the channels of raw logs: setpoints, measurements, valve voltages.
RAW_CHANNELS = _names("time", "command", "sensor", "valve")
#: Names of the further channels of a closed-loop run, and of one whose model learns.
TRACKING_CHANNELS, LEARNING_CHANNELS = _names("tracking"), _names("learning")
#: Channel that the models learn as P_exp, by ``evaluation.target``. An import needs one of them.
TARGETS = {"command": "p_exp_command_kpa", "measured": "p_exp_kpa"}
#: Names of all sensors, and of those that every real rig has.
SENSORS = _names("sensor")
NEEDED_SENSORS = tuple(c.name for c in CHANNELS if c.kind == "sensor" and "rig" in c.needed)


def needed_by(source: str, *, tracking: bool = False) -> tuple[str, ...]:
    """Return the channels that a log needs: of ``sim``, ``rig`` or ``import``, or such a run."""
    return tuple(
        channel.name
        for channel in CHANNELS
        if source in channel.needed and (tracking or channel.kind != "tracking")
    )


def unit_of(name: str) -> str:
    """Return the unit of a channel from the ending of its name; raise LogError for another."""
    for ending, unit in UNITS.items():
        if name.endswith(ending):
            return unit
    raise LogError(f"channel {name}: its name must end in one of {', '.join(UNITS)}")
