import pytest

from fprc.config import check
from fprc.errors import ConfigError


def boards(**changed):
    return {"hardware": {"boards": changed}}


def valves(neutral_v, vent_v):
    return {"hardware": {"valves": {"neutral_v": neutral_v, "vent_v": vent_v}}}


def limits(name, *ends):
    return {"hardware": {"limits": {name: ends}}}


def sensor(name, **changed):
    return {"hardware": {name: changed}}


def gain(loop, kp_v_per_kpa):
    return {"control": {loop: {"kp_v_per_kpa": kp_v_per_kpa}}}


@pytest.mark.parametrize(
    ("config", "place", "what"),
    [
        # a vent voltage that does not open the valve to the room
        (valves(5.0, 5.0), "hardware.valves", "vent_v"),
        (valves(4.5, 2.6), "hardware.valves", "vent_v"),
        # limits that leave out a vented chamber
        (limits("p_exp_kpa", 0.0, 400.0), "hardware.limits.p_exp_kpa", ""),
        (limits("p_exp_kpa", 10.0, 400.0), "hardware.limits.p_exp_kpa", ""),
        (limits("p_i_kpa", 0.0, 400.0), "hardware.limits.p_i_kpa", ""),
        (limits("p_i_kpa", -90.0, -10.0), "hardware.limits.p_i_kpa", ""),
        # a gain without the sign of the loop
        (gain("main_loop", 0.0), "control.main_loop.kp_v_per_kpa", ""),
        (gain("reservoir_loop", -0.03), "control.reservoir_loop.kp_v_per_kpa", ""),
        # a sensor that would hide a fault
        (sensor("p_exp", zero_v=0.0), "hardware", "p_exp: with a broken cable, at 0 V"),
        (sensor("p_i", zero_v=0.05), "hardware", "would read -12.5 kPa"),
        (sensor("p_exp", gain_kpa_per_v=100.0), "hardware", "full 5 V the sensor would read 400"),
        (sensor("p_o", zero_v=3.5), "hardware", "p_o: at its full 5 V"),
        (sensor("p_exp", gain_kpa_per_v=2.5), "hardware.p_exp.gain_kpa_per_v", ""),
        (sensor("theta", gain=0), "hardware.theta.gain", ""),
        (sensor("phi", address=0x12), "hardware", "0x12"),
        # wiring and names
        (boards(main_output=5, heartbeat_output=5), "hardware.boards", "share a channel"),
        (boards(reservoir_output=5, heartbeat_output=5), "hardware.boards", "share a channel"),
        (boards(p_i_input=0), "hardware.boards", "share an input channel"),
        (boards(input_device="AIO001"), "hardware.boards", "AIO001"),
        (boards(lock_folder="locks"), "hardware.boards.lock_folder", "locks"),
        (boards(lock_folder="~/locks"), "hardware.boards.lock_folder", "~/locks"),
        (boards(lock_folder="/run\0"), "hardware.boards.lock_folder", "NUL"),
        (boards(library="lib\0caio.so"), "hardware.boards.library", "NUL"),
        (boards(input_device="AIO\0"), "hardware.boards.input_device", "NUL"),
        (boards(output_device="AIO\x1b"), "hardware.boards.output_device", r"AIO\x1b"),
    ],
)
def test_setting_that_makes_no_safe_rig_is_refused(config, place, what):
    with pytest.raises(ConfigError) as caught:
        check(config)
    _, line = str(caught.value).splitlines()
    assert line.startswith((f"  {place}: ", f"  {place} = ", f"  {place}.{what} = "))
    assert what in line


def test_null_of_the_command_line_is_no_heartbeat():
    assert check(boards(heartbeat_output="null")).hardware.boards.heartbeat_output is None
