import copy
import importlib.util
import os
from pathlib import Path

import numpy as np
import pytest
from hypothesis import settings
from pydantic import validate_call

from fprc.artifacts import write_csv
from fprc.config import Settings
from fprc.experiments.data import acquire, preprocess
from fprc.figures import style
from fprc.logs import write_raw
from fprc.models import FPRC, save_model
from fprc.plan import of_pressures
from fprc.stages.record import record

# `make quick` asks for fewer examples, .ci/weekly for more
EXAMPLES = int(os.environ.get("FPRC_EXAMPLES", "15"))
settings.register_profile("unit", max_examples=EXAMPLES, deadline=None, derandomize=True)
settings.load_profile("unit")


@pytest.fixture(scope="session")
def damaged_bytes():
    """Return the function that gives, for the size of a file, the bytes to damage.

    These are all with 200 examples or more (`.ci/weekly`), and one of 23 with fewer.
    """
    return lambda size: range(0, size, 1 if EXAMPLES >= 200 else 23)


@pytest.fixture(scope="session", autouse=True)
def _no_wait_for_the_disk():
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(os, "fsync", lambda file: None)  # no unit test cuts the power
        yield


@pytest.fixture
def rig():
    """Parameters of the default rig, free to change."""
    return copy.deepcopy(Settings().rig.model_dump())


@pytest.fixture
def quiet_rig(rig):
    """Rig without drift, noise and calibration errors."""
    rig["drift"]["sigma_kpa"] = 0.0
    rig["pressure_sensor"] |= {"noise_kpa": 0.0, "linearity": 0.0}
    rig["bend_sensor"] |= {"noise_deg": 0.0, "slow_error_deg": 0.0}
    return rig


@pytest.fixture
def control():
    return Settings().control


@pytest.fixture(scope="session")
def signals():
    """Both experiments, cut to 20 s."""
    return {name: signal.changed(duration_s=20.0) for name, signal in Settings().experiments}


@pytest.fixture(scope="session")
def recorded(signals):
    """Channels of both experiments on the default rig. Read only."""
    settings = Settings()
    channels = {
        name: acquire(name, signal, settings.control, settings.rig.model_dump(), seed=1)
        for name, signal in signals.items()
    }
    for values in (array for log in channels.values() for array in log.values()):
        values.setflags(write=False)
    return channels


@pytest.fixture(scope="session")
def make_data():
    """Record and preprocess an experiment as the main run does; return raw log and data."""

    def make(folder, name, settings, seed):
        raw, data, quality = (str(folder / f"{name}{end}") for end in (".h5", ".data.h5", ".json"))
        signals = {name: settings["experiments"][name]}
        rig = {"control": of_pressures(settings), "rig": settings["rig"]}
        validate_call(record)([raw], signals=signals, seed=seed, **rig)
        validate_call(preprocess)(
            [data], [quality], **{name: [raw]}, target="command", sample_rate_hz=200.0,
            limits=settings["quality"],
        )  # fmt: skip
        return raw, data

    return make


@pytest.fixture(scope="session")
def fprc_file(recorded, tmp_path_factory):
    """File of a small FPRC that is fitted to the sweep."""
    log, path = recorded["sweep"], str(tmp_path_factory.mktemp("model") / "fprc.h5")
    X = np.column_stack([log["theta_deg"], log["p_o_kpa"]])
    save_model(FPRC(n_c=2, random_state=1).fit(X, log["p_exp_command_kpa"]), path)
    return path


@pytest.fixture(scope="session")
def seen(recorded):
    """Both experiments as the models see them, P_exp as it was measured. Read only."""
    names = ("time_s", "theta_deg", "p_o_kpa")
    return {
        name: {channel: log[channel] for channel in names} | {"p_target_kpa": log["p_exp_kpa"]}
        for name, log in recorded.items()
    }


@pytest.fixture
def figures(monkeypatch):
    """Figures in the order in which they would be saved, each with its data; closed at the end."""
    saved = []

    def save(fig, data, *files, table=None):
        fig.data = data
        saved.append(fig)
        if table is not None:
            write_csv(files[-1], table)

    monkeypatch.setattr(style, "save", save)
    yield saved
    style.plt.close("all")


@pytest.fixture
def undrawn(monkeypatch):
    """Save empty pictures: to draw them takes longer than all else."""

    def touch(fig, data, *files, table=None):
        for file in files:
            Path(file).touch()
        if table is not None:
            write_csv(files[-1], table)
        style.plt.close(fig)

    monkeypatch.setattr(style, "save", touch)


@pytest.fixture
def axes():
    """Axes of a figure that can be drawn, which is closed with the test."""
    fig, ax = style.figure(1, 1, style.COLUMN_IN, 2.5)
    yield ax
    fig.draw_without_rendering()  # raises where a label cannot be typeset
    style.plt.close(fig)


@pytest.fixture(scope="session")
def channels(recorded):
    """Every channel of a raw log of 2 s. Read only."""
    return {name: values[:400] for name, values in recorded["sweep"].items()}


@pytest.fixture(scope="session")
def matlab_files():
    """Return the module that writes files as MATLAB does."""
    path = Path(__file__).with_name("matlab_files.py")
    spec = importlib.util.spec_from_file_location("matlab_files", path)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


@pytest.fixture
def write_log(channels, tmp_path):
    """Write a small raw log, with channels and attributes replaced, and return its path."""

    def write(name="log.h5", changed=None, **attributes):
        path = tmp_path / name
        described = {
            "experiment": "sweep",
            "source": "sim",
            "sample_rate_hz": 200.0,
            "seed": 1,
            "software": "fprc test",
            "rig": {"valve": {"leak": 0.0}},
        }
        write_raw(path, channels | (changed or {}), **described | attributes)
        return path

    return write


@pytest.fixture
def write_run(write_log, channels):
    """Write a small log of a closed-loop run; see ``write_log``."""

    def write(name="run.h5", changed=None, **attributes):
        run_attributes = {
            "experiment": "track_sweep_pd",
            "controller": "pd",
            "reference": "sweep",
            "settle_s": 1.0,
        }
        run = {"theta_d_deg": channels["theta_deg"] + 1.0}
        run |= dict.fromkeys(("p_ff_kpa", "p_fb_kpa"), np.zeros(400))
        return write_log(name, run | (changed or {}), **run_attributes | attributes)

    return write


@pytest.fixture
def changed(channels):
    """Return a copy of one channel of ``channels`` with some samples replaced."""

    def change(name, samples, value):
        values = np.array(channels[name])
        values[samples] = value
        return {name: values}

    return change


#: Forward test RMSE of each model over FPRC's, in the families of ``make_family``.
RATIOS = {
    "fprc": 1.0, "fprc_lowpass": 1.3, "fuzzy_linear": 1.25, "esn": 1.2, "ridge_p_o": 1.15,
    "linear": 1.6, "linear_p_o": 1.5, "bank_p_o": 1.05, "bank": 1.1, "bank_fuzzy": 1.12,
    "plays": 1.18, "plays_p_o": 1.12, "plays_fuzzy": 1.1, "nvar": 1.4, "nvar_p_o": 1.3,
    "echo": 1.35, "echo_p_o": 1.2, "trees": 1.6, "mlp": 1.5,
}  # fmt: skip


@pytest.fixture(scope="session")
def make_family():
    """Return what makes a family of ``snakemake beyond`` with known ratios.

    Numbers of a unit are those of RATIOS with a factor common to its models and a factor of their
    own; ``spread`` is the standard deviation of both logarithms.
    """
    return _family


def _family(name="dry", units=12, spread=0.03, seed=1, models=None, **more):
    random = np.random.default_rng(seed)
    cells = []
    for unit in range(units):
        common = np.exp(spread * random.standard_normal())
        errors = {
            model: 12.0 * ratio * common * np.exp(spread * random.standard_normal())
            for model, ratio in RATIOS.items()
            if models is None or model in models
        }
        judged = {model: _model(model, error) for model, error in errors.items()}
        judged |= {} if models else _memory(random)
        cells.append({"unit": unit, "seed": 601 + unit, "models": judged})
    return {"name": name, "fitted": ["tables", "orders", "open_loop"], "cells": cells} | more


def _memory(random):
    noise = np.exp(0.01 * random.standard_normal())
    return {
        "threshold": {"nonlinear": 0.1},
        "p_o": {"memory_s": 0.6 * noise, "nonlinear": 0.01},
        "theta": {"memory_s": 0.7, "nonlinear": 0.001},
    }


def _model(name, error):
    loops = {"open_loop": 0.15 * error, "closed_loop": 0.08 * error}
    found = {"train": 0.9 * error, "forward": error, "reversed": 2.0 * error, **loops}
    found["blocks"] = 0.95 * error
    if name == "fprc":
        low = float(np.hypot(error, 10.0)) / error
        found |= {f"{key}/-2": found[key] * low for key in ("forward", *loops)}
    return found
