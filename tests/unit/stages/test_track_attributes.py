"""What the logs of simulated runs say about them."""

import hashlib
from pathlib import Path

import numpy as np
import pytest

from fprc.config import Settings
from fprc.control import RunAbortedError
from fprc.logs import assess, read_columns, read_run
from fprc.models import FPRC, FuzzyLinear, save_model
from fprc.stages.track import track


@pytest.fixture(scope="module")
def files(recorded, tmp_path_factory):
    log, folder = recorded["sweep"], tmp_path_factory.mktemp("models")
    X = np.column_stack([log["theta_deg"], log["p_o_kpa"]])
    models = {"fprc": (FPRC, X), "fuzzy_linear": (FuzzyLinear, X[:, :1])}
    for name, (cls, inputs) in models.items():
        fitted = cls(n_c=2, random_state=1).fit(inputs, log["p_exp_command_kpa"])
        save_model(fitted, folder / f"{name}.h5")
    return {name: str(folder / f"{name}.h5") for name in models}


@pytest.fixture
def follow(tmp_path):
    """Follow half a second of a sine; return the logs' attributes."""

    def follow(files, controllers):
        settings = Settings().model_dump()
        settings["tracking"]["references"]["sine_0p5"] |= {"duration_s": 0.4, "settle_s": 0.1}
        raw = [str(tmp_path / f"{controller}.h5") for controller in controllers]
        track(
            list(files.values()),
            raw,
            names=list(files),
            controllers=controllers,
            reference="sine_0p5",
            seed=1,
            **{name: settings[name] for name in ("tracking", "control", "rig")},
        )
        return [read_columns(path, ()).attributes for path in raw]

    return follow


def test_log_names_the_model_that_ran(follow, files):
    logs = follow(files, ["fprc", "fuzzy_linear_pd", "pd"])
    for log, cls, name in (
        (logs[0], "FPRC", "fprc"),
        (logs[1], "FuzzyLinear", "fuzzy_linear"),
    ):
        digest = hashlib.sha256(Path(files[name]).read_bytes()).hexdigest()
        told = [log[f"model{what}"] for what in ("", "_file", "_sha256")]
        assert told == [cls, f"{name}.h5", digest]
    assert not [name for name in logs[2] if name.startswith("model")]


class Broken(FPRC):
    """A model whose output is no number from one sample on."""

    def step(self, x):
        self.steps = getattr(self, "steps", 0) + 1
        return float("nan") if self.steps == 40 else 100.0


def test_log_of_a_run_that_stopped_is_incomplete_and_says_why(
    follow, files, tmp_path, recorded, monkeypatch
):
    log = recorded["sweep"]
    X = np.column_stack([log["theta_deg"], log["p_o_kpa"]])
    broken = Broken(n_c=2, random_state=1).fit(X, log["p_exp_command_kpa"])
    monkeypatch.setattr("fprc.stages.track.load_model", lambda path, classes: broken)
    with pytest.raises(RunAbortedError):
        follow(files, ["fprc"])
    stopped = read_run(tmp_path / "fprc.aborted.h5")
    reason = stopped.attributes["incomplete_reason"]
    assert "run stopped at sample 39: the controller gave P_ff = nan" in reason
    assert "aborted" not in stopped.attributes
    limits = Settings().quality.model_dump()
    check = assess(stopped, sample_rate_hz=200.0, **limits)["checks"]["complete"]
    assert (check["passed"], check["reason"]) == (False, reason)
