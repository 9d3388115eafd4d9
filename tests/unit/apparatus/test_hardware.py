import math
from contextlib import nullcontext
from itertools import count
from unittest.mock import Mock

import pytest
import smbus2

from fprc.apparatus import hardware as module
from fprc.apparatus.contec import locked
from fprc.apparatus.hardware import HardwareRig
from fprc.errors import DeviceError


@pytest.fixture
def hardware(settings):
    return settings["hardware"]


@pytest.fixture
def build(bench, hardware, monkeypatch):
    """Open the rig; keeps the buses of its sensors, of which ``close`` counts its calls."""
    open_bus = smbus2.SMBus

    def open_and_keep(number):
        build.buses.append(open_bus(number))
        build.buses[-1].close = Mock(wraps=build.buses[-1].close)
        return build.buses[-1]

    def build(wait=bench.wait):
        return HardwareRig(hardware, bench.elapsed, wait, nullcontext())

    monkeypatch.setattr(module, "time", Mock(monotonic=bench.elapsed))
    monkeypatch.setattr(smbus2, "SMBus", open_and_keep)
    build.buses = []
    return build


def written(bench, since=0):
    return [row[1:] for row in bench.writes()[since:]]


def test_readings_come_from_their_own_channels_calibrated(bench, hardware, build):
    hardware["boards"] |= {"p_exp_input": 4, "p_i_input": 0, "p_o_input": 2}
    hardware["p_exp"] = {"zero_v": 1.0, "gain_kpa_per_v": 250.0}
    hardware["p_i"] = {"zero_v": 0.5, "gain_kpa_per_v": 100.0}
    hardware["p_o"] = {"zero_v": -1.0, "gain_kpa_per_v": 10.0}
    hardware["theta"] |= {"gain": -2.0, "offset_deg": 1.0}
    rig = build()
    bench.shared.inputs[:5] = [2.5, 9.0, 1.0, 9.0, 3.0]
    bench.shared.angles[:] = [10.0, -30.0]
    bench.tick = 7
    assert rig.read() == (7 * bench.period_s, 500.0, -19.0, 200.0, 20.0, -30.0)


def test_valves_have_their_own_channels_and_voltages_of_the_safe_state(bench, hardware, build):
    hardware["boards"] |= {"main_output": 3, "reservoir_output": 2}
    hardware["valves"] = {"neutral_v": 4.5, "vent_v": 0.25}
    rig = build()
    rig.write(6.0, 7.0)
    vent = [(3, 0.25), (2, 0.25)]
    for _ in range(2):
        rig.safe()
    assert written(bench) == [*vent, (3, 6.0), (2, 7.0), *2 * [(3, 4.5), (2, 4.5), *vent]]


@pytest.mark.parametrize("phi", [True, False])
def test_close_vents_and_releases_everything(bench, hardware, build, phi):
    hardware["phi"] = hardware["phi"] if phi else None
    rig = build()
    assert math.isnan(rig.read().phi_deg) is not phi
    rig.write(9.0, 9.0)
    rig.close()
    writes = written(bench, since=4)
    assert writes == [(0, 0.0), (1, 0.0)] * (len(writes) // 2)
    assert bench.shared.opened == 0
    states = {at: sensor.state for bus in build.buses for at, sensor in bus.sensors.items()}
    assert states == dict.fromkeys([0x12, 0x13][: 1 + phi], "standby")
    assert [bus.close.call_count for bus in build.buses] == [1] * (1 + phi)


def test_rig_without_an_angle_sensor_is_vented_and_released(bench, build):
    bench.shared.i2c_fault = 1
    with pytest.raises(DeviceError, match="angle sensor 0x12"):
        build()
    assert written(bench) == 2 * [(0, 0.0), (1, 0.0)]
    assert (bench.shared.opened, build.buses[0].close.call_count) == (0, 1)


def test_rig_that_another_program_has_is_refused_before_any_call_of_the_driver(bench, hardware):
    rig = HardwareRig(hardware, bench.elapsed, bench.wait, locked(hardware))
    calls = bench.shared.calls
    with pytest.raises(DeviceError, match="in use"):
        HardwareRig(hardware, bench.elapsed, bench.wait, locked(hardware))
    assert bench.shared.calls == calls
    rig.close()
    with locked(hardware):
        pass


def test_heart_beats_at_every_sample_that_reached_both_valves_and_at_no_other(
    bench, hardware, build
):
    hardware["boards"]["heartbeat_output"] = 6
    rig = build()
    for _ in range(3):
        rig.write(6.0, 7.0)
    for at, reached in enumerate([(1, 7.0), (0, 6.0)]):
        bench.fail(skip=at)
        with pytest.raises(DeviceError, match="AioSingleAoEx"):
            rig.write(6.0, 7.0)
        assert written(bench)[-1] == reached  # though the other valve could not be written
    rig.safe()
    rig.close()
    assert [volts for channel, volts in written(bench) if channel == 6] == [5.0, 0.0, 5.0]


#: What happens at each look, given its number, and what is said.
SHOW_NOTHING = {
    "one reading in five": (lambda bench, k: 2.6 if k % 5 else 1.0, "MAY BE UNDER PRESSURE"),
    "frozen": (lambda bench, k: 1.01, "frozen"),
    "one failure in five": (lambda bench, k: k % 5 or bench.fail(), "MAY BE UNDER PRESSURE"),
}


@pytest.mark.parametrize(("volts", "message"), SHOW_NOTHING.values(), ids=SHOW_NOTHING)
def test_reading_of_no_pressure_that_shows_nothing_is_not_believed(
    bench, hardware, build, volts, message
):
    hardware["valves"]["vent_s"] = 1.0
    looks = count(1)

    def wait(seconds):
        bench.wait(seconds)
        reading = volts(bench, next(looks)) if opened else None
        if isinstance(reading, float):
            bench.shared.inputs[0] = reading

    opened = []
    rig = build(wait)
    opened.append(rig)
    bench.shared.inputs[0] = 1.01
    with pytest.raises(DeviceError, match=message):
        rig.close()
