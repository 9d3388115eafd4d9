import math
import sys
from unittest.mock import Mock

import pytest
import smbus2

from fprc.apparatus.bendlabs import BendSensor
from fprc.errors import DeviceError


def test_sensor_starts_waits_and_sleeps_after_shutdown(bench):
    waited, sensor = [], BendSensor(1, 0x12, 1.0, 0.0)
    bus = sensor._bus
    assert math.isnan(sensor.read())
    sensor.start(waited.append)
    assert waited == [0.002, pytest.approx(81 / 16384, rel=1e-4)]
    assert (bus.sensors[0x12].state, bus.sensors[0x12].ticks) == ("running", 81)
    for counts in (-32768, -257, -1, 0, 256, 800, 32767):
        bench.shared.angles[0] = counts / 64
        assert sensor.read() == counts / 64
    bench.shared.angles[0], bench.shared.i2c_fault = 5.0, 4  # packets without an angle
    assert sensor.read() == counts / 64
    sensor.shutdown()
    assert [packet.hex(" ") for packet in bus.written] == ["01 51 00", "00 01 00", "00 00 00"]


@pytest.mark.parametrize(("call", "given"), [("start", [Mock()]), ("read", []), ("shutdown", [])])
def test_sensor_that_does_not_answer_is_named(bench, call, given):
    bench.shared.i2c_fault = 1
    with pytest.raises(DeviceError, match="0x13"):
        getattr(BendSensor(1, 0x13, 1.0, 0.0), call)(*given)


@pytest.mark.parametrize("module", [None, Mock(SMBus=Mock(side_effect=PermissionError)), smbus2])
def test_bus_that_cannot_be_opened_is_named(monkeypatch, module):
    """The package is missing, the user may not, or there is no bus."""
    monkeypatch.delenv("FAKE_BENCH", raising=False)
    monkeypatch.setitem(sys.modules, "smbus2", module)
    with pytest.raises(DeviceError, match="^I2C bus 3: "):
        BendSensor(3, 0x12, 1.0, 0.0)
