import json

import numpy as np
import pytest
from pydantic import ValidationError

from fprc.config import Settings
from fprc.config.rig import Rig
from fprc.control.loop import RunAbortedError
from fprc.errors import EvaluationError, FprcError, SimulationError
from fprc.experiments.hysteresis import simulate
from fprc.experiments.settings import RigSettings
from fprc.studies.calibration.space import decode, free_parameters
from fprc.studies.families import family as families
from fprc.studies.families.family import draw_rig, judge_tables, unit_of

PATHS = [
    "bending.stiffness_kpa_per_deg",
    "bending.preload_kpa",
    "reservoir.squeeze_stiffness_kpa_per_ml",
]
RANGES = {
    "bending.stiffness_kpa_per_deg": [2.5, 4.0],
    "reservoir.squeeze_stiffness_kpa_per_ml": [30.0, 60.0],  # no lag
}
FREE = free_parameters(PATHS, RANGES)
SEED = 1000
SETTINGS = Settings().model_dump(mode="json")


@pytest.fixture
def wide(monkeypatch):
    """Accept nearly every rig."""
    ranges = {"angle_deg": (1.0, 120.0), "p_o_swing_kpa": (1.0, 400.0)}
    monkeypatch.setattr(families, "ACCEPTED", ranges)


@pytest.fixture
def on_rig(family):
    return RigSettings(**family["on_rig"])


def stream(seed):
    """Return the random numbers of a rig's parameters."""
    return np.random.default_rng([seed, 20241])


def test_each_unit_of_one_rig_is_a_seed(family):
    units = [unit_of(number, family).rigs for number in (0, 1)]
    assert [[seed for _, seed in recordings] for recordings in units] == [[601], [602]]
    assert units[0][0][0].rig == SETTINGS["rig"]


@pytest.mark.usefixtures("wide")
def test_drawn_rig_has_its_own_seeds_and_is_that_of_its_number(family):
    family |= {"rigs": "drawn", "seeds_per_rig": 3}
    family["free"] = {"paths": PATHS, "ranges": RANGES}
    first, second = (unit_of(number, family).rigs for number in (0, 1))
    assert [seed for _, seed in first + second] == [601, 602, 603, 604, 605, 606]
    assert first[0][0] == first[2][0] != second[0][0]
    assert second[0][0] == draw_rig(SEED + 1, FREE, RigSettings(**family["on_rig"]))


def test_rig_near_print_gets_the_keys_that_it_lacks(family, tmp_path):
    path = tmp_path / "near_print.json"
    path.write_text(json.dumps({"rigs": [{"bending": {"friction_kpa": 7.5}}]}))
    family["rigs"] = "near_print"
    on_rig = unit_of(0, family, str(path)).rigs[0][0]
    assert on_rig.rig["bending"]["friction_kpa"] == 7.5
    assert on_rig.rig["valve"] == SETTINGS["rig"]["valve"]
    with pytest.raises(FprcError, match="1 rigs"):
        unit_of(1, family, str(path))


@pytest.mark.parametrize("failure", [None, SimulationError("simulated rig: the angle diverged")])
def test_all_parts_of_a_judgement_are_of_one_rig_and_one_seed(family, monkeypatch, failure):
    def compare(data, how):
        if failure:
            raise failure
        return {"theta": float(data["sweep"].channels["theta_deg"].sum())}, {"fprc": how.seed}

    def measure(sweep, bench, models, controllers):
        return {"theta": float(sweep.channels["theta_deg"].sum()), "seed": bench.seed, **models}

    monkeypatch.setattr(families, "compare_models", compare)
    monkeypatch.setattr(families, "measure_control", measure)
    judgement = {"models": SETTINGS["models"], "folds": 2, "split": "shuffled"}
    (judged,) = judge_tables(unit_of(4, family), tracking=SETTINGS["tracking"], judgement=judgement)
    assert judged["seed"] == 605
    if failure:
        assert judged == {"seed": 605, "failed": str(failure)}
        return
    theta = float(
        simulate(RigSettings(**family["on_rig"]), 605)["sweep"].channels["theta_deg"].sum()
    )
    assert judged["compared"] == {"theta": theta, "source": "sim"}
    assert judged["measured"] == {"theta": theta, "seed": 605, "fprc": 605, "source": "sim"}


@pytest.mark.parametrize("seed", range(3))
def test_first_plausible_draw_within_the_ranges_is_taken(on_rig, seed, monkeypatch):
    windows = {"angle_deg": (52.0, 66.0), "p_o_swing_kpa": (50.0, 85.0)}
    monkeypatch.setattr(families, "ACCEPTED", windows)
    rng = stream(seed)
    drawn = draw_rig(seed, FREE, on_rig)
    plausible = False
    while not plausible:
        rig = decode(rng.uniform(size=len(FREE)), on_rig.rig, FREE)
        moved = on_rig.changed(rig=rig, signals={"sweep": on_rig.signals["sweep"]})
        log = simulate(moved, seed)["sweep"].channels
        plausible = (
            52.0 <= log["theta_deg"].max() <= 66.0 and 50.0 <= np.ptp(log["p_o_kpa"]) <= 85.0
        )
    assert drawn == on_rig.changed(rig=moved.rig)
    assert 2.5 <= drawn.rig["bending"]["stiffness_kpa_per_deg"] <= 4.0


@pytest.mark.usefixtures("wide")
@pytest.mark.parametrize(
    "failure", [SimulationError("no"), EvaluationError("no"), RunAbortedError("no", {})]
)
def test_draw_that_cannot_be_simulated_is_thrown_away(on_rig, monkeypatch, failure):
    failures = [failure]

    def simulate_once(*arguments):
        if failures:
            raise failures.pop()
        return simulate(*arguments)

    monkeypatch.setattr(families, "simulate", simulate_once)
    drawn = draw_rig(SEED, FREE, on_rig)
    rng = stream(SEED)
    rng.uniform(size=len(FREE))
    assert drawn.rig == decode(rng.uniform(size=len(FREE)), on_rig.rig, FREE)


@pytest.mark.usefixtures("wide")
def test_draw_that_breaks_a_rule_is_thrown_away(on_rig):
    narrow = {
        "reservoir.squeeze_damping_kpa_s_per_ml": [0.3, 2.0],
        "reservoir.slip_distance_ml.0": [0.01, 0.02],
    }
    free = free_parameters(list(narrow), narrow)
    rng, broken = stream(2), 0
    while breaks_a_rule(rig := decode(rng.uniform(size=2), on_rig.rig, free)):
        broken += 1
    assert draw_rig(2, free, on_rig).rig == rig
    assert broken > 0


def breaks_a_rule(rig):
    try:
        Rig.model_validate(rig)
    except ValidationError:
        return True
    return False


def test_no_plausible_rig_is_an_error(on_rig, monkeypatch):
    monkeypatch.setattr(families, "_MOST_DRAWS", 2)
    ranges = {"angle_deg": (119.0, 120.0), "p_o_swing_kpa": (1.0, 2.0)}
    monkeypatch.setattr(families, "ACCEPTED", ranges)
    with pytest.raises(EvaluationError, match=r"calibration\.ranges"):
        draw_rig(SEED, FREE, on_rig)
