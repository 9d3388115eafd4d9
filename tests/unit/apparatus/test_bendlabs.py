import sys
from unittest.mock import Mock

import pytest
import smbus2
from hypothesis import example, given
from hypothesis import strategies as st
from smbus2 import FakeBus

from fprc.apparatus.bendlabs import BendSensor, open_bus
from fprc.errors import DeviceError


def started(angle_deg, sleep=lambda seconds: None):
    """Return a bus and its sensor, which was started."""
    bus = FakeBus(lambda: angle_deg)
    sensor = BendSensor(bus, 0x12)
    sensor.start(sleep=sleep)
    return bus, sensor


def test_sensor_starts_waits_and_sleeps_after_shutdown():
    waited = []
    bus, sensor = started(12.5, waited.append)
    assert waited == [0.002, pytest.approx(81 / 16384, rel=1e-4)]
    assert (bus.state, bus.ticks) == ("running", 81)
    assert sensor.read() == 12.5
    sensor.shutdown()
    assert sensor.read() is None
    writes = [packet.hex(" ") for way, packet in bus.exchanged if way == "write"]
    assert writes == ["01 51 00", "00 01 00", "00 00 00"]


@given(st.integers(-32768, 32767))
@example(-32768)
@example(-1)
@example(256)
def test_every_angle_of_the_sensor_comes_back(counts):
    bus, sensor = started(counts / 64)
    assert sensor.read() == counts / 64
    assert bus.exchanged[-1] == ("read", b"\x00" + counts.to_bytes(2, "little", signed=True))


@pytest.mark.parametrize("call", ["start", "read", "shutdown"])
def test_every_request_to_an_empty_address_raises_device_error(call):
    bus = FakeBus(lambda: 0.0)
    with pytest.raises(DeviceError, match="0x13"):
        getattr(BendSensor(bus, 0x13), call)()
    assert not bus.exchanged


@pytest.mark.parametrize("module", [None, Mock(SMBus=Mock(side_effect=PermissionError)), smbus2])
def test_bus_that_cannot_be_opened_is_named(monkeypatch, module):
    """The package is missing, the user may not, or there is no bus."""
    monkeypatch.delenv("FAKE_BENCH", raising=False)
    monkeypatch.setitem(sys.modules, "smbus2", module)
    with pytest.raises(DeviceError, match="^I2C bus 3: "):
        open_bus(3)
