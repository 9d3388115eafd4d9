import math
from itertools import count
from unittest.mock import Mock

import pytest

from fprc.apparatus.bendlabs import open_bus
from fprc.apparatus.hardware import HardwareRig
from fprc.errors import DeviceError

VENTED = [(0, 5.0), (1, 5.0), (0, 0.0), (1, 0.0)]


@pytest.fixture
def hardware(settings):
    return settings["hardware"]


@pytest.fixture
def buses():
    """Buses that were opened, by number; ``bus.close`` counts its calls."""
    return {}


@pytest.fixture
def build(bench, hardware, buses, monkeypatch):
    """Open the rig on buses that are recorded."""

    def open_and_keep(number):
        assert number not in buses
        buses[number] = bus = open_bus(number)
        bus.close = Mock(wraps=bus.close)
        return bus

    def build():
        monkeypatch.setattr("fprc.apparatus.hardware.open_bus", open_and_keep)
        rig = HardwareRig(hardware, bench.elapsed, sleep=lambda seconds: None)
        rig._venting = {"sleep": bench.wait, "now": bench.elapsed}
        return rig

    return build


def written(bench, since=0):
    return [row[1:] for row in bench.writes()[since:]]


def states(bus):
    return {address: sensor.state for address, sensor in bus._sensors.items()}


def test_voltages_become_pressures_by_channel_and_calibration(bench, hardware, build):
    hardware["boards"] |= {"p_exp_input": 4, "p_i_input": 0, "p_o_input": 2}
    hardware["p_exp"] = {"zero_v": 1.0, "gain_kpa_per_v": 250.0}
    hardware["p_i"] = {"zero_v": 0.5, "gain_kpa_per_v": 100.0}
    hardware["p_o"] = {"zero_v": -1.0, "gain_kpa_per_v": 10.0}
    bench.shared.inputs[:5] = [2.5, 9.0, 1.0, 9.0, 3.0]
    now = build().read()
    assert (now.p_exp_kpa, now.p_i_kpa, now.p_o_kpa) == (500.0, 200.0, 20.0)


def test_angles_come_from_their_own_sensors_and_time_from_the_clock(bench, hardware, build):
    hardware["theta"] |= {"gain": -2.0, "offset_deg": 1.0}
    rig = build()
    bench.shared.angles[:] = [10.0, -30.0]
    bench.tick = 7
    now = rig.read()
    assert (now.theta_deg, now.phi_deg) == (-19.0, -30.0)
    assert now.time_s == 7 * bench.period_s


def test_absent_reservoir_sensor_reads_nan(bench, hardware, build, buses):
    hardware["phi"] = None
    rig = build()
    assert math.isnan(rig.read().phi_deg)
    rig.close()
    assert list(states(buses[1])) == [0x12]


def test_each_valve_has_its_own_channel(bench, hardware, build):
    hardware["boards"] |= {"main_output": 3, "reservoir_output": 2}
    rig = build()
    rig.write(6.0, 7.0)
    assert written(bench, since=2) == [(3, 6.0), (2, 7.0)]
    rig.safe()
    assert written(bench, since=4) == [(3, 5.0), (2, 5.0), (3, 0.0), (2, 0.0)]


def test_voltages_of_the_safe_state_are_those_configured(bench, hardware, build):
    hardware["valves"] = {"neutral_v": 4.9, "vent_v": 0.3}
    rig = build()
    expected = [(channel, pytest.approx(volts)) for volts in (4.9, 0.3) for channel in (0, 1)]
    for _ in range(2):
        rig.safe()
    assert written(bench) == expected[2:] + 2 * expected


@pytest.mark.parametrize("at", range(2))
def test_valve_that_cannot_be_written_does_not_keep_the_other_from_it(bench, build, at):
    rig = build()
    bench.fail(skip=at)
    with pytest.raises(DeviceError, match="AioSingleAoEx"):
        rig.write(6.0, 7.0)
    assert written(bench, since=2) == [[(1, 7.0)], [(0, 6.0)]][at]


def test_close_vents_and_releases_everything(bench, build, buses):
    rig = build()
    rig.write(9.0, 9.0)
    rig.close()
    assert written(bench, since=4) == VENTED[2:] * ((bench.shared.writes - 4) // 2)
    assert bench.shared.opened == 0
    assert states(buses[1]) == {0x12: "standby", 0x13: "standby"}
    assert buses[1].close.call_count == 1


def test_rig_without_an_angle_sensor_is_vented_and_released(bench, build, buses):
    bench.shared.i2c_fault = 1
    with pytest.raises(DeviceError) as caught:
        build()
    assert [line[:17] for line in str(caught.value).splitlines()] == [
        "angle sensor 0x12", "angle sensor 0x13",
    ]  # fmt: skip
    assert written(bench) == VENTED[2:] + VENTED[2:]
    assert (bench.shared.opened, buses[1].close.call_count) == (0, 1)


def test_heart_beats_at_every_sample_that_reached_both_valves_and_at_no_other(
    bench, hardware, build
):
    hardware["boards"]["heartbeat_output"] = 6
    rig = build()
    for _ in range(3):
        rig.write(6.0, 7.0)
    assert [volts for channel, volts in written(bench) if channel == 6] == [5.0, 0.0, 5.0]
    bench.fail()
    with pytest.raises(DeviceError):
        rig.write(6.0, 7.0)
    rig.safe()
    rig.close()
    assert [volts for channel, volts in written(bench) if channel == 6] == [5.0, 0.0, 5.0]


@pytest.mark.parametrize(
    ("volts", "message"),
    [
        (lambda look: 2.6 if look % 5 else 1.0, "MAY BE UNDER PRESSURE"),
        (lambda look: 1.01, "p_exp_kpa never changed: frozen sensor"),
    ],
    ids=["one reading in five", "frozen"],
)
def test_reading_of_no_pressure_that_shows_nothing_is_not_believed(
    bench, hardware, build, volts, message
):
    hardware["valves"]["vent_s"] = 1.0
    rig = build()
    hardware["boards"]["main_output"] = 5
    looks = count(1)

    def wait(seconds):
        bench.wait(seconds)
        bench.shared.inputs[0] = volts(next(looks))

    bench.shared.inputs[0] = volts(0)
    rig._venting["sleep"] = wait
    with pytest.raises(DeviceError, match=message):
        rig.close()


def test_readings_in_a_row_begin_again_after_one_that_failed(bench, hardware, build):
    hardware["valves"]["vent_s"] = 1.0
    rig = build()
    looks = count(1)

    def wait(seconds):
        bench.wait(seconds)
        if next(looks) % 5 == 0:
            bench.fail(skip=2)  # both writes succeed

    rig._venting["sleep"] = wait
    with pytest.raises(DeviceError, match="MAY BE UNDER PRESSURE"):
        rig.close()
    assert bench.shared.failures >= 1
