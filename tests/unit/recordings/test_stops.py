from contextlib import nullcontext
from pathlib import Path

import numpy as np
import pytest

from fprc.errors import LogError
from fprc.evaluation.sides import Recordings
from fprc.recordings.importing import ImportMap
from fprc.recordings.stops import explained_by, refuse_channels, refuse_units
from fprc.recordings.table import Column, Table

UNITS = {"theta": "deg", "P_o": "kPa", "P_exp": "kPa"}
SIZE, RATE_HZ = 3000, 50.0
T = np.arange(SIZE) / RATE_HZ
ANGLE = 30.0 + 20.0 * np.sin(T) + 5.0 * np.sin(2.3 * T)
PRESSURE = 4.0 * ANGLE + 10.0 * np.sin(7.1 * T)
MEMORY = 100.0 + 10.0 * np.sin(0.4 * T)
NOISE = np.random.default_rng(0).standard_normal(SIZE)


def refuse(theta=ANGLE, p_o=MEMORY, target=PRESSURE, units=UNITS, outside=0):
    samples = {"theta_deg": outside, "p_exp_kpa": 0}
    quality = [{"samples": len(theta), "checks": {"range": {"samples": samples}}}]
    refuse_channels(Recordings(theta, p_o, target, [len(theta)], RATE_HZ), units, quality)


@pytest.mark.parametrize(
    "changed",
    [
        {},
        {"p_o": ANGLE + NOISE},  # a copy with noise gets an answer
        {"p_o": PRESSURE + 10.0 * NOISE},
        {"outside": 20},
        {"target": PRESSURE / 100.0, "units": {**UNITS, "P_exp": "N"}},
        {"theta": np.where(T < 25.0, ANGLE, ANGLE[1250])[:2400], "target": PRESSURE[:2400],
         "p_o": MEMORY[:2400]},
    ],
)  # fmt: skip
def test_recordings_that_can_be_judged_pass(changed):
    refuse(**changed)


@pytest.mark.parametrize(
    ("changed", "words"),
    [
        ({"theta": np.full(SIZE, 3.0)}, "theta stays at 3"),
        ({"p_o": np.where(T < 35.0, MEMORY[0], MEMORY)}, "P_o stays"),
        ({"target": PRESSURE / 100.0}, "P_exp spans"),
        ({"theta": np.deg2rad(ANGLE)}, "theta spans"),
        ({"outside": 40}, "theta_deg: 40 samples"),
        ({"p_o": ANGLE}, "straight line of theta"),
        ({"p_o": 3.0 - 2.0 * ANGLE}, "straight line of theta"),
        ({"p_o": np.roll(PRESSURE, 10)}, "straight line of P_o"),
        ({"target": 4.0 * ANGLE}, "straight line of theta"),
        ({"target": 100.0 + 30.0 * NOISE}, "next to nothing"),
        ({key: values[:1100] for key, values in
          {"theta": ANGLE, "p_o": MEMORY, "target": PRESSURE}.items()}, "too short"),
    ],
)  # fmt: skip
def test_recordings_that_cannot_be_judged_stop(changed, words):
    with pytest.raises(LogError, match=words):
        refuse(**changed)


def test_backlash_and_squares_of_theta_are_explained():
    target = np.abs(ANGLE - 30.0)
    assert explained_by(Recordings(ANGLE, MEMORY, target, [SIZE], RATE_HZ)) > 0.8


@pytest.mark.parametrize(
    ("column", "beside", "unit", "note", "passes"),
    [
        ("p [bar]", "", "bar", "", True),
        ("p [bar]", "", "kPa", "", False),
        ("p [bar]", "", "kPa", "the header is wrong", True),
        ("p", "", "kPa", "", True),
        ("p", "bar", "kPa", "", False),
        ("p [bar]", "", "1", "force [N]", True),
    ],
)
def test_unit_that_contradicts_the_file_stops(column, beside, unit, note, passes):
    mapping = ImportMap.model_validate({
        "experiment": "sweep", "time": {"rate_hz": 50},
        "channels": {
            "theta_deg": {"column": "a", "unit": "deg"},
            "p_exp_kpa": {"column": column, "unit": unit, "note": note},
        },
    })  # fmt: skip
    columns = {"a": Column(ANGLE), column: Column(PRESSURE, beside)}
    table = Table(Path("log.csv"), "", columns, {})
    with nullcontext() if passes else pytest.raises(LogError, match=r"channels\.p_exp_kpa"):
        refuse_units(mapping, table)
