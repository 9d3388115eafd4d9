import copy
import importlib.util
import os
from pathlib import Path

import numpy as np
import pytest
from hypothesis import settings

from fprc.config import Settings
from fprc.experiments.hysteresis import acquire
from fprc.logs import write_raw

# `make quick` asks for fewer examples
EXAMPLES = int(os.environ.get("FPRC_EXAMPLES", "50"))
settings.register_profile("unit", max_examples=EXAMPLES, deadline=None, derandomize=True)
settings.load_profile("unit")


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
    return Settings().control.model_dump()


@pytest.fixture(scope="session")
def signals():
    """Both experiments, cut to 20 s."""
    experiments = Settings().experiments.model_dump()
    return {name: signal | {"duration_s": 20.0} for name, signal in experiments.items()}


@pytest.fixture(scope="session")
def recorded(signals):
    """Channels of both experiments on the default rig. Read only."""
    settings = Settings().model_dump()
    channels = {
        name: acquire(name, signal, settings["control"], settings["rig"], seed=1)
        for name, signal in signals.items()
    }
    for values in (array for log in channels.values() for array in log.values()):
        values.setflags(write=False)
    return channels


@pytest.fixture(scope="session")
def seen(recorded):
    """Both experiments as the models see them, P_exp as it was measured. Read only."""
    names = ("time_s", "theta_deg", "p_o_kpa")
    return {
        name: {each: log[each] for each in names} | {"p_target_kpa": log["p_exp_kpa"]}
        for name, log in recorded.items()
    }


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
        told = {
            "experiment": "track_sweep_pd_printed",
            "controller": "pd",
            "gain": "printed",
            "reference": "sweep",
            "settle_s": 1.0,
        }
        run = {"theta_d_deg": channels["theta_deg"] + 1.0}
        run |= dict.fromkeys(("p_ff_kpa", "p_fb_kpa"), np.zeros(400))
        return write_log(name, run | (changed or {}), **told | attributes)

    return write


@pytest.fixture
def changed(channels):
    """Return a copy of one channel of ``channels`` with some samples replaced."""

    def change(name, samples, value):
        values = np.array(channels[name])
        values[samples] = value
        return {name: values}

    return change
