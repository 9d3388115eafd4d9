import logging
import re

import pytest

from fprc.apparatus.check import check_rig
from fprc.apparatus.guardian import ARMED, SAFE


@pytest.fixture
def look(make_bench, settings, live_by, asking, caplog):
    """Check a rig on its bench's clock; return exit code and troubles."""

    def look(*, armed=True, stop=lambda: "", touch=lambda bench: None):
        look.bench = bench = make_bench(settings)
        touch(bench)

        _, look.messages = live_by(bench)
        caplog.set_level(logging.INFO, logger="fprc.rig")
        code = check_rig(settings, armed, asking(stop))
        look.lines = caplog.messages
        return code, [m.removeprefix("TROUBLE: ") for m in caplog.messages if "TROUBLE" in m]

    return look


def test_rig_as_it_should_be_passes_and_ends_vented(look):
    assert look() == (0, [])
    assert look.lines[-1] == "no trouble found"
    phases = ["rest", "actuator filled", "PAM A filled"]
    assert [line[:16].strip() for line in look.lines[1:4]] == phases
    assert list(look.bench.shared.outputs[:2]) == [0.0, 0.0]
    assert sum(look.messages.count(message) for message in (ARMED, SAFE)) == 6
    assert look.bench.tick >= 1000


def test_unarmed_check_moves_no_valve_and_says_so(look):
    assert look(armed=False) == (0, [])
    assert any(line.startswith("valves: kept vented; --armed") for line in look.lines)
    assert 200 <= look.bench.tick < 260
    assert look.messages[-1] == SAFE
    # only those at opening and closing
    assert {volts for *_, volts in look.bench.writes()} == {0.0}


@pytest.mark.parametrize(
    "wiring", [{"main_output": 1, "reservoir_output": 0}, {"p_exp_input": 1, "p_i_input": 0}]
)
def test_swapped_hoses_or_channels_are_named_before_the_wrong_chamber_is_full(
    look, settings, wiring
):
    settings["hardware"]["boards"] |= wiring
    code, (stopped, swapped) = look()
    assert code == 1
    assert re.match(r"stopped: .* p_i_kpa = (1[89]|20)\d\.\d is outside -20 to 180", stopped)
    assert re.match(r"actuator: .* p_exp_kpa = .* p_i_kpa .*main_output .*swapped", swapped)
    assert list(look.bench.shared.outputs[:2]) == [0.0, 0.0]


CHAMBERS = pytest.mark.parametrize(
    ("output", "chamber", "own"),
    [("main_output", "actuator", "p_exp"), ("reservoir_output", "PAM A", "p_i")],
)


@CHAMBERS
def test_dead_valve_is_named(look, settings, output, chamber, own):
    settings["hardware"]["boards"][output] = 5
    code, (trouble,) = look()
    assert code == 1
    assert re.match(rf"{chamber}: .* {own}_kpa = .* hardware.boards.{output}$", trouble)


@CHAMBERS
def test_valve_that_stays_where_it_was_is_named(look, settings, output, chamber, own):
    def stay(bench):
        bench.shared.outputs[:2] = [5.0, 5.0]  # a closed valve leaks

    settings["hardware"]["boards"][output] = 5
    code, troubles = look(touch=stay)
    assert code == 1
    assert troubles[0].startswith("THE CHAMBERS MAY BE UNDER PRESSURE")
    # nor was the other chamber filled
    assert {volts for *_, volts in look.bench.writes()} == {0.0}
    assert any(re.match(f"{own}_kpa = .* at rest.*hardware.{own}", line) for line in troubles)


def test_chamber_that_does_not_vent_is_the_last_that_is_filled(look):
    asked = []

    def close_the_valve():
        asked.append(1)
        if len(asked) == 500:  # the actuator is full
            write = look.bench.rig.write
            look.bench.rig.write = lambda main_v, reservoir_v: write(5.0, reservoir_v)
        return ""

    code, (trouble,) = look(stop=close_the_valve)
    assert code == 1
    assert trouble.startswith("THE CHAMBERS MAY BE UNDER PRESSURE")
    assert {volts for _, output, volts in look.bench.writes() if output == 1} == {0.0, 5.0}


def test_wrong_sign_of_the_angle_is_named(look, settings):
    settings["hardware"]["theta"]["gain"] = -1.0
    code, (trouble,) = look()
    assert code == 1
    assert re.search("theta_deg .* hardware.theta.gain", trouble)


@pytest.mark.parametrize(("precharge_kpa", "armed"), [(50.0, True), (150.0, False)])
def test_pam_b_that_is_not_filled_to_100_kpa_is_named(look, settings, precharge_kpa, armed):
    settings["rig"]["reservoir"]["precharge_kpa"] = precharge_kpa
    code, (trouble,) = look(armed=armed)
    assert code == 1
    assert re.match(r"p_o_kpa = \S+ at rest", trouble)


def test_sensor_without_a_cable_stops_the_check_and_is_named(look, settings):
    settings["hardware"]["boards"]["p_i_input"] = 9
    code, (stopped, unvented) = look()
    assert code == 1
    assert re.match(r"stopped: .* sample 0: p_i_kpa = -250.0 .*hardware.limits.p_i_kpa", stopped)
    assert "p_i_kpa = -250.0" in unvented
    assert list(look.bench.shared.outputs[:2]) == [0.0, 0.0]


def test_check_that_is_stopped_at_rest_fills_nothing(look):
    reasons = iter([""] * 150 + ["stopped by SIGTERM"] * 2)
    code, (trouble,) = look(stop=lambda: next(reasons))
    assert (code, "at sample 150: stopped by SIGTERM" in trouble) == (1, True)
    assert {volts for *_, volts in look.bench.writes()} == {0.0}


@pytest.mark.parametrize("ticks", [20, 380, 420, 780])
def test_phase_that_was_cut_short_accuses_no_part(look, ticks):
    """Whenever the check of a rig as it should be is stopped, the only trouble is the stop."""
    reasons = iter([""] * (200 + ticks) + ["stopped by Ctrl-C"] * 2)
    code, troubles = look(stop=lambda: next(reasons))
    assert (code, [trouble.split(":")[0] for trouble in troubles]) == (1, ["stopped"])
    assert look.lines[1].startswith("rest")
    assert list(look.bench.shared.outputs[:2]) == [0.0, 0.0]
