import subprocess
import sys

import pytest
import smbus2
from hypothesis import example, given
from hypothesis import strategies as st
from smbus2 import FakeBus

from fprc.devices.bendlabs import BendSensor, open_bus
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


@pytest.mark.parametrize(
    ("ticks", "sent"), [(81, "51 00"), (255, "ff 00"), (256, "00 01"), (16384, "00 40")]
)
def test_start_sets_the_rate_then_runs_and_waits_after_each(bus, ticks, sent):
    seen = []
    sensor = BendSensor(bus, 0x12, ticks=ticks)
    sensor.start(sleep=lambda seconds: seen.append((len(bus.exchanged), seconds)))
    assert transcript(bus) == [f"write 01 {sent}", "write 00 01 00"]
    assert seen == [(1, 0.002), (2, pytest.approx(ticks / 16384, rel=1e-4))]
    assert (bus.state, bus.ticks) == ("running", ticks)


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


def test_calibration_takes_out_zero_and_gain_of_the_sensor():
    bent_deg = 0.0
    bus = FakeBus(lambda: 0.5 * bent_deg + 7.0)
    sensor = BendSensor(bus, 0x12)
    sensor.start(sleep=lambda seconds: None)
    sensor.calibrate(0)
    bent_deg = 90.0
    sensor.calibrate(90)
    bent_deg = 30.0
    assert sensor.read() == 30.0
    sensor.restore_calibration()
    assert sensor.read() == 22.0
    sent = [line for line in transcript(bus) if line.startswith("write 07")]
    assert sent == ["write 07 00 00", "write 07 01 5a", "write 07 02 00"]


@pytest.mark.parametrize("angle_deg", [-90, 1, 44, 256, 90.5, float("nan")])
def test_calibration_at_an_angle_that_the_sensor_cannot_take_is_refused(bus, sensor, angle_deg):
    with pytest.raises(DeviceError, match=r"calibration at .* deg; must be 0, or .* 45 to 255"):
        sensor.calibrate(angle_deg)
    assert transcript(bus) == []


@pytest.mark.parametrize(
    ("request_", "arguments"),
    [("start", [lambda seconds: None]), ("read", []), ("calibrate", [90]),
     ("restore_calibration", []), ("shutdown", [])],
)  # fmt: skip
def test_every_request_to_an_empty_address_raises_device_error(bus, request_, arguments):
    with pytest.raises(DeviceError, match=r"0x13 on I2C bus 1: .* failed"):
        getattr(BendSensor(bus, 0x13), request_)(*arguments)
    assert transcript(bus) == []


def test_without_smbus2_the_module_loads_and_opening_says_how_to_install_it(monkeypatch):
    monkeypatch.setitem(sys.modules, "smbus2", None)
    with pytest.raises(DeviceError, match="pip install smbus2"):
        open_bus(1)
    code = "import sys; sys.modules['smbus2'] = None; import fprc.devices.bendlabs"
    subprocess.run([sys.executable, "-c", code], check=True)


@pytest.mark.parametrize(
    ("raised", "advice"),
    [(FileNotFoundError, "raspi"), (PermissionError, "usermod"), (OSError, "i2cdetect")],
)
def test_bus_that_cannot_be_opened_says_what_to_do(monkeypatch, raised, advice):
    def refuse(number):
        raise raised

    monkeypatch.setattr(smbus2, "SMBus", refuse)
    with pytest.raises(DeviceError, match=f"^I2C bus 3: .*{advice}"):
        open_bus(3)
