"""Settings that the rules pass to their stages."""

import pytest

from fprc.config import Settings
from fprc.experiments.settings import Judgement, RigSettings
from fprc.plan.arguments import judgement, on_drawn_rigs, on_rig, paper_models, pick, tracking

SETTINGS = Settings().model_dump(mode="json")
SETTINGS["models"]["others"] = {"mine": {"estimator": "my.Model", "inputs": [], "settings": {}}}


def test_picked_keys_have_their_values():
    assert pick(SETTINGS, "seed", "source") == {"seed": 1, "source": "sim"}


def test_all_models_are_judged_as_the_configuration_says():
    how = Judgement(**judgement(SETTINGS))
    assert how == Judgement(SETTINGS["models"], folds=5, split="shuffled", seed=1)


def test_judgement_of_one_model_has_the_settings_of_that_model_alone():
    assert "fprc" not in judgement(SETTINGS, "esn")["models"]
    before = judgement(SETTINGS, "fuzzy_linear")
    fprc = SETTINGS["models"]["fprc"] | {"epsilon": 0.5}
    changed = SETTINGS | {"models": SETTINGS["models"] | {"fprc": fprc}}
    assert judgement(changed, "fuzzy_linear") == before
    assert judgement(changed, "fprc") != judgement(SETTINGS, "fprc")


@pytest.mark.parametrize("name", ["seed", "split"])
def test_argument_that_a_stage_adds_itself_is_left_out(name):
    whole = judgement(SETTINGS)
    value = whole.pop(name)
    assert judgement(SETTINGS, without=name) == whole
    assert judgement(SETTINGS, **{name: value}) == whole | {name: value}


def test_changed_argument_takes_the_place_of_the_configured_one():
    own = paper_models(SETTINGS)
    assert judgement(SETTINGS, models=own, seed=7) == judgement(SETTINGS) | {
        "models": own, "seed": 7
    }  # fmt: skip
    assert own["others"] == {}
    assert SETTINGS["models"]["others"].keys() == {"mine"}


def test_rig_settings_take_the_target_of_the_evaluation_or_another():
    rig = RigSettings(**on_rig(SETTINGS))
    assert (rig.rig, rig.signals) == (SETTINGS["rig"], SETTINGS["experiments"])
    assert rig.target == "command"
    assert RigSettings(**on_rig(SETTINGS, "measured")).target == "measured"


def test_tracking_of_one_reference_does_not_read_the_others():
    section = SETTINGS["tracking"]
    part = tracking(SETTINGS, "sweep", "pushes")
    assert part["references"] == {"sweep": section["references"]["sweep"]}
    assert part.keys() == {"angle_range_deg", "pressure_limit_kpa", "pushes", "references"}


def test_claims_hold_on_as_many_drawn_rigs_as_the_table_says_if_it_exists(tmp_path):
    table = tmp_path / "claims.csv"
    assert on_drawn_rigs(str(table)) == {}
    table.write_text('id,claim,holds,rigs\nC1,"a, b",7,40\nC18a,c,0,40\n', encoding="utf-8")
    assert on_drawn_rigs(str(table)) == {"C1": "7 of 40", "C18a": "0 of 40"}
