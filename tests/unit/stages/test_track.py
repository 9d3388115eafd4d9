import json
from types import SimpleNamespace
from unittest.mock import Mock

import h5py
import numpy as np
import pytest

from fprc.channels import needed_by
from fprc.config import Settings
from fprc.control import RunAbortedError
from fprc.devices.sim import SimulatedRig
from fprc.errors import ControlError
from fprc.logs import assess, read_columns
from fprc.models import load_model
from fprc.paper import CONTROLLERS
from fprc.stages.track import track

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
    paths = [str(folder / f"{name}.h5") for name in controllers]
    chosen = {"reference": reference, "controllers": controllers, "seed": 1} | settings | more
    track([model], paths, names=["fprc"], **chosen)
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
        assert (found["source"], found["simulated"]) == ("sim", True)
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


def test_only_the_disturbance_is_pushed(tmp_path, fprc_file, settings):
    strong = settings | {"tracking": settings["tracking"] | {"pushes": {
        "quiet_s": 1.0, "every_s": 0.2, "sigma_kpa": 150.0}}}  # fmt: skip
    none = settings | {"tracking": settings["tracking"] | {"pushes": {
        "quiet_s": 1.0, "every_s": 0.2, "sigma_kpa": 0.0}}}  # fmt: skip
    for reference, differs in (("disturbance", True), ("sine_0p2", False)):
        phi = []
        for chosen in (strong, none):
            log = follow(tmp_path, fprc_file, chosen, ("fprc",), reference)["fprc"]
            phi.append(log.channels["phi_deg"])
        np.testing.assert_array_equal(phi[0][:200], phi[1][:200])
        assert (np.abs(phi[0] - phi[1]).max() > 1.0) == differs


@pytest.fixture
def made_safe(monkeypatch):
    """Voltages on the valves of each rig that was made safe."""
    seen = []
    safe = SimulatedRig.safe

    def spy(self):
        safe(self)
        seen.append(self._valve_v.tolist())

    monkeypatch.setattr(SimulatedRig, "safe", spy)
    return seen


@pytest.mark.parametrize("at", [0, 50])
def test_aborted_run_keeps_its_rows_and_says_why(
    at, tmp_path, fprc_file, settings, monkeypatch, made_safe
):
    step = Mock(side_effect=[100.0] * at + [float("nan")])
    broken = SimpleNamespace(n_features_in_=2, reset=lambda: None, step=step)
    monkeypatch.setattr("fprc.stages.track.load_model", lambda path, classes: broken)
    with pytest.raises(RunAbortedError, match=f"sample {at}: the controller gave P_ff = nan"):
        follow(tmp_path, fprc_file, settings, ("pd", "fprc", "fprc_pd"))
    assert made_safe == [[0.0, 0.0]] * 2
    assert sorted(p.name for p in tmp_path.iterdir()) == ["fprc.aborted.h5", "pd.h5"]
    kept = read_columns(tmp_path / "fprc.aborted.h5", NAMES if at else ())
    reason = kept.attributes["incomplete_reason"]
    assert f"sample {at}:" in reason
    limits = Settings().quality.model_dump()
    if at:
        check = assess(kept, sample_rate_hz=200.0, **limits)["checks"]["complete"]
        assert (check["passed"], check["reason"]) == (False, reason)
    assert kept.attributes["controller"] == "fprc"
    with h5py.File(tmp_path / "fprc.aborted.h5") as file:
        assert {len(file[name]) for name in NAMES} == {at}
    if at:
        np.testing.assert_array_equal(kept.channels["p_ff_kpa"], 100.0)


def test_impossible_reference_is_refused_before_the_rig_moves(
    tmp_path, fprc_file, settings, monkeypatch
):
    monkeypatch.setattr("fprc.experiments.tracking.SimulatedRig", None)
    narrow = settings | {"tracking": settings["tracking"] | {"angle_range_deg": (0.0, 50.0)}}
    with pytest.raises(ControlError, match="leaves the actuator's range of 0 to 50 deg"):
        follow(tmp_path, fprc_file, narrow)
    assert list(tmp_path.iterdir()) == []
