import pytest

from fprc.config import check
from fprc.errors import ConfigError


@pytest.mark.parametrize(
    ("hardware", "place", "what"),
    [
        # a vent voltage that does not open the valve to the atmosphere
        ({"valves": {"neutral_v": 5.0, "vent_v": 5.0}}, "valves", "vent_v"),
        ({"valves": {"neutral_v": 4.5, "vent_v": 2.6}}, "valves", "vent_v"),
        # limits that leave out a vented chamber
        ({"limits": {"p_exp_kpa": (0.0, 400.0)}}, "limits.p_exp_kpa", ""),
        ({"limits": {"p_i_kpa": (-90.0, -10.0)}}, "limits.p_i_kpa", ""),
        # a sensor that would hide a fault
        ({"p_exp": {"zero_v": 0.0}}, "", "p_exp: with a broken cable, at 0 V"),
        ({"p_exp": {"gain_kpa_per_v": 100.0}}, "", "full 5 V the sensor would read 400"),
        ({"p_o": {"zero_v": 3.5}}, "", "p_o: at its full 5 V"),
        ({"p_exp": {"gain_kpa_per_v": 2.5}}, "p_exp.gain_kpa_per_v", ""),
        ({"theta": {"gain": 0}}, "theta.gain", ""),
        ({"phi": {"address": 0x12}}, "", "0x12"),
        # wiring and names
        ({"boards": {"main_output": 5, "heartbeat_output": 5}}, "boards", "share a channel"),
        ({"boards": {"p_i_input": 0}}, "boards", "share an input channel"),
        ({"boards": {"input_device": "AIO001"}}, "boards", "AIO001"),
    ],
)
def test_setting_that_makes_no_safe_rig_is_refused(hardware, place, what):
    with pytest.raises(ConfigError) as caught:
        check({"hardware": hardware})
    _, line = str(caught.value).splitlines()
    place = f"hardware.{place}".rstrip(".")
    assert line.startswith((f"  {place}: ", f"  {place} = ", f"  {place}.{what} = "))
    assert what in line


def test_null_of_the_command_line_is_no_heartbeat():
    boards = check({"hardware": {"boards": {"heartbeat_output": "null"}}}).hardware.boards
    assert boards.heartbeat_output is None
