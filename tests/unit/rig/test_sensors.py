import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from fprc.config import Settings
from fprc.rig.parameters import record
from fprc.rig.sensors import converted, pressure_voltage
from fprc.rig.simulator import draw_instruments

SENSOR = record(Settings().rig.pressure_sensor.model_dump())[0]
LSB_V = 20.0 / 65536.0


def test_gain_error_is_largest_at_full_scale_and_bow_in_the_middle():
    def error(p_kpa, gain, bow):
        ideal = pressure_voltage(SENSOR, p_kpa, 0.0, 0.0, 0.0, 0.0)
        return (pressure_voltage(SENSOR, p_kpa, gain, 0.0, bow, 0.0) - ideal) / 4.0

    assert error(1000.0, 0.002, 0.0) == pytest.approx(0.002)
    assert error(0.0, 0.002, 0.0) == 0.0
    pressures = np.linspace(0.0, 1000.0, 101)
    bow = np.array([error(p, 0.0, 0.002) for p in pressures])
    assert bow[0] == pytest.approx(0.0, abs=1e-12)
    assert bow[-1] == pytest.approx(0.0, abs=1e-12)
    assert bow.max() == pytest.approx(0.002)
    assert pressures[bow.argmax()] == 500.0


@given(st.integers(0, 2**31), st.sampled_from([0.0, 0.003, 0.007, 0.01]))
def test_drawn_instruments_keep_the_linearity_of_the_data_sheet(seed, linearity):
    rig = {"pressure_sensor": {"linearity": linearity}}
    drawn = draw_instruments(rig, np.random.default_rng([seed]))[0]
    for sensor in range(3):
        errors = (float(drawn[name][sensor]) for name in ("gain", "offset", "bow"))
        gain, offset, bow = errors
        for p_kpa in (0.0, 250.0, 500.0, 750.0, 1000.0):
            volts = pressure_voltage(SENSOR, p_kpa, gain, offset, bow, 0.0)
            assert abs(volts - (1.0 + 0.004 * p_kpa)) <= linearity * 4.0 + 1e-12


@pytest.mark.parametrize(
    ("volts", "seen"), [(12.0, 10.0), (-12.0, -10.0), (10.0, 10.0), (0.0, 0.0)]
)
def test_converter_saturates_at_its_limit(volts, seen):
    assert converted(volts, LSB_V, 10.0) == seen
