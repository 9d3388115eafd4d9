import pytest

from fprc.config import check
from fprc.config.hardware import VENT_MARGIN_V
from fprc.errors import ConfigError


def refused(hardware):
    with pytest.raises(ConfigError) as caught:
        check({"hardware": hardware})
    return str(caught.value)


@pytest.mark.parametrize(("neutral_v", "vent_v"), [(5.0, 5.0), (5.0, 10.0), (5.0, 3.1), (4.5, 2.6)])
def test_vent_voltage_that_does_not_open_the_valve_to_the_room_is_refused(neutral_v, vent_v):
    said = refused({"valves": {"neutral_v": neutral_v, "vent_v": vent_v}})
    assert "hardware.valves" in said
    assert "vent_v" in said


def test_vent_voltage_at_the_margin_is_taken():
    valves = {"neutral_v": 5.0, "vent_v": 5.0 - VENT_MARGIN_V}
    assert check({"hardware": {"valves": valves}}).hardware.valves.vent_v == 3.0


@pytest.mark.parametrize("name", ["p_exp_kpa", "p_i_kpa"])
@pytest.mark.parametrize("limits", [(0.0, 400.0), (10.0, 400.0), (-90.0, -10.0)])
def test_limits_that_leave_out_a_vented_chamber_are_refused(name, limits):
    assert f"hardware.limits.{name}" in refused({"limits": {name: limits}})


@pytest.mark.parametrize("loop", ["main_loop", "reservoir_loop"])
@pytest.mark.parametrize("gain", [0.0, -0.03])
def test_gain_without_the_sign_of_the_loop_is_refused(loop, gain):
    with pytest.raises(ConfigError, match=rf"control\.{loop}\.kp_v_per_kpa"):
        check({"control": {loop: {"kp_v_per_kpa": gain}}})


@pytest.mark.parametrize("output", ["main_output", "reservoir_output"])
def test_heartbeat_on_the_channel_of_a_valve_is_refused(output):
    assert "share a channel" in refused({"boards": {output: 5, "heartbeat_output": 5}})


@pytest.mark.parametrize(
    ("sensor", "changed", "what"),
    [
        ("p_exp", {"zero_v": 0.0}, "at 0 V, the sensor would read 0 kPa"),
        ("p_i", {"zero_v": 0.05}, "at 0 V, the sensor would read -12.5 kPa"),
        ("p_exp", {"gain_kpa_per_v": 100.0}, "full 5 V the sensor would read 400 kPa"),
        ("p_o", {"zero_v": 3.5}, "full 5 V the sensor would read 375 kPa"),
    ],
)
def test_sensor_that_would_hide_a_fault_is_refused(sensor, changed, what):
    said = refused({sensor: changed})
    assert f"{sensor}: " in said
    assert what in said


def test_gain_that_is_off_by_a_hundred_is_refused():
    assert "hardware.p_exp.gain_kpa_per_v" in refused({"p_exp": {"gain_kpa_per_v": 2.5}})


@pytest.mark.parametrize(
    ("hardware", "what"),
    [
        ({"boards": {"lock_folder": "locks"}}, "must be an absolute path"),
        ({"boards": {"lock_folder": "~/locks"}}, "must be an absolute path"),
        ({"boards": {"input_device": "AIO001"}}, "are both AIO001"),
        ({"boards": {"library": "lib\0caio.so"}}, "library: contains the character NUL"),
        ({"boards": {"input_device": "AIO\0"}}, "input_device: contains the character NUL"),
        ({"boards": {"output_device": "AIO\x1b"}}, r"output_device: AIO\x1b: contains char"),
        ({"boards": {"lock_folder": "/run\0"}}, "lock_folder: contains the character NUL"),
        ({"theta": {"gain": 0}}, "must be 0.1 or more"),
    ],
)
def test_setting_that_makes_no_rig_is_refused(hardware, what):
    assert what in refused(hardware)


def test_null_of_the_command_line_is_no_heartbeat():
    boards = {"heartbeat_output": "null"}
    assert check({"hardware": {"boards": boards}}).hardware.boards.heartbeat_output is None
