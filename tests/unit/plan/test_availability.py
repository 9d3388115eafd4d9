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


def whole(**notes):
    names = frozenset(channel.name for channel in CHANNELS)
    return Header(Path("any.h5"), names, {"notes": notes})


def of(held, simulated=False):
    return unavailable(held, "mylogs", RUNS, simulated=simulated)


def test_drawing_of_the_actuator_needs_angle_and_pressure_as_such():
    odd = whole(theta_deg="not in deg: displacement x [mm]", p_exp_kpa="of the regulator")
    found = of(dict.fromkeys(EXPERIMENTS, odd))
    assert found["fig1"] == "needs theta_deg in deg; in sweep.h5 it is displacement x [mm]"
    assert "fig4" not in found


@pytest.mark.parametrize("number", range(12, 18))
def test_closed_loop_figure_is_made_of_its_own_runs(number):
    name = f"fig{number}"
    own = dict.fromkeys(BY_NAME[name].logs, whole())
    assert set(own) <= set(RUNS)
    assert name not in of(own)
    for run in own:
        rest = {key: value for key, value in own.items() if key != run}
        assert f"{run}.h5, which is not in mylogs" in of(rest)[name]
