"""The compiled runs give what the loop gives that also drives a real rig."""

import numpy as np
import pytest

from fprc.channels import TRACKING_CHANNELS, needed_by
from fprc.control import hysteresis_law, run, tracking_law
from fprc.devices.sim import SimulatedRig
from fprc.errors import ControlError, FprcError

SAMPLES = 5000


def device(rig):
    return SimulatedRig(rig, seed=3, run=0, sample_rate_hz=200.0)


def pressures(samples=SAMPLES):
    return 200.0 - 220.0 * np.sign(np.cos(2.0 * np.pi * 0.7 * np.arange(samples) / 200.0))


def test_hysteresis_run_is_that_of_the_loop_bit_by_bit(rig, control):
    # below 0 kPa and beyond what the valve can follow, so that every limit is reached
    commands = pressures()
    law = hysteresis_law(commands, control)
    slow = device(rig)
    expected = run(slow, slow, law, SAMPLES, control)
    assert {0.0, 10.0} <= set(expected["valve_main_v"])
    assert (expected["p_i_command_kpa"] == 0.0).any()
    result = device(rig).follow(control, commands)
    assert list(result) == list(needed_by("sim"))
    for name, values in result.items():
        np.testing.assert_array_equal(values, expected[name], err_msg=name)


class Line:
    """A model whose P_ff is a line over theta_d."""

    n_features_in_ = 1

    def step(self, x):
        return 12.0 * x[0] - 100.0


@pytest.mark.parametrize("feedback", [None, "incremental", "positional"])
def test_tracking_run_is_that_of_the_loop_bit_by_bit(rig, control, feedback):
    time_s = np.arange(SAMPLES) / 200.0
    theta_d = 32.5 - 27.5 * np.cos(2.0 * np.pi * 0.4 * time_s)
    p_ff, pushes = 12.0 * theta_d - 100.0, 100.0 * np.sin(3.0 * time_s)
    control = control.changed(feedback=feedback or control.feedback)
    law = tracking_law(theta_d, control, 300.0, model=Line(), feedback=bool(feedback))
    slow = device(rig)

    class Clock:
        def wait_for(self, tick):
            slow.push_kpa = pushes[tick]
            return slow.wait_for(tick)

    expected = run(slow, Clock(), law, SAMPLES, control, extra=TRACKING_CHANNELS)
    assert {0.0, 300.0} <= set(expected["p_exp_command_kpa"])
    result = device(rig).follow(
        control, p_ff, theta_d, 300.0, feedback=bool(feedback), push_kpa=pushes
    )
    for name, values in result.items():
        np.testing.assert_array_equal(values, expected[name], err_msg=name)


def test_run_continues_where_the_rig_is(rig, control):
    commands = pressures()
    together = device(rig).follow(control, commands)
    half, slow = device(rig), device(rig)
    half.follow(control, commands[:4000])
    law = hysteresis_law(commands, control)
    run(slow, slow, law, 4000, control)
    for continued in (half, slow):
        continued.write(together["valve_main_v"][3999], together["valve_reservoir_v"][3999])
        continued.wait_for(4000)
        assert continued.read().theta_deg == together["theta_deg"][4000]


def test_diverging_rig_is_refused_with_quantity_and_time(rig, control):
    rig["step_s"] = 5e-3
    with pytest.raises(FprcError, match=r"spool of a valve .* at t = 0\.\d+ s"):
        device(rig).follow(control, pressures())


def test_feedforward_that_is_not_finite_is_refused_before_the_rig_moves(rig, control):
    angles = np.full(10, 20.0)
    p_ff = np.array([100.0] * 7 + [np.nan] * 3)
    still = device(rig)
    before = still.state
    with pytest.raises(ControlError, match="sample 7"):
        still.follow(control, p_ff, angles, 450.0)
    assert still.state == before
