"""Settings that the rules pass to their stages."""

from fprc.config import Settings
from fprc.experiments.comparison import CrossValidation
from fprc.experiments.data import RigSettings
from fprc.plan import feedback_in_words, of_pressures, on_rig, paper_models, validation

SETTINGS = Settings().model_dump(mode="json")
SETTINGS["models"]["others"] = {"mine": {"estimator": "my.Model", "inputs": [], "settings": {}}}
POSITIONAL = {"feedback": "positional", "pd": {"kp_kpa_per_deg": 2.5, "kd_kpa_s_per_deg": 0.07}}


def with_control(**control):
    return SETTINGS | {"control": SETTINGS["control"] | control}


def test_stages_get_the_arguments_that_they_take():
    how = CrossValidation(**validation(SETTINGS, models=paper_models(SETTINGS), seed=7))
    assert (how.folds, how.split, how.seed) == (5, "shuffled", 7)
    assert how.models == SETTINGS["models"] | {"others": {}}
    assert SETTINGS["models"]["others"].keys() == {"mine"}
    assert RigSettings(**on_rig(SETTINGS)).target == "command"


def test_model_is_judged_anew_only_if_its_own_settings_change():
    fprc = SETTINGS["models"]["fprc"] | {"epsilon": 0.5}
    changed = SETTINGS | {"models": SETTINGS["models"] | {"fprc": fprc}}
    for model, same in (("esn", True), ("fuzzy_linear", True), ("fprc", False)):
        assert (validation(changed, model) == validation(SETTINGS, model)) == same


def test_open_loops_are_recorded_with_nothing_of_the_feedback():
    control = of_pressures(SETTINGS)
    assert control == of_pressures(with_control(**POSITIONAL))
    assert control != of_pressures(with_control(k_in_kpa_per_deg=3.0))


def test_words_on_the_feedback_tell_its_gains_but_for_recorded_logs():
    recorded = with_control(**POSITIONAL) | {"source": "recorded"}
    assert feedback_in_words(recorded) == feedback_in_words(SETTINGS | {"source": "recorded"})
    assert "2.5 kPa/deg" in feedback_in_words(with_control(**POSITIONAL))
