import sys
from unittest.mock import Mock

import pytest
import smbus2
from hypothesis import example, given
from hypothesis import strategies as st
from smbus2 import FakeBus

from fprc.apparatus.bendlabs import BendSensor, open_bus
from fprc.errors import DeviceError


@pytest.fixture
def bus():
    """Bus whose sensor is bent by ``bus.bend_deg``."""
    bus = FakeBus(lambda: bus.bend_deg)
    bus.bend_deg = 12.5
    bus.number = 1
    return bus


@pytest.fixture
def sensor(bus):
    """A started sensor, on a bus without a record of the start."""
    sensor = BendSensor(bus, 0x12)
    sensor.start(sleep=lambda seconds: None)
    bus.exchanged.clear()
    return sensor


def transcript(bus):
    return [f"{way} {packet.hex(' ')}" for way, packet in bus.exchanged]


def test_start_sets_the_rate_then_runs_and_waits_after_each(bus):
    seen = []
    sensor = BendSensor(bus, 0x12)
    sensor.start(sleep=lambda seconds: seen.append((len(bus.exchanged), seconds)))
    assert transcript(bus) == ["write 01 51 00", "write 00 01 00"]
    assert seen == [(1, 0.002), (2, pytest.approx(81 / 16384, rel=1e-4))]
    assert (bus.state, bus.ticks) == ("running", 81)


@given(st.integers(-32768, 32767))
@example(-32768)
@example(32767)
@example(-1)
@example(255)
@example(256)
def test_every_angle_of_the_sensor_comes_back(counts):
    bus = FakeBus(lambda: counts / 64)
    sensor = BendSensor(bus, 0x12)
    sensor.start(sleep=lambda seconds: None)
    assert sensor.read() == counts / 64
    assert bus.exchanged[-1] == ("read", b"\x00" + counts.to_bytes(2, "little", signed=True))


def test_sensor_sleeps_after_shutdown_and_starts_again(bus, sensor):
    assert sensor.read() == 12.5
    sensor.shutdown()
    assert sensor.read() is None
    sensor.start(sleep=lambda seconds: None)
    assert sensor.read() == 12.5
    assert transcript(bus)[1] == "write 00 00 00"


@pytest.mark.parametrize(
    ("request_", "arguments"), [("start", [lambda seconds: None]), ("read", []), ("shutdown", [])]
)
def test_every_request_to_an_empty_address_raises_device_error(bus, request_, arguments):
    with pytest.raises(DeviceError, match=r"0x13 on I2C bus 1: .* failed"):
        getattr(BendSensor(bus, 0x13), request_)(*arguments)
    assert transcript(bus) == []


def test_without_smbus2_opening_says_how_to_install_it(monkeypatch):
    monkeypatch.setitem(sys.modules, "smbus2", None)
    with pytest.raises(DeviceError, match="pip install smbus2"):
        open_bus(1)


@pytest.mark.parametrize("raised", [FileNotFoundError, PermissionError, OSError])
def test_bus_that_cannot_be_opened_is_named(monkeypatch, raised):
    monkeypatch.setattr(smbus2, "SMBus", Mock(side_effect=raised))
    with pytest.raises(DeviceError, match="^I2C bus 3: "):
        open_bus(3)
