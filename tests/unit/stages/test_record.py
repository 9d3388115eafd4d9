import json

import numpy as np
import pytest
from pydantic import validate_call

from fprc.channels import needed_by
from fprc.config import Settings
from fprc.logs import read_columns
from fprc.models import load_model
from fprc.paper import CONTROLLERS, run_log
from fprc.stages.record import track

NAMES = needed_by("sim", tracking=True)


@pytest.fixture(scope="module")
def settings():
    """References cut to 3 s, half a second of which settles."""
    found = Settings().model_dump()
    for reference in found["tracking"]["references"].values():
        reference |= {"duration_s": 2.5, "settle_s": 0.5}
    found["tracking"]["pushes"] |= {"quiet_s": 1.0, "every_s": 0.2}
    return {name: found[name] for name in ("tracking", "control", "rig")}


def follow(folder, model, settings, controllers=CONTROLLERS, reference="sine_0p5", **more):
    paths = [str(folder / f"{run_log(reference, name)}.h5") for name in controllers]
    validate_call(track)([model], paths, **{"others": {}, "seed": 1} | settings | more)
    return {name: read_columns(path, NAMES) for name, path in zip(controllers, paths, strict=True)}


@pytest.fixture(scope="module")
def logs(fprc_file, settings, tmp_path_factory):
    """Logs of every controller on one reference."""
    return follow(tmp_path_factory.mktemp("raw"), fprc_file, settings)


def test_every_controller_has_its_raw_log_with_what_it_was(logs, settings):
    for name in CONTROLLERS:
        found = logs[name].attributes
        assert (found["reference"], found["controller"]) == ("sine_0p5", name)
        assert found["experiment"] == f"track_sine_0p5_{name}"
        assert found["source"] == "sim"
        assert (found["settle_s"], found["seed"], found["sample_rate_hz"]) == (0.5, 1, 200.0)
        assert "incomplete_reason" not in found
        assert found["rig"]["control"] == json.loads(json.dumps(settings["control"]))


def test_feedforward_is_the_model_on_reference_and_measured_reservoir_pressure(logs, fprc_file):
    for name in ("fprc", "fprc_pd"):
        log = logs[name].channels
        expected = load_model(fprc_file).predict(
            np.column_stack([log["theta_d_deg"], log["p_o_kpa"]])
        )
        np.testing.assert_allclose(log["p_ff_kpa"], expected, atol=1e-9)
