"""The models, and the names of their controllers and runs."""

import sys

import pytest

from fprc.config import check
from fprc.errors import ConfigError
from fprc.models import RidgeReadout, SequenceModel, TapFeatures
from fprc.paper import CONTROLLERS, DISTURBANCE, REFERENCES, reference_and_controller, run_log
from fprc.registry import build, feedforward_of, load_class, model_of_run, settings_of


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
@pytest.mark.parametrize("controller", [*CONTROLLERS, "taps_a", "taps_a_pd"])
def test_name_of_a_run_says_its_reference_controller_and_model(reference, controller):
    log = run_log(reference, controller)
    assert reference_and_controller(log) == (reference, controller)
    assert model_of_run(log) == (feedforward_of(controller) or "fprc")


def test_model_from_outside_is_built_with_its_settings_and_the_seed(settings):
    model = build("taps_a", settings["models"], 7)
    assert model.get_params() == {"n_y": 3, "random_state": 7}
    assert settings_of("taps_a", settings["models"]) == {"others": settings["models"]["others"]}


class Unfinished(SequenceModel):
    def make_features(self):
        return TapFeatures()


@pytest.mark.parametrize("name", ["esn", "trees", "pd", "x_pd"])
def test_name_of_a_model_must_not_be_read_as_a_controller_or_as_ours(name):
    with pytest.raises(ConfigError, match=rf"models: others\.{name} is the name"):
        check({"models": {"others": {name: OTHERS["taps_a"]}}})


@pytest.mark.parametrize(
    ("estimator", "why"),
    [("nowhere.Model", "No module named"), ("sklearn.nowhere.Model", "No module named"),
     (f"{__name__}.Gone", "Gone"), (f"{__name__}.Unfinished", "no model"),
     ("sklearn.linear_model.Ridge", "no model")],
)  # fmt: skip
def test_estimator_that_is_no_model_is_refused_by_its_key(settings, estimator, why):
    settings["models"]["others"]["taps_a"]["estimator"] = estimator
    with pytest.raises(ConfigError, match=rf"models\.others\.taps_a\.estimator .*{why}"):
        load_class("taps_a", settings["models"])
