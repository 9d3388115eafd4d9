import h5py
import numpy as np
import pytest

from fprc.channels import needed_by
from fprc.errors import LogError
from fprc.logs import read_raw, read_run, write_raw
from fprc.logs.raw import RAW_ATTRIBUTES

RATE = {"experiment": None, "sample_rate_hz": 200.0, "rate_tolerance": 0.01}


def problem(path, **limits):
    with pytest.raises(LogError) as caught:
        read_raw(path, **RATE | limits)
    return str(caught.value)


def test_raw_log_comes_back_as_it_was_written(write_log, channels):
    log = read_raw(write_log(experiment="complex", seed=5), **RATE | {"experiment": "complex"})
    assert tuple(log.channels) == needed_by("sim")
    for name in needed_by("sim"):
        assert log.channels[name].tobytes() == channels[name].tobytes()
    found = [log.attributes[name] for name in ("experiment", "seed", "rig")]
    assert found == ["complex", 5, {"valve": {"leak": 0.0}}]


def test_sensor_that_the_rig_does_not_have_is_left_out_of_the_log(write_log):
    path = write_log(changed={"phi_deg": np.full(400, np.nan)}, source="rig")
    assert set(read_raw(path, **RATE).channels) == set(needed_by("sim")) - {"phi_deg"}


def test_raw_log_without_an_attribute_that_it_needs_is_not_written(tmp_path):
    with pytest.raises(LogError, match="needs seed and rig"):
        write_raw(tmp_path / "a.h5", {}, experiment="sweep", source="sim", sample_rate_hz=200.0)
    assert not list(tmp_path.iterdir())


def set_to(name, value):
    return lambda file: file.attrs.__setitem__(name, value)


def without(name):
    return lambda file: file.attrs.pop(name)


#: What is wrong with a log, and how the only complaint begins.
WRONG = [
    *((without(name), f"attribute {name}: missing") for name in RAW_ATTRIBUTES),
    (set_to("sample_rate_hz", 0.0), "attribute sample_rate_hz: "),
    (set_to("source", "dream"), "attribute source = dream"),
    (set_to("experiment", "complex"), "attribute experiment = complex; must be sweep"),
    (lambda file: file["time_s"].__setitem__(50, 0.1), "channel time_s: sample 50 at 0.100000 s"),
    (lambda file: file["time_s"].__setitem__(120, 0.595), "channel time_s: sample 120 at 0.595"),
]


@pytest.mark.parametrize(("change", "about"), WRONG)
@pytest.mark.parametrize("expected_hz", [200.0, None])
def test_what_is_wrong_with_a_log_is_the_only_complaint(write_log, change, about, expected_hz):
    path = write_log()
    with h5py.File(path, "r+") as file:
        change(file)
    (line,) = problem(path, sample_rate_hz=expected_hz, experiment="sweep").splitlines()
    assert line.startswith(f"{path}: {about}")


#: Steps of the clock, first time stamp, declared and expected rate, and what is wrong.
RATES = [
    *((1.0 / factor, 0.0, 200.0, 200.0, "channel time_s") for factor in (0.9, 1.02, 2.0)),
    *((1.0 / factor, 1.7e9, 200.0, 200.0, "") for factor in (0.995, 1.005)),
    (4.0, 0.0, 50.0, None, ""),  # that of the log
    (4.0, 0.0, 200.0, None, "channel time_s"),
    (1.0, 0.0, 100.0, 200.0, "attribute sample_rate_hz = 100"),
    (2.0, 0.0, 100.0, 200.0, "attribute sample_rate_hz = 100"),  # as declared
]


@pytest.mark.parametrize(("step", "begin_s", "declared_hz", "expected_hz", "about"), RATES)
def test_rate_of_the_samples_and_the_declared_one_are_that_of_the_experiment(
    write_log, channels, step, begin_s, declared_hz, expected_hz, about
):
    time_s = {"time_s": channels["time_s"] * step + begin_s}
    path = write_log(changed=time_s, sample_rate_hz=declared_hz)
    if about:
        (line,) = problem(path, sample_rate_hz=expected_hz).splitlines()
        assert line.startswith(f"{path}: {about}")
    else:
        log = read_raw(path, **RATE | {"sample_rate_hz": expected_hz})
        assert log.channels["time_s"].tolist() == time_s["time_s"].tolist()


@pytest.mark.parametrize(
    ("change", "about"),
    [
        (lambda file: file.pop("p_ff_kpa"), "channel p_ff_kpa"),
        (lambda file: file.pop("valve_main_v"), "channel valve_main_v"),
        (lambda file: file["p_fb_kpa"].__setitem__(11, np.nan), "channel p_fb_kpa: sample 11"),
        (without("controller"), "attribute controller"),
        (without("settle_s"), "attribute settle_s"),
        (set_to("settle_s", 2.0), "attribute settle_s = 2"),
        (set_to("source", "dream"), "attribute source = dream"),
    ],
)
def test_run_that_is_not_whole_is_refused_by_check_and_workflow(write_run, change, about):
    path = write_run()
    assert tuple(read_raw(path, **RATE).channels) == needed_by("sim", tracking=True)
    with h5py.File(path, "r+") as file:
        change(file)
    assert problem(path).startswith(f"{path}: {about}")
    with pytest.raises(LogError) as caught:
        read_run(path)
    assert str(caught.value) == problem(path)


def test_log_of_an_experiment_is_no_run(write_log):
    path = write_log(controller="pd", reference="sweep", settle_s=0.0)
    with pytest.raises(LogError, match="attribute experiment = sweep; must begin with"):
        read_run(path)


@pytest.mark.parametrize("absent", ["p_i_kpa", "valve_main_v"])
def test_imported_run_may_lack_the_optional_channels_of_an_import(write_run, absent):
    path = write_run(source="import")
    with h5py.File(path, "r+") as file:
        del file[absent]
    assert set(read_run(path).channels) == {*needed_by("sim", tracking=True)} - {absent}


def test_problems_of_channels_and_attributes_are_reported_together(write_log):
    path = write_log()
    with h5py.File(path, "r+") as file:
        del file.attrs["seed"]
        file.attrs["complete"] = "no"
        file["theta_deg"].attrs["units"] = "rad"
        del file["p_o_kpa"]
    message = problem(path)
    for part in ("theta_deg: units", "p_o_kpa", "seed", "complete"):
        assert part in message
