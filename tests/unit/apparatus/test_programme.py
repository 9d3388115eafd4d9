import numpy as np
import pytest

from fprc.apparatus.programme import names, plan
from fprc.artifacts import write_json
from fprc.config import Settings
from fprc.devices import Readings
from fprc.errors import ConfigError, ControlError, FprcError
from fprc.logs import RAW_CHANNELS, TRACKING_CHANNELS
from fprc.models import FPRC, FuzzyLinear, RidgeReadout, TapFeatures, save_model
from fprc.signals import pressure_command

GAINS = {
    "printed": {"kp_kpa_per_deg": 0.5, "kd_kpa_s_per_deg": 0.005},
    "identified": {"kp_kpa_per_deg": 4.0, "kd_kpa_s_per_deg": 0.04},
}
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


@pytest.fixture
def gains(tmp_path):
    path = str(tmp_path / "gains.json")
    write_json(path, GAINS)
    return path


def test_experiments_are_those_of_the_paper_in_the_order_in_which_they_need_each_other(settings):
    known = names(settings)
    assert known[:3] == ["sweep", "complex", "identify_0.5"]
    assert len(known) == len(set(known))
    first_track = known.index("track_sine_0p2_fprc")
    assert all(name.startswith("identify_") for name in known[2:first_track])
    assert all(name.startswith("track_") for name in known[first_track:])
    assert len(known) - first_track == 5 * len(settings["tracking"]["references"])


def test_every_name_can_be_planned(settings, model, gains):
    for name in names(settings):
        experiment = plan(name, settings, model, gains)
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
    with pytest.raises(
        ConfigError, match="no experiment sweeep; must be one of sweep, complex, ident"
    ):
        plan("sweeep", settings)


def test_hysteresis_experiment_commands_its_signal_and_feeds_theta_to_the_reservoir(settings):
    experiment = plan("complex", settings)
    command = pressure_command(settings["experiments"]["complex"], 200.0)
    assert experiment.samples == len(command)
    assert experiment.channels == RAW_CHANNELS
    k_in = settings["control"]["k_in_kpa_per_deg"]
    assert experiment.law(700, NOW) == (command[700], k_in * 20.0)
    assert experiment.hint == ""


@pytest.mark.parametrize("name", ["track_sine_0p5_pd_printed", "track_sine_0p5_pd_identified"])
def test_feedback_needs_no_model_and_has_its_own_gains(settings, gains, name):
    experiment = plan(name, settings, "/nowhere/fprc.h5", gains)
    assert experiment.channels == (*RAW_CHANNELS, *TRACKING_CHANNELS)
    row = experiment.law(0, NOW)
    theta_d, p_ff, p_fb = row[2:]
    kp = GAINS[name.rpartition("_")[2]]["kp_kpa_per_deg"]
    assert p_ff == 0.0
    assert p_fb == pytest.approx(kp * (theta_d - 20.0))


def test_feedforward_alone_needs_no_feedback(settings, model, gains):
    row = plan("track_sine_0p5_fprc", settings, model, gains).law(0, NOW)
    assert row[4] == 0.0
    assert row[3] != 0.0


def test_identification_has_the_gain_of_its_name(settings, model):
    low, high = (
        plan(f"identify_{kp}", settings, model, "/nowhere/gains.json").law(0, NOW)
        for kp in ("0.5", "2")
    )
    assert high[4] == pytest.approx(4.0 * low[4])
    assert low[4] != 0.0


def test_model_begins_from_rest_and_has_run_once(settings, model, gains):
    first, again = (
        [plan("track_sine_0p5_fprc", settings, model, gains).law(0, NOW)[3]] for _ in range(2)
    )
    assert first == again


def test_only_the_disturbance_asks_the_person_to_push(settings, model, gains):
    said = {name: plan(name, settings, model, gains).hint for name in names(settings)}
    quiet_s = settings["tracking"]["pushes"]["quiet_s"]
    for name, hint in said.items():
        pushed = name.startswith("track_disturbance_")
        assert hint == (f"push the reservoir by hand from {quiet_s:g} s on" if pushed else "")


def test_reference_that_the_rig_cannot_follow_is_refused(settings, gains):
    settings["tracking"]["references"]["sine_0p5"]["amplitude_deg"] = 80.0
    with pytest.raises(ControlError, match="leaves the actuator's range"):
        plan("track_sine_0p5_pd_printed", settings, "", gains)


@pytest.mark.parametrize(
    ("fitted", "held"),
    [
        (FuzzyLinear(n_c=2, random_state=1), "a FuzzyLinear of 2 inputs"),
        (FPRC(n_c=2, random_state=1), "a FPRC of 3 inputs"),
        (TapFeatures(), "a TapFeatures of 2 inputs"),
        (RidgeReadout(), "a RidgeReadout of 2 inputs"),
    ],
)
def test_model_that_the_controller_does_not_have_is_refused(fitted, held, settings, tmp_path):
    X = np.random.default_rng(1).normal(100.0, 10.0, (60, 3 if "3" in held else 2))
    path = tmp_path / "other.h5"
    save_model(fitted.fit(X, X[:, 0]), path)
    wrong = rf"other\.h5: holds {held}; fprc needs a FPRC of theta_deg, p_o_kpa"
    with pytest.raises(FprcError, match=wrong):
        plan("track_sine_0p2_fprc", settings, str(path))


def test_step_that_fails_is_refused_before_the_rig_moves(settings, model, monkeypatch):
    monkeypatch.setattr(FPRC, "step", lambda self, x: x[7])
    with pytest.raises(FprcError, match=r"fprc\.h5: makes no step \(tuple index"):
        plan("track_sine_0p2_fprc", settings, model)
