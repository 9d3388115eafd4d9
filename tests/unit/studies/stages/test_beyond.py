import json

import pytest
import yaml

from fprc.config import Settings
from fprc.errors import FprcError
from fprc.studies.stages.beyond import builds_of, join_tuned, judge_world

SETTINGS = Settings().model_dump(mode="json")


@pytest.fixture
def world(signals):
    return {
        "name": "dry",
        "rigs": "one",
        "every_model": True,
        "fitted": ["tables"],
        "first_seed": 601,
        "seeds_per_rig": 1,
        "on_rig": {
            **{name: SETTINGS[name] for name in ("rig", "control")},
            "signals": signals,
            "target": "command",
        },
    }


def test_each_unit_of_one_rig_is_a_seed(world):
    builds = [builds_of(unit, "", world) for unit in (0, 1)]
    assert [[seed for _, seed in each] for each in builds] == [[601], [602]]
    assert builds[0][0][0].rig == SETTINGS["rig"]


@pytest.mark.slow
def test_drawn_rig_has_seeds_of_its_own(world):
    world |= {"rigs": "drawn", "seeds_per_rig": 3}
    world["ensemble"] = SETTINGS["ensemble"]
    world["free"] = {"paths": ["bending.friction_kpa", "drift.sigma_kpa"], "ranges": {}}
    world["ensemble"] |= {"angle_deg": [1.0, 120.0], "p_o_swing_kpa": [1.0, 400.0]}
    first, second = (builds_of(unit, "", world) for unit in (0, 1))
    assert [seed for _, seed in first + second] == [601, 602, 603, 604, 605, 606]
    assert first[0][0] == first[2][0] != second[0][0]


def test_rig_of_the_posterior_gets_the_keys_that_it_lacks(world, tmp_path):
    rig = {"bending": {"friction_kpa": 7.5}}
    path = tmp_path / "posterior.json"
    path.write_text(json.dumps({"rigs": [rig]}))
    world["rigs"] = "posterior"
    on_rig = builds_of(0, str(path), world)[0][0]
    assert on_rig.rig["bending"]["friction_kpa"] == 7.5
    assert on_rig.rig["valve"] == SETTINGS["rig"]["valve"]
    with pytest.raises(FprcError, match="1 rigs"):
        builds_of(1, str(path), world)


def test_chosen_settings_are_joined_by_world(tmp_path):
    names = ("dry", "viscous")
    for name in names:
        chosen = {"bank_tuned": {"epsilons": [0.1, 0.01], "alpha": 1e-06}}
        text = json.dumps({"world": name, "chosen": chosen})
        (tmp_path / f"{name}.json").write_text(text)
    joined = tmp_path / "tuned.yaml"
    join_tuned([str(tmp_path / f"{name}.json") for name in names], str(joined))
    assert yaml.safe_load(joined.read_text()) == dict.fromkeys(names, chosen)


def test_world_without_tuned_settings_is_refused(world, tmp_path):
    tuned = tmp_path / "tuned.yaml"
    tuned.write_text("viscous: {}\n")
    with pytest.raises(FprcError, match="no settings for the world dry"):
        judge_world(
            "", str(tuned), "", world=world, units=1, slow=0, contest={}, workers=1,
            checkpoint=str(tmp_path / "partial.jsonl"), version="1",
        )  # fmt: skip
    assert [path.name for path in tmp_path.iterdir()] == ["tuned.yaml"]
