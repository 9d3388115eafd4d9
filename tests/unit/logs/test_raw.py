import h5py
import numpy as np
import pytest

from fprc.errors import LogError
from fprc.logs import RAW_CHANNELS, TRACKING_CHANNELS, read_raw, read_run, write_raw

RATE = {"experiment": None, "sample_rate_hz": 200.0, "rate_tolerance": 0.01}
ATTRIBUTES = ("experiment", "source", "simulated", "sample_rate_hz", "seed", "software", "rig")


def problem(path, **limits):
    with pytest.raises(LogError) as caught:
        read_raw(path, **RATE | limits)
    return str(caught.value)


@pytest.fixture
def with_attributes(write_log):
    """Small raw log with attributes set, or deleted where the value is None."""

    def edit(**attributes):
        path = write_log()
        with h5py.File(path, "r+") as file:
            for name, value in attributes.items():
                del file.attrs[name]
                if value is not None:
                    file.attrs[name] = value
        return path

    return edit


def test_raw_log_comes_back_as_it_was_written(write_log, channels):
    log = read_raw(write_log(experiment="complex", seed=5), **RATE)
    assert tuple(log.channels) == RAW_CHANNELS
    for name in RAW_CHANNELS:
        assert log.channels[name].tobytes() == channels[name].tobytes()
    assert log.attributes["experiment"] == "complex"
    assert log.attributes["seed"] == 5
    assert log.attributes["rig"] == {"valve": {"leak": 0.0}}


@pytest.mark.parametrize(("source", "simulated"), [("sim", True), ("rig", False)])
def test_simulated_log_says_so(write_log, source, simulated):
    log = read_raw(write_log(source=source), **RATE)
    assert log.attributes["source"] == source
    assert log.attributes["simulated"] is simulated


def test_same_experiment_gives_the_same_bytes(write_log):
    assert write_log("a.h5").read_bytes() == write_log("b.h5").read_bytes()
    assert write_log("a.h5").read_bytes() != write_log("c.h5", seed=2).read_bytes()


def test_channels_of_a_raw_log_carry_their_units(write_log):
    with h5py.File(write_log()) as file:
        units = b" ".join(file[name].attrs["units"] for name in RAW_CHANNELS)
    assert units == b"s kPa kPa deg kPa kPa kPa deg V V"


def test_expected_rate_may_be_the_logs_own(write_log, channels):
    slow = {"time_s": channels["time_s"] * 4.0}
    path = write_log(changed=slow, sample_rate_hz=50.0)
    assert len(read_raw(path, **RATE | {"sample_rate_hz": None}).channels["time_s"]) == 400


@pytest.mark.parametrize("missing", ATTRIBUTES)
def test_missing_attribute_is_named(with_attributes, missing):
    path = with_attributes(**{missing: None})
    assert f"{path}: attribute {missing}: missing" in problem(path)


def test_missing_rate_is_the_only_complaint_about_a_log_without_a_rate(with_attributes):
    path = with_attributes(sample_rate_hz=None)
    assert len(problem(path, sample_rate_hz=None).splitlines()) == 1


@pytest.mark.parametrize("rate", ["200", 0.0, -200.0, float("nan"), [200.0, 200.0]])
@pytest.mark.parametrize("expected", [200.0, None])
def test_rate_that_is_no_positive_number_is_an_error_of_the_log(with_attributes, rate, expected):
    path = with_attributes(sample_rate_hz=rate)
    assert f"{path}: attribute sample_rate_hz" in problem(path, sample_rate_hz=expected)


def test_time_running_backwards_is_named_with_its_sample(write_log, changed):
    path = write_log(changed=changed("time_s", 50, 0.1))
    message = problem(path)
    assert f"{path}: channel time_s: sample 50 at 0.100000 s does not come after 0.245" in message


def test_repeated_instant_is_named_with_its_sample(write_log, changed, channels):
    path = write_log(changed=changed("time_s", 120, channels["time_s"][119]))
    assert f"{path}: channel time_s: sample 120 " in problem(path)


@pytest.mark.parametrize("factor", [0.9, 1.02, 2.0])
def test_wrong_rate_is_named_with_the_right_one(write_log, channels, factor):
    path = write_log(changed={"time_s": channels["time_s"] / factor})
    message = problem(path)
    assert f"{path}: channel time_s: the mean rate up to sample 399" in message
    assert f"{200.0 * factor:.4g} Hz, must be 200 Hz" in message


@pytest.mark.parametrize("factor", [0.995, 1.005])
def test_rate_within_the_tolerance_is_accepted(write_log, channels, factor):
    path = write_log(changed={"time_s": channels["time_s"] / factor})
    assert read_raw(path, **RATE)


def test_declared_rate_that_is_not_the_configured_one_is_an_error(write_log):
    path = write_log(sample_rate_hz=100.0)
    assert f"{path}: attribute sample_rate_hz = 100; must be 200" in problem(path)


def test_time_may_begin_anywhere(write_log, channels):
    assert read_raw(write_log(changed={"time_s": channels["time_s"] + 1.7e9}), **RATE)


@pytest.mark.parametrize(
    ("name", "value"),
    [
        ("experiment", 3),
        ("source", 1.0),
        ("simulated", "yes"),
        ("seed", "one"),
        ("seed", 1.5),
        ("rig", [1.0, 2.0]),
    ],
)
def test_attribute_of_the_wrong_kind_is_named(with_attributes, name, value):
    path = with_attributes(**{name: value})
    assert f"{path}: attribute {name}" in problem(path)


@pytest.mark.parametrize(
    ("name", "value"), [("complete", "yes"), ("incomplete_reason", 1.0), ("lost_samples", "3")]
)
def test_attribute_that_need_not_be_there_must_be_of_its_kind(write_log, name, value):
    path = write_log(**{name: value})
    assert f"{path}: attribute {name}" in problem(path)


def test_unknown_source_is_refused(with_attributes):
    path = with_attributes(source="dream", simulated=False)
    assert f"{path}: attribute source = dream" in problem(path)


@pytest.mark.parametrize(("source", "simulated"), [("sim", False), ("rig", True)])
def test_source_and_simulated_must_not_contradict_each_other(with_attributes, source, simulated):
    path = with_attributes(source=source, simulated=simulated)
    assert "contradicts" in problem(path)


def test_log_of_another_experiment_is_refused(write_log):
    path = write_log(experiment="complex")
    assert read_raw(path, **RATE | {"experiment": "complex"})
    message = problem(path, experiment="sweep")
    assert f"{path}: attribute experiment = complex; must be sweep" in message


def test_channels_beyond_the_raw_ones_are_kept(write_log):
    path = write_log(changed={"theta_d_deg": np.arange(400.0)})
    with h5py.File(path) as file:
        np.testing.assert_array_equal(file["theta_d_deg"][:], np.arange(400.0))
        assert file["theta_d_deg"].attrs["units"] == b"deg"
    assert tuple(read_raw(path, **RATE).channels) == RAW_CHANNELS


@pytest.mark.parametrize("value", [2e10, -1e300])
@pytest.mark.parametrize("name", ["time_s", "p_exp_command_kpa", "phi_deg"])
def test_impossibly_large_number_is_named_with_its_sample(write_log, changed, name, value):
    path = write_log(changed=changed(name, slice(7, 9), value))
    lines = problem(path).splitlines()
    assert lines == [
        f"{path}: channel {name}: sample 7 is {value:g}; it and 1 more exceed 1e+10, far "
        "more than any sensor reads; restore the file or record again"
    ]


@pytest.mark.parametrize("rate", [np.inf, 1e300, 1e-300])
def test_rate_that_no_log_has_is_an_error_of_the_log(write_log, rate):
    path = write_log(sample_rate_hz=rate)
    assert f"{path}: " in problem(path, sample_rate_hz=None)


# --- closed-loop runs -------------------------------------------------------------------------


def test_run_has_reference_feedforward_and_feedback(write_run):
    path = write_run()
    assert tuple(read_raw(path, **RATE).channels) == (*RAW_CHANNELS, *TRACKING_CHANNELS)
    assert tuple(read_run(path, ("theta_d_deg", "p_i_kpa")).channels) == ("theta_d_deg", "p_i_kpa")


@pytest.mark.parametrize("experiment", ["track_sweep_fprc_pd_identified", "identify_0.5"])
def test_run_of_an_earlier_version_with_a_gain_is_readable(write_run, experiment):
    old = {"experiment": experiment, "controller": "fprc_pd", "gain": "identified"}
    path = write_run(**old, rig={"gains": {"kp_kpa_per_deg": 0.5, "kd_kpa_s_per_deg": 0.005}})
    assert tuple(read_raw(path, **RATE).channels) == (*RAW_CHANNELS, *TRACKING_CHANNELS)
    found = read_run(path, ("theta_d_deg", "p_i_kpa"))
    assert tuple(found.channels) == ("theta_d_deg", "p_i_kpa")
    assert old.items() <= found.attributes.items()


def without(name):
    def change(file):
        del file[name]

    return change


def spoiled(name):
    def change(file):
        file[name][11] = np.nan

    return change


def attribute(name, value=None):
    def change(file):
        del file.attrs[name]
        if value is not None:
            file.attrs[name] = value

    return change


@pytest.mark.parametrize(
    ("change", "said"),
    [
        (without("p_ff_kpa"), "channel p_ff_kpa: missing"),
        (without("valve_main_v"), "channel valve_main_v: missing"),
        (spoiled("theta_d_deg"), "channel theta_d_deg: sample 11 is nan"),
        (spoiled("p_fb_kpa"), "channel p_fb_kpa: sample 11 is nan"),
        (attribute("controller"), "attribute controller: missing"),
        (attribute("settle_s"), "attribute settle_s: missing"),
        (attribute("settle_s", "5"), "attribute settle_s = '5': must be a finite number"),
        (attribute("settle_s", 2.0), "attribute settle_s = 2; must be at most 1.995"),
        (attribute("reference", 3), "attribute reference = 3: must be text"),
        (attribute("source", "dream"), "attribute source = dream; must be sim, rig"),
        (attribute("simulated"), "attribute simulated: missing"),
    ],
)
def test_run_that_is_not_whole_is_refused_by_check_and_workflow(write_run, change, said):
    """For any channels that the workflow requests."""
    path = write_run()
    with h5py.File(path, "r+") as file:
        change(file)
    assert problem(path).startswith(f"{path}: {said}")
    with pytest.raises(LogError) as caught:
        read_run(path, ("time_s", "theta_deg"))
    assert str(caught.value) == problem(path)


def test_log_of_an_experiment_is_no_run(write_log):
    path = write_log(controller="pd", reference="sweep", settle_s=0.0)
    with pytest.raises(LogError, match="attribute experiment = sweep; must begin with"):
        read_run(path, ("time_s",))


@pytest.mark.parametrize("absent", ["p_i_kpa", "valve_main_v"])
def test_imported_run_may_lack_the_optional_channels_of_an_import(write_run, absent):
    path = write_run(source="import")
    with h5py.File(path, "r+") as file:
        del file[absent]
    assert list(read_run(path, ("theta_d_deg",)).channels) == ["theta_d_deg"]
    with pytest.raises(LogError, match=f"channel {absent}: missing"):
        read_run(path, (absent,))


def test_run_without_its_own_channels_is_not_written(write_run, write_log, tmp_path):
    with pytest.raises(LogError, match="channels theta_d_deg, p_ff_kpa, p_fb_kpa are missing"):
        write_log("run.h5", experiment="track_sweep_fprc")
    assert not (tmp_path / "run.h5").exists()


def test_log_without_all_raw_channels_is_not_written(tmp_path):
    path = tmp_path / "log.h5"
    told = {"experiment": "sweep", "source": "sim", "sample_rate_hz": 200.0, "seed": 1}
    with pytest.raises(LogError, match="channels p_o_kpa, phi_deg are missing"):
        write_raw(
            path,
            {name: [0.0] for name in RAW_CHANNELS if name not in ("p_o_kpa", "phi_deg")},
            **told,
            software="fprc test",
            rig={},
        )
    assert not path.exists()


def test_all_wrong_attributes_are_reported_at_once(with_attributes):
    lines = problem(with_attributes(seed=None, software=None, rig=1.0)).splitlines()
    assert len(lines) == 3
    for name in ("seed", "software", "rig"):
        assert sum(f"attribute {name}" in line for line in lines) == 1


def test_problems_of_channels_time_and_attributes_are_reported_together(with_attributes):
    path = with_attributes(seed=None)
    with h5py.File(path, "r+") as file:
        file["theta_deg"][3] = np.nan
        file["time_s"][7] = 0.0
        del file["p_o_kpa"]
    message = problem(path)
    for part in (
        "channel theta_deg: sample 3",
        "channel p_o_kpa: missing",
        "channel time_s: sample 7",
        "attribute seed: missing",
    ):
        assert part in message
