import h5py
import numpy as np
import pytest

from fprc.channels import needed_by
from fprc.errors import LogError
from fprc.logs import read_raw, read_run, write_raw

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
                file.attrs.pop(name, None)
                if value is not None:
                    file.attrs[name] = value
        return path

    return edit


def test_raw_log_comes_back_as_it_was_written(write_log, channels):
    log = read_raw(write_log(experiment="complex", seed=5), **RATE)
    assert tuple(log.channels) == needed_by("sim")
    for name in needed_by("sim"):
        assert log.channels[name].tobytes() == channels[name].tobytes()
    assert log.attributes["experiment"] == "complex"
    assert log.attributes["seed"] == 5
    assert log.attributes["rig"] == {"valve": {"leak": 0.0}}


def test_same_experiment_gives_the_same_bytes(write_log):
    assert write_log("a.h5").read_bytes() == write_log("b.h5").read_bytes()
    assert write_log("a.h5").read_bytes() != write_log("c.h5", seed=2).read_bytes()


def test_expected_rate_may_be_the_logs_own(write_log, channels):
    slow = {"time_s": channels["time_s"] * 4.0}
    path = write_log(changed=slow, sample_rate_hz=50.0)
    assert len(read_raw(path, **RATE | {"sample_rate_hz": None}).channels["time_s"]) == 400


@pytest.mark.parametrize(
    "wrong",
    [
        *({name: None} for name in ATTRIBUTES),
        *({"sample_rate_hz": rate} for rate in ("200", 0.0, -200.0, np.nan, [200.0, 200.0])),
        {"experiment": 3},
        {"source": 1.0},
        {"source": "dream"},
        {"simulated": "yes"},
        {"seed": "one"},
        {"seed": 1.5},
        {"rig": [1.0, 2.0]},
        {"complete": "yes"},
        {"incomplete_reason": 1.0},
        {"lost_samples": "3"},
        {"simulated": False},
    ],
    ids=str,
)
@pytest.mark.parametrize("expected", [200.0, None])
def test_missing_or_wrong_attribute_is_the_only_complaint(with_attributes, wrong, expected):
    path = with_attributes(**wrong)
    (line,) = problem(path, sample_rate_hz=expected).splitlines()
    assert line.startswith(f"{path}: attribute {next(iter(wrong))}")


@pytest.mark.parametrize(("sample", "time_s"), [(50, 0.1), (120, 0.595)])
def test_time_that_does_not_increase_is_named_with_its_sample(write_log, changed, sample, time_s):
    path = write_log(changed=changed("time_s", sample, time_s))
    assert f"{path}: channel time_s: sample {sample} at {time_s:.6f} s does not" in problem(path)


@pytest.mark.parametrize("factor", [0.9, 1.02, 2.0])
def test_wrong_rate_is_named_with_the_right_one(write_log, channels, factor):
    path = write_log(changed={"time_s": channels["time_s"] / factor})
    message = problem(path)
    assert f"{path}: channel time_s: the mean rate up to sample 399" in message
    assert f"{200.0 * factor:.4g} Hz, must be 200 Hz" in message


def test_declared_rate_that_is_not_the_configured_one_is_an_error(write_log):
    path = write_log(sample_rate_hz=100.0)
    assert f"{path}: attribute sample_rate_hz = 100; must be 200" in problem(path)


def test_log_at_another_rate_has_one_problem(write_log, channels):
    slower = {"time_s": 2.0 * channels["time_s"]}
    message = problem(write_log(sample_rate_hz=100.0, changed=slower))
    assert "attribute sample_rate_hz = 100; must be 200" in message
    assert "mean rate" not in message


def test_time_may_begin_anywhere_and_its_rate_differ_within_the_tolerance(write_log, channels):
    for factor in (0.995, 1.005):
        path = write_log(changed={"time_s": channels["time_s"] / factor + 1.7e9})
        assert read_raw(path, **RATE)


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
    assert tuple(read_raw(path, **RATE).channels) == needed_by("sim")


@pytest.mark.parametrize("value", [2e10, -1e300])
@pytest.mark.parametrize("name", ["time_s", "p_exp_command_kpa", "phi_deg"])
def test_impossibly_large_number_is_named_with_its_sample(write_log, changed, name, value):
    path = write_log(changed=changed(name, slice(7, 9), value))
    lines = problem(path).splitlines()
    assert lines == [
        f"{path}: channel {name}: sample 7 is {value:g}; it and 1 more exceed 1e+10, far "
        "more than any sensor reads; restore the file or record again"
    ]


# --- closed-loop runs -------------------------------------------------------------------------


def test_run_has_reference_feedforward_and_feedback(write_run):
    path = write_run()
    assert tuple(read_raw(path, **RATE).channels) == needed_by("sim", tracking=True)
    assert tuple(read_run(path, ("theta_d_deg", "p_i_kpa")).channels) == ("theta_d_deg", "p_i_kpa")


@pytest.mark.parametrize("experiment", ["track_sweep_fprc_pd_identified", "identify_0.5"])
def test_run_of_an_earlier_version_with_a_gain_is_readable(write_run, experiment):
    old = {"experiment": experiment, "controller": "fprc_pd", "gain": "identified"}
    path = write_run(**old, rig={"gains": {"kp_kpa_per_deg": 0.5, "kd_kpa_s_per_deg": 0.005}})
    assert tuple(read_raw(path, **RATE).channels) == needed_by("sim", tracking=True)
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
            {name: [0.0] for name in needed_by("sim") if name not in ("p_o_kpa", "phi_deg")},
            **told,
            software="fprc test",
            rig={},
        )
    assert not path.exists()


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
