import json

import pytest
import yaml

from fprc.config import Settings
from fprc.errors import FprcError
from fprc.studies.stages.beyond import join_tuned, judge_world

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
