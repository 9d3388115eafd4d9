import numpy as np
import pytest

from fprc.apparatus.programme import names, plan
from fprc.config import Settings
from fprc.devices import Readings
from fprc.errors import ConfigError, ControlError
from fprc.logs import RAW_CHANNELS, TRACKING_CHANNELS
from fprc.models import FPRC, save_model
from fprc.signals import pressure_command

NOW = Readings(0.0, 1.0, 20.0, 2.0, 100.0, 0.0)


@pytest.fixture
def settings():
    return Settings().model_dump(mode="json")


@pytest.fixture(scope="module")
def model(recorded, tmp_path_factory):
    log = recorded["sweep"]
    X = np.column_stack([log["theta_deg"], log["p_o_kpa"]])
    path = str(tmp_path_factory.mktemp("model") / "fprc.h5")
    save_model(FPRC(n_c=2, random_state=1).fit(X, log["p_exp_command_kpa"]), path)
    return path


def test_experiments_are_those_of_the_paper_in_the_order_in_which_they_need_each_other(settings):
    known = names(settings)
    assert known[:3] == ["sweep", "complex", "track_sine_0p2_fprc"]
    assert len(known) == len(set(known))
    assert all(name.startswith("track_") for name in known[2:])
    assert len(known) == 2 + 3 * len(settings["tracking"]["references"])


def test_every_name_can_be_planned(settings, model):
    for name in names(settings):
        experiment = plan(name, settings, model)
        assert experiment.attributes["experiment"] == name
        assert experiment.attributes["source"] == "rig"
        assert experiment.attributes["rig"]["hardware"] == settings["hardware"]
        row = experiment.law(0, NOW)
        assert len(RAW_CHANNELS) + len(row) - 2 == len(experiment.channels)
        assert np.isfinite(row).all()
        experiment.law(experiment.samples - 1, NOW)
        with pytest.raises(IndexError):
            experiment.law(experiment.samples, NOW)


def test_unknown_experiment_is_refused_with_the_known_ones(settings):
    with pytest.raises(ConfigError, match="no experiment sweeep; must be one of sweep, complex, "):
        plan("sweeep", settings)


def test_hysteresis_experiment_commands_its_signal_and_feeds_theta_to_the_reservoir(settings):
    experiment = plan("complex", settings)
    command = pressure_command(settings["experiments"]["complex"], 200.0)
    assert experiment.samples == len(command)
    assert experiment.channels == RAW_CHANNELS
    k_in = settings["control"]["k_in_kpa_per_deg"]
    assert experiment.law(700, NOW) == (command[700], k_in * 20.0)
    assert experiment.hint == ""


@pytest.mark.parametrize("feedback", ["incremental", "positional"])
def test_feedback_needs_no_model_and_is_that_of_the_configuration(settings, feedback):
    settings["control"]["feedback"] = feedback
    settings["control"]["pd"] = {"kp_kpa_per_deg": 2.0, "kd_kpa_s_per_deg": 0.0}
    experiment = plan("track_sine_0p5_pd", settings, "/nowhere/fprc.h5")
    assert experiment.channels == (*RAW_CHANNELS, *TRACKING_CHANNELS)
    now = NOW._replace(theta_deg=0.0)
    rows = [experiment.law(k, now)[2:] for k in range(2)]
    (theta_d, *_), (_, p_ff, p_fb) = rows
    assert p_ff == 0.0
    assert p_fb == pytest.approx(2.0 * theta_d * (2 if feedback == "incremental" else 1))


def test_feedforward_alone_needs_no_feedback(settings, model):
    row = plan("track_sine_0p5_fprc", settings, model).law(0, NOW)
    assert row[4] == 0.0
    assert row[3] != 0.0


def test_model_begins_from_rest_and_has_run_once(settings, model):
    first, again = ([plan("track_sine_0p5_fprc", settings, model).law(0, NOW)[3]] for _ in range(2))
    assert first == again


def test_only_the_disturbance_asks_the_person_to_push(settings, model):
    said = {name: plan(name, settings, model).hint for name in names(settings)}
    quiet_s = settings["tracking"]["pushes"]["quiet_s"]
    for name, hint in said.items():
        pushed = name.startswith("track_disturbance_")
        assert hint == (f"push the reservoir by hand from {quiet_s:g} s on" if pushed else "")


def test_reference_that_the_rig_cannot_follow_is_refused(settings):
    settings["tracking"]["references"]["sine_0p5"]["amplitude_deg"] = 80.0
    with pytest.raises(ControlError, match="leaves the actuator's range"):
        plan("track_sine_0p5_pd", settings, "")
