from pathlib import Path

import pytest

from fprc.channels import CHANNELS
from fprc.logs import Header
from fprc.paper import CONTROLLERS, EXPERIMENTS, REFERENCES, run_log
from fprc.plan.availability import unavailable
from fprc.plan.results import BY_NAME

RUNS = [
    run_log(reference, name) for reference in (*REFERENCES, "disturbance") for name in CONTROLLERS
]
OF_RIGS = {"seeds", "claims", "check", "readme"}
CLOSED_LOOP = {"table4", *(f"fig{number}" for number in range(12, 18))}


def without(*channels, **notes):
    names = frozenset(channel.name for channel in CHANNELS)
    return Header(Path("any.h5"), names - {*channels}, {"notes": notes})


def both(holding):
    return dict.fromkeys(EXPERIMENTS, holding)


def of(held, simulated=False):
    return unavailable(held, "mylogs", RUNS, simulated=simulated)


def test_without_p_o_what_shows_fprc_or_the_reservoir_is_missing():
    found = of(both(without("p_o_kpa")))
    assert found.keys() - OF_RIGS - CLOSED_LOOP == {
        "fprc", "readout", "fig2", "fig5", "fig8", "fig9", "fig10a", "fig11"
    }  # fmt: skip
    assert found["fig5"] == "needs p_o_kpa, which sweep.h5 and complex.h5 do not have"
    assert found["fig9"] == "needs p_o_kpa, which sweep.h5 does not have"


def test_one_experiment_alone_gives_what_is_drawn_from_it():
    found = of({"sweep": without()})
    assert found["table2"] == "needs complex.h5, which is not in mylogs"
    assert not {"fig1", "fig2", "fig9"} & found.keys()
    assert "fprc" not in found  # a table that is not there lacks no model
    assert "fig10a" not in found


def test_drawing_of_the_actuator_needs_angle_and_pressure_as_such():
    odd = without(theta_deg="not in deg: displacement x [mm]", p_exp_kpa="of the regulator")
    found = of(both(odd))
    assert found["fig1"] == "needs theta_deg in deg; in sweep.h5 it is displacement x [mm]"
    assert "fig4" not in found


@pytest.mark.parametrize("number", range(12, 18))
def test_closed_loop_figure_is_made_of_its_own_runs(number):
    name = f"fig{number}"
    own = dict.fromkeys(BY_NAME[name].logs, without())
    assert set(own) <= set(RUNS)
    assert name not in of(own)
    for run in own:
        rest = {key: value for key, value in own.items() if key != run}
        assert f"{run}.h5, which is not in mylogs" in of(rest)[name]
