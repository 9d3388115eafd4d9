import logging
import re

import pytest

from fprc.apparatus.check import check_rig
from fprc.apparatus.guardian import ARMED, SAFE
from fprc.errors import ControlError


@pytest.fixture
def look(make_bench, settings, live_by, caplog):
    """Check a rig on its bench's clock; return the troubles."""

    def look(*, armed=True, stop=lambda: "", touch=lambda bench: None):
        look.bench = bench = make_bench(settings)
        touch(bench)
        _, guardian = live_by(bench, stop=stop)
        caplog.set_level(logging.INFO, logger="fprc.rig")
        troubles = []
        try:
            check_rig(settings, armed, guardian)
        except ControlError as error:
            troubles = str(error).splitlines()
        look.messages, look.lines = guardian.messages, caplog.messages
        look.volts = {(output, volts) for _, output, volts in bench.writes()}
        return troubles

    return look


REST = {(0, 0.0), (1, 0.0)}


def test_rig_as_it_should_be_passes_and_ends_vented(look):
    assert look() == []
    phases = ["rest", "actuator filled", "PAM A filled"]
    assert [line.split(":")[0] for line in look.lines[:3]] == phases
    assert list(look.bench.shared.outputs[:2]) == [0.0, 0.0]
    assert sum(look.messages.count(message) for message in (ARMED, SAFE)) == 6
    assert look.bench.tick >= 1000


def test_unarmed_check_moves_no_valve(look):
    assert look(armed=False) == []
    assert 200 <= look.bench.tick < 260
    assert look.messages[-1] == SAFE
    assert look.volts == REST  # only those at opening and closing


def set_boards(**boards):
    return lambda settings: settings["hardware"]["boards"].update(boards)


def precharge(kpa):
    return lambda settings: settings["rig"]["reservoir"].update(precharge_kpa=kpa)


SWAPPED = ["actuator filled: .* p_i_kpa = (1[89]|20)[0-9].* outside -20 to 180.*swapped"]
#: What is wrong, and every trouble that is told.
WRONG = {
    "hoses": (set_boards(main_output=1, reservoir_output=0), SWAPPED),
    "channels": (set_boards(p_exp_input=1, p_i_input=0), SWAPPED),
    "dead valve": (set_boards(main_output=5), ["actuator .* p_exp_kpa .*main_output$"]),
    "dead valve of the PAM": (set_boards(reservoir_output=5),
                              ["PAM A .* p_i_kpa .*reservoir_output$"]),
    "sign": (lambda settings: settings["hardware"]["theta"].update(gain=-1.0),
             [".*theta_deg .* hardware.theta.gain"]),
    "empty PAM B": (precharge(50.0), ["rest: p_o_kpa is .* PAM B"]),
    "full PAM B": (precharge(150.0), ["rest: p_o_kpa is .* PAM B"]),
    "cable": (set_boards(p_i_input=9),
              ["THE CHAMBERS .*p_i_kpa = -250.0", "rest: .* sample 0: p_i_kpa = -250.0"]),
}  # fmt: skip


@pytest.mark.parametrize(("change", "troubles"), WRONG.values(), ids=WRONG)
def test_every_trouble_is_named_and_the_rig_vented(look, settings, change, troubles):
    change(settings)
    found = look()
    assert len(found) == len(troubles)
    assert all(map(re.match, troubles, found)), found
    assert list(look.bench.shared.outputs[:2]) == [0.0, 0.0]


def test_chamber_that_does_not_vent_is_the_last_that_is_filled(look):
    asked = []

    def close_the_valve():
        asked.append(1)
        if len(asked) == 500:  # the actuator is full
            write = look.bench.rig.write
            look.bench.rig.write = lambda main_v, reservoir_v: write(5.0, reservoir_v)
        return ""

    (trouble,) = look(stop=close_the_valve)
    assert trouble.startswith("THE CHAMBERS MAY BE UNDER PRESSURE")
    assert {volts for output, volts in look.volts if output == 1} == {0.0, 5.0}


@pytest.mark.parametrize("ticks", [150, 580, 980])
def test_check_that_is_stopped_names_the_stop_alone_and_vents(look, ticks):
    reasons = iter([""] * ticks + ["stopped by Ctrl-C"] * 2)
    (trouble,) = look(stop=lambda: next(reasons))
    assert "stopped by Ctrl-C" in trouble
    assert list(look.bench.shared.outputs[:2]) == [0.0, 0.0]
    assert ticks > 200 or look.volts == REST
