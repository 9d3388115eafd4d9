import math

import numpy as np
import pytest

from fprc.channels import unit_of
from fprc.recordings.clock import guess_clock
from fprc.recordings.names import factor_of, has, likely_channel, parse_unit, unit_in
from fprc.recordings.table import Column

PSI = 6.894757293168361
#: Name of a column; its unit's factor to that of the channel, None without a unit; its channel.
NAMES = [
    ("angle [rad]", 180.0 / math.pi, "theta_deg"),
    ("angle_degrees", 1.0, "theta_deg"),
    ("Winkel (°)", 1.0, "theta_deg"),
    ("/robot/bendAngle", None, "theta_deg"),
    ("theta_d", None, None),
    ("desired angle", None, None),
    ("angle error", None, None),
    ("P set [bar]", 100.0, "p_exp_command_kpa"),
    ("pressure_psi", PSI, "p_exp_kpa"),
    ("Pressure PA (bar)", 100.0, "p_exp_kpa"),
    ("pressure_PA", None, "p_exp_kpa"),
    ("Pressure [barg]", 100.0, "p_exp_kpa"),
    ("pressure (psig)", PSI, "p_exp_kpa"),
    ("pressureKPa", 1.0, "p_exp_kpa"),
    ("pressureBar", 100.0, "p_exp_kpa"),
    ("pressure (mmHg)", 0.133322387415, "p_exp_kpa"),
    ("pressure [hPa]", 0.1, "p_exp_kpa"),
    ("pressure {atm}", 101.325, "p_exp_kpa"),
    ("pressure (Torr)", 101.325 / 760.0, "p_exp_kpa"),
    ("pressure [kgf/cm²]", 98.0665, "p_exp_kpa"),
    ("pressure [kgf/cm^2]", 98.0665, "p_exp_kpa"),
    ("p / bar", 100.0, "p_exp_kpa"),
    ("PAM B [kPa abs]", 1.0, "p_o_kpa"),
    ("PAM B, kPa (abs)", 1.0, "p_o_kpa"),
    ("Po(mbar)", 0.1, "p_o_kpa"),
    ("Kammerdruck_kPa", 1.0, "p_o_kpa"),
    ("position", None, None),
    ("p_i_command_kpa", 1.0, "p_i_command_kpa"),
    ("valve_main_v", 1.0, "valve_main_v"),
    ("actuator_current_A", None, None),
    ("bending_moment_Nm", 1.0, None),
    ("free_memory", None, None),
    ("pressure sensor [V]", 1.0, None),
    ("angle temperature", None, None),
    ("theta_dot", None, None),
    ("arm/pressure_kPa/data", 1.0, "p_exp_kpa"),
    ("angle_rate_deg/s", 1.0, None),
    ("angular velocity (deg/s)", 1.0, None),
]


@pytest.mark.parametrize(("name", "factor", "channel"), NAMES)
def test_name_of_a_column_tells_its_unit_and_channel(name, factor, channel):
    unit, guess = unit_in(name), likely_channel(name)
    assert (guess[0] if guess else None) == channel
    assert (unit.factor if unit else None) == (factor and pytest.approx(factor, rel=1e-6))
    assert channel is None or unit is None or factor_of(unit.text, unit_of(channel)) == unit.factor


def test_factor_beside_a_unit_is_told_apart():
    for text in ("0.1 bar", "10^-1 bar", "x0.1 bar", "1e-1 bar"):
        unit = parse_unit(text)
        assert (unit.text, unit.multiple) == ("bar", pytest.approx(0.1))
    assert factor_of("0.1 bar", "kPa") == pytest.approx(10.0)
    assert factor_of("rad", "kPa") is None
    assert factor_of("1", "kPa") == 1.0


@pytest.mark.parametrize(
    ("name", "reference"),
    [("p [bara]", ["absolute"]), ("p (psia)", ["absolute"]), ("p abs [kPa]", ["absolute"]),
     ("Absolutdruck absolut", ["absolute"]), ("p [barg]", ["gauge"]), ("p bar(g)", ["gauge"]),
     ("p rel.", ["gauge"]), ("p [bar]", []), ("Pa", [])],
)  # fmt: skip
def test_pressure_says_whether_it_is_absolute(name, reference):
    assert [what for what in ("absolute", "gauge") if has(name, what)] == reference


COUNT = np.arange(400)
RAMP = np.linspace(0.0, 1.0, 400)


def test_clock_has_the_unit_beside_it():
    assert guess_clock("stamp", Column(5.0 * COUNT, "milliseconds"))[:2] == ("ms", 200.0)
    assert guess_clock("time", Column(5.0 * COUNT, "kPa")) is None
    (doubt,) = guess_clock("time_s", Column(np.append(COUNT, 398.0))).doubts
    assert "sample 400, from 399 to 398" in doubt


@pytest.mark.parametrize(
    ("name", "values", "unit", "rate_hz"),
    [
        ("", 0.005 * COUNT, "s", 200.0),
        ("time [s]", 1.0 * COUNT, "s", 1.0),
        ("Elapsed [ms]", 5.0 * COUNT, "ms", 200.0),
        ("t_µs", 5000.0 * COUNT, "us", 200.0),
        ("ticks", 5.0 * COUNT, "ms", 200.0),
        ("micros", 1e9 + 5000.0 * COUNT, "us", 200.0),
        ("t", 1.4e9 + 5000.0 * COUNT, "us", 200.0),
        ("datenum", 739319.88 + COUNT / 8.64e6, "d", 100.0),
        ("n", 1.0 * COUNT, None, None),
        ("count", 5.0 * COUNT, None, None),
        ("x", RAMP**4, None, None),
        ("time", 0.0 * COUNT, None, None),
        ("T [°C]", 20.0 + 0.01 * COUNT, None, None),
        ("p_min", RAMP**4, None, None),
        ("angle", np.sin(RAMP * 9), None, None),
        ("big", np.append([-1e308], 1e308 + 1e306 * RAMP), None, None),
    ],
)
def test_clock_has_the_unit_that_its_name_or_its_numbers_give(name, values, unit, rate_hz):
    clock = guess_clock(name, Column(values))
    assert (clock.unit if clock else None) == unit
    assert clock is None or clock.rate_hz == pytest.approx(rate_hz, rel=1e-3)
