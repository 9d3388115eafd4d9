import shlex
import shutil
from pathlib import Path

import h5py
import numpy as np
import pytest

from fprc.config import Settings
from fprc.errors import ConfigError, LogError
from fprc.stages.preprocess import preprocess
from fprc.yaml_file import read_yaml


def test_all_config_errors_at_once_before_any_job(project):
    done = project.snakemake(
        "all", "--config", "modles={}", "models={fprc: {n_c: 0, n_uu: 3}, esn: {gamma: lots}}"
    )
    assert done.returncode != 0
    wrong = ("modles:", "models.fprc.n_uu:", "models.fprc.n_c = 0:", "models.esn.gamma = lots:")
    assert [key for key in wrong if key not in done.stdout] == []
    assert not project.files("results", "data")
    assert "Traceback" not in done.stdout


@pytest.mark.slow
def test_repeated_key_of_a_json_configuration_is_refused(project):
    """Of a YAML file: tests/faults."""
    path = project.folder / "mine.json"
    path.write_text('{\n\t"seed": 2, "source": "sim",\n\n"seed": 3,"models":{"n_y":5,"n_y":6}}')
    with pytest.raises(ConfigError, match=r"(?s)(?=.*\bseed\b).*\bmodels\.n_y\b") as caught:
        read_yaml(path)
    done = project.snakemake("--dry-run", "all", "--configfile", "mine.json")
    assert done.returncode != 0
    assert str(caught.value) in done.stdout
    assert "Traceback" not in done.stdout


@pytest.mark.slow
def test_name_of_a_folder_is_no_command(project):
    folder = "it's; touch owned"
    settings = ["--config", f'folders={{results: "{folder}"}}']
    told = project.snakemake("--dry-run", "--printshellcmds", "smoke", *settings)
    assert told.returncode == 0, told.stdout
    assert f"> {shlex.quote(folder + '/logs/smoke.log')} 2>&1" in told.stdout


def truncate(path):
    path.write_bytes(path.read_bytes()[:5000])


def drop_channel(path):
    with h5py.File(path, "a") as log:
        del log["p_o_kpa"]


def spoil_sample(path):
    with h5py.File(path, "a") as log:
        log["theta_deg"][123] = np.nan


def change_unit(path):
    with h5py.File(path, "a") as log:
        log["p_i_kpa"].attrs["units"] = "bar"


def stretch_time(path):
    with h5py.File(path, "a") as log:
        log["time_s"][:] *= 2.0


def swap_samples(path):
    with h5py.File(path, "a") as log:
        log["time_s"][77] = 0.0


def turn_a_bit(path):
    with h5py.File(path) as log:
        at = log["p_exp_command_kpa"].id.get_chunk_info(0).byte_offset + 1000
    data = bytearray(path.read_bytes())
    data[at] ^= 1
    path.write_bytes(data)


def link_elsewhere(path):
    with h5py.File(path, "a") as log:
        del log["p_o_kpa"]
        log["p_o_kpa"] = h5py.ExternalLink("/etc/passwd", "p_o_kpa")


def break_notes(path):
    with h5py.File(path, "a") as log:
        log.attrs["notes"] = "{"


SPOILED = [
    (truncate, ["cut short"]),
    (drop_channel, ["channel p_o_kpa", "missing"]),
    (spoil_sample, ["channel theta_deg", "sample 123"]),
    (change_unit, ["channel p_i_kpa", "units are bar, must be kPa"]),
    (stretch_time, ["channel time_s", "100 Hz, must be 200 Hz"]),
    (swap_samples, ["channel time_s", "sample 77"]),
    (turn_a_bit, ["channel p_exp_command_kpa", "cannot be read"]),
    (link_elsewhere, ["channel p_o_kpa", "link to another file"]),
    (break_notes, ["attribute notes", "JSON object"]),
]


@pytest.mark.slow
@pytest.mark.parametrize(("spoil", "words"), SPOILED)
def test_bad_raw_log_is_refused_before_anything_is_written(smoked, tmp_path, spoil, words):
    raw = shutil.copy(smoked[0].folder / "results/smoke/raw/sweep.h5", tmp_path)
    spoil(Path(raw))
    limits = Settings().quality.model_dump()
    with pytest.raises(LogError) as refused:
        preprocess(
            str(raw), str(tmp_path / "data.h5"), str(tmp_path / "quality.json"),
            experiment="sweep", target="command", sample_rate_hz=200.0, limits=limits,
        )  # fmt: skip
    assert "sweep.h5: " in str(refused.value)
    for word in words:
        assert word in str(refused.value)
    assert [path.name for path in tmp_path.iterdir()] == ["sweep.h5"]


@pytest.mark.slow
def test_bad_raw_log_is_one_line_and_nothing_is_overwritten(smoked_copy):
    raw = smoked_copy.folder / "results/smoke/raw/sweep.h5"
    spoil_sample(raw)
    before = smoked_copy.files("results/smoke/raw", "results/smoke/tables")
    done = smoked_copy.smoke("table2")
    assert done.returncode != 0
    assert smoked_copy.smoke("table2").returncode != 0, "asked again, a stale table must not pass"
    lines = [line for line in done.stdout.splitlines() if "sweep.h5: " in line]
    assert lines, done.stdout
    assert "channel theta_deg: sample 123" in lines[0]
    assert "Traceback" not in done.stdout
    assert smoked_copy.files("results/smoke/raw", "results/smoke/tables") == before


SHORT = "experiments={sweep: {duration_s: 1}, complex: {duration_s: 1}}"


def test_taps_beyond_the_log_are_refused_before_any_job(project):
    too_many = "models={n_y: 100}"
    done = project.smoke("all", "--config", SHORT, too_many, "control={sample_rate_hz: 50}")
    assert done.returncode != 0
    assert "leaves 40 samples to train on, fewer than n_" in done.stdout
    assert not project.files("results", "data")


@pytest.mark.slow
def test_log_that_was_not_simulated_is_never_recorded_over(smoked_copy):
    raw = smoked_copy.folder / "results/smoke/raw/sweep.h5"
    with h5py.File(raw, "a") as log:
        log.attrs["source"] = "rig"
    before = raw.read_bytes()
    done = smoked_copy.smoke("all", "--config", "seed=2")
    assert done.returncode != 0
    assert "sweep.h5" in done.stdout
    assert raw.read_bytes() == before


@pytest.mark.slow
def test_diverging_simulation_is_an_error_that_leaves_no_log_and_passes_off_no_old_table(
    smoked_copy,
):
    shaky = "rig={valve: {natural_frequency_rad_per_s: 1300, damping_ratio: 1.5}}"
    raw = smoked_copy.folder / "results/smoke/raw"
    for _ in range(2):
        done = smoked_copy.smoke("table2", "--config", shaky)
        assert done.returncode != 0
        assert "[record sweep] error: " in done.stdout
        assert "Traceback" not in done.stdout
        assert not [*raw.glob("*sweep.h5"), *raw.glob("*complex.h5")]


@pytest.mark.slow
def test_logs_of_two_kinds_are_not_mixed(smoked_copy):
    raw = smoked_copy.folder / "results/smoke/raw/sweep.h5"
    with h5py.File(raw, "a") as log:
        log.attrs.update({"source": "rig", "simulated": False})
    model = "results/smoke/models/sweep_fuzzy_linear.h5"
    done = smoked_copy.smoke(model, "--config", "source=recorded")
    assert done.returncode != 0
    assert "source is rig, the test log's sim" in done.stdout
