"""Settings that the rules pass to their stages."""

from fprc.config import Settings
from fprc.experiments.settings import CrossValidation, RigSettings
from fprc.plan.arguments import feedback_in_words, of_pressures, on_rig, paper_models, validation

SETTINGS = Settings().model_dump(mode="json")
SETTINGS["models"]["others"] = {"mine": {"estimator": "my.Model", "inputs": [], "settings": {}}}


def test_all_models_are_judged_as_the_configuration_says():
    how = CrossValidation(**validation(SETTINGS))
    assert how == CrossValidation(models=SETTINGS["models"], folds=5, split="shuffled", seed=1)


def test_validation_of_one_model_has_the_settings_of_that_model_alone():
    assert "fprc" not in validation(SETTINGS, "esn")["models"]
    before = validation(SETTINGS, "fuzzy_linear")
    fprc = SETTINGS["models"]["fprc"] | {"epsilon": 0.5}
    changed = SETTINGS | {"models": SETTINGS["models"] | {"fprc": fprc}}
    assert validation(changed, "fuzzy_linear") == before
    assert validation(changed, "fprc") != validation(SETTINGS, "fprc")


def test_changed_argument_takes_the_place_of_the_configured_one():
    own = paper_models(SETTINGS)
    assert validation(SETTINGS, models=own, seed=7) == validation(SETTINGS) | {
        "models": own, "seed": 7
    }  # fmt: skip
    assert own["others"] == {}
    assert SETTINGS["models"]["others"].keys() == {"mine"}


def test_rig_settings_take_the_target_of_the_evaluation():
    rig = RigSettings(**on_rig(SETTINGS))
    assert (rig.rig, rig.signals) == (SETTINGS["rig"], dict(Settings().experiments))
    assert (rig.control, rig.target) == (Settings().control, "command")


POSITIONAL = {"feedback": "positional", "pd": {"kp_kpa_per_deg": 2.5, "kd_kpa_s_per_deg": 0.07}}


def with_control(**control):
    return SETTINGS | {"control": SETTINGS["control"] | control}


def test_open_loops_are_recorded_with_nothing_of_the_feedback():
    control = of_pressures(SETTINGS)
    assert control == of_pressures(with_control(**POSITIONAL))
    assert control != of_pressures(with_control(k_in_kpa_per_deg=3.0))


def test_words_on_the_feedback_tell_law_and_gains_but_for_recorded_logs():
    recorded = with_control(**POSITIONAL) | {"source": "recorded"}
    assert feedback_in_words(recorded) == feedback_in_words(SETTINGS | {"source": "recorded"})
    assert "2.5 kPa/deg" in feedback_in_words(with_control(**POSITIONAL))
