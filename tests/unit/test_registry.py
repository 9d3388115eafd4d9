"""The models, and the names of their controllers and runs."""

import sys

import pytest

from fprc.apparatus.programme import names, plan
from fprc.artifacts import write_json
from fprc.config import check
from fprc.errors import ConfigError
from fprc.models import RidgeReadout, SequenceModel, TapFeatures, save_model
from fprc.paper import (
    CONTROLLERS,
    DISTURBANCE,
    REFERENCES,
    controller_and_gain,
    reference_and_controller,
    run_log,
)
from fprc.registry import MODELS, build, controllers, feedforward_of, model_of_run, settings_of


class Outside(SequenceModel):
    def __init__(self, n_y=5, random_state=None):
        self.n_y = n_y
        self.random_state = random_state

    def make_features(self):
        return TapFeatures(n_y=self.n_y, n_references=None)

    def make_readout(self):
        return RidgeReadout()


OTHERS = {"taps_a": {"estimator": f"{__name__}.Outside", "settings": {"n_y": 3}}}


@pytest.fixture
def settings(monkeypatch):
    monkeypatch.setitem(sys.modules, __name__, sys.modules[Outside.__module__])
    return check({"models": {"others": OTHERS}}).model_dump(mode="json")


@pytest.mark.parametrize("reference", [*REFERENCES, DISTURBANCE])
@pytest.mark.parametrize("controller", [*CONTROLLERS, "taps_a", "taps_a_pd_printed"])
def test_name_of_a_run_says_its_reference_controller_and_model(reference, controller):
    log = run_log(reference, controller)
    assert reference_and_controller(log) == (reference, controller)
    kind, gain = controller_and_gain(controller)
    assert controller == (kind if gain == "none" else f"{kind}_{gain}")
    assert model_of_run(log) == (feedforward_of(kind) or "fprc")


def test_what_is_no_run_is_refused():
    with pytest.raises(ValueError, match="identify_4"):
        reference_and_controller("identify_4")
    assert model_of_run("identify_4") == "fprc"


def test_model_from_outside_is_built_with_its_settings_and_the_seed(settings):
    model = build("taps_a", settings["models"], 7)
    assert model.get_params() == {"n_y": 3, "random_state": 7}
    assert settings_of("taps_a", settings["models"]) == {"others": settings["models"]["others"]}


@pytest.mark.parametrize("name", MODELS)
def test_settings_of_a_model_are_all_that_it_is_built_of(name, settings):
    whole, part = settings["models"], settings_of(name, settings["models"])
    assert build(name, part, 1).get_params() == build(name, whole, 1).get_params()


def test_experiments_of_the_real_rig_include_runs_with_a_model_from_outside(settings, tmp_path):
    assert controllers(settings["models"])[-3:] == [
        "taps_a", "taps_a_pd_printed", "taps_a_pd_identified"
    ]  # fmt: skip
    assert "track_sine_0p2_taps_a" in names(settings)
    model = build("taps_a", settings["models"], 1)
    X = [[20.0 + k] for k in range(40)]
    save_model(model.fit(X, [x[0] for x in X]), tmp_path / "model.h5", [Outside])
    write_json(tmp_path / "gains.json", {})
    files = str(tmp_path / "model.h5"), str(tmp_path / "gains.json")
    experiment = plan("track_sine_0p2_taps_a", settings, *files)
    assert experiment.attributes["controller"] == "taps_a"


def test_setting_that_the_class_does_not_take_is_refused_by_its_key(settings):
    settings["models"]["others"]["taps_a"]["settings"] = {"n_yy": 3}
    with pytest.raises(ConfigError, match=r"models\.others\.taps_a\.settings.*n_yy"):
        build("taps_a", settings["models"], 1)
