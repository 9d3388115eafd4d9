from contextlib import nullcontext

import numpy as np
import pytest

from fprc.apparatus import command
from fprc.apparatus.command import plan, run
from fprc.channels import Readings
from fprc.config import Settings
from fprc.errors import ConfigError, ControlError, FprcError
from fprc.experiments.data import Data, trained_on
from fprc.models import FPRC, FuzzyLinear, load_model, save_model

NOW = Readings(0.0, 1.0, 20.0, 2.0, 100.0, 0.0)


@pytest.fixture
def settings():
    return Settings().model_dump(mode="json")


def test_every_name_can_be_planned_and_only_the_disturbance_asks_to_push(settings, fprc_file):
    for name in run("list").split():
        experiment = plan(name, settings, fprc_file)
        described = experiment.attributes
        assert (described["experiment"], described["source"]) == (name, "rig")
        assert described["rig"]["hardware"] == settings["hardware"]
        row = experiment.law(0, NOW)
        assert len(row) - 2 == len(experiment.extra)
        assert np.isfinite(row).all()
        experiment.law(experiment.samples - 1, NOW)
        with pytest.raises(IndexError):
            experiment.law(experiment.samples, NOW)
        assert bool(experiment.hint) is name.startswith("track_disturbance_")


@pytest.mark.parametrize("name", ["sweep2", "track_sine_0p2_esn"])
def test_experiment_that_is_none_is_refused(settings, fprc_file, name):
    with pytest.raises(ConfigError, match="must be one of sweep, complex, track_"):
        plan(name, settings, fprc_file)


@pytest.mark.parametrize("sensor", ["p_exp_kpa", "p_i_kpa"])
@pytest.mark.parametrize("name", ["sweep", "track_sine_0p2_pd"])
def test_command_beyond_the_limit_of_its_reading_is_refused_before_the_rig_moves(
    settings, name, sensor
):
    settings["hardware"]["limits"][sensor] = (-20.0, 349.0)
    with pytest.raises(ConfigError, match=rf"above 349 .*{sensor}"):
        plan(name, settings)


@pytest.fixture(scope="module")
def files(fprc_file, recorded, tmp_path_factory):
    """Files of models, and of what is none."""
    log, folder = recorded["sweep"], tmp_path_factory.mktemp("models")
    inputs = np.column_stack([log["theta_deg"], log["p_o_kpa"], log["p_i_kpa"]])
    fitted = {
        "Fuzzy-linear": (FuzzyLinear(n_c=2, random_state=1), 1),
        "FPRC of three inputs": (FPRC(n_c=2, random_state=1), 3),
    }
    for name, (model, count) in fitted.items():
        model.fit(inputs[:, :count], log["p_exp_command_kpa"])
        save_model(model, folder / f"{name}.h5")
    return {"": "", "FPRC": fprc_file} | {name: str(folder / f"{name}.h5") for name in fitted}


@pytest.mark.parametrize("armed", [True, False])
@pytest.mark.parametrize(
    ("file", "message"),
    [("", "give --model"), ("Fuzzy-linear", "FuzzyLinear of 1 .* FPRC of 2"),
     ("FPRC of three inputs", "FPRC of 3 .* FPRC of 2")],
)  # fmt: skip
def test_model_that_is_not_the_one_in_the_name_of_the_log_is_refused_before_anything_starts(
    settings, files, tmp_path, monkeypatch, file, message, armed
):
    monkeypatch.setattr(command, "guard", None)
    given = {"name": "track_sine_0p2_fprc_pd", "settings": settings, "model": files[file]}
    with pytest.raises((ConfigError, ControlError), match=message) as caught:
        command.record(str(tmp_path / "raw" / "log.h5"), armed=armed, **given)
    assert files[file] in str(caught.value)
    assert not list(tmp_path.iterdir())


def test_outside_model_is_compared_with_its_own_class(settings, files):
    settings["models"]["others"]["mine"] = {
        "estimator": "fprc.models.FuzzyLinear",
        "inputs": ["theta_deg"],
        "settings": {},
    }
    planned = plan("track_sine_0p2_mine", settings, files["Fuzzy-linear"])
    assert planned.attributes["model"] == "FuzzyLinear"
    with pytest.raises(ConfigError, match="is a FPRC of 2 inputs, must be a FuzzyLinear of 1"):
        plan("track_sine_0p2_mine", settings, files["FPRC"])


@pytest.mark.parametrize(
    ("period_s", "attributes", "why"),
    [(0.005, {}, ""), (0.00500001, {}, ""), (0.01, {}, "100 Hz"),
     (0.005, {"p_target_unit": "bar"}, "bar from deg, kPa"),
     (0.005, {"theta_unit": "rad"}, "kPa from rad, kPa"),
     (0.005, {"p_o_unit": "% of its scale"}, "kPa from deg, % of its scale")],
)  # fmt: skip
def test_model_of_other_rate_or_units_is_refused_before_the_rig_moves(
    settings, fprc_file, recorded, tmp_path, period_s, attributes, why
):
    log = recorded["sweep"]
    channels = {name: log[name] for name in ("theta_deg", "p_o_kpa")}
    channels |= {"time_s": period_s * np.arange(len(log["theta_deg"]))}
    channels |= {"p_target_kpa": log["p_exp_command_kpa"]}
    path = str(tmp_path / "model.h5")
    save_model(trained_on(load_model(fprc_file), Data(channels, attributes), "fprc"), path)
    with pytest.raises(FprcError, match=why) if why else nullcontext():
        plan("track_sine_0p2_fprc", settings, path)
