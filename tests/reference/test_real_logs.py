"""Two public recordings, read from a folder beside the project; skipped if they are not there."""

import importlib.util
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
import yaml

from fprc.artifacts import read_json
from fprc.cli import main
from fprc.commands.import_recording import import_or_list
from fprc.logs import read_raw
from fprc.models import RidgeReadout, lowpass, taps

ROOT = Path(__file__).parents[2]
DATASETS = ROOT.parent / "shared" / "datasets"
PNEUSIM = DATASETS / "pneusim_antagonistic_pam" / "data.mat"
BYU = DATASETS / "byu_bellows_arm" / "bellows_arm_whitened.mat"


def other(column, note, **more):
    return {"column": column, "unit": 1, "note": note, **more}


MAPS = {
    PNEUSIM: {
        "experiment": "sweep",
        "time": {"rate_hz": 1000},
        "channels": {
            "theta_deg": other("x", "displacement x [mm]", scale=1000),
            "p_exp_kpa": other("F", "motor force F [N]"),
            "p_o_kpa": {"column": "p1", "unit": "kPa"},
        },
    },
    BYU: {
        "experiment": "complex",
        "time": {"column": "t"},
        "channels": {
            "theta_deg": {"column": "q[:, 0]", "unit": "rad"},
            "p_exp_command_kpa": other("pref[:, 0]", "scaled command of joint 0"),
            "p_exp_kpa": other("pest[:, 0]", "scaled pressure of joint 0"),
            "p_o_kpa": other("pest[:, 1]", "scaled pressure of joint 1"),
        },
    },
}


@pytest.fixture(scope="module")
def recordings():
    """The module that writes the table of recordings in docs/chamber.md."""
    spec = importlib.util.spec_from_file_location("recordings", ROOT / "tools/recordings.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


@pytest.fixture(scope="module")
def imported(tmp_path_factory):
    """Import a recording, or skip; return the raw log and its diagnosis."""
    done = {}

    def get(source):
        if not source.exists():
            pytest.skip(
                f"{source.parent.name} is not in a folder shared/datasets beside the project"
            )
        if source not in done:
            folder = tmp_path_factory.mktemp(source.stem)
            (folder / "map.yaml").write_text(yaml.safe_dump(MAPS[source]))
            import_or_list(str(source), map_=str(folder / "map.yaml"), out=str(folder / "log.h5"))
            log = read_raw(
                folder / "log.h5", experiment=None, sample_rate_hz=200.0, rate_tolerance=1e-6
            )
            done[source] = log, read_json(folder / "log.diagnosis.json")
        return done[source]

    return get


def rmse_of_ridge(X, y):
    """Train on the first 60 % of a run, judge on the rest."""
    split = int(0.6 * len(y))
    model = RidgeReadout(alpha=1e-3).fit(X[:split], y[:split])
    return float(np.sqrt(np.mean((model.predict(X[split:]) - y[split:]) ** 2)))


def test_force_is_predicted_as_well_as_by_others_hands(imported):
    """Five taps of x: 26.3 N; with three of the low-passed p1: 23.1 N."""
    log, _ = imported(PNEUSIM)
    theta, force, p_o = (log.channels[name] for name in ("theta_deg", "p_exp_kpa", "p_o_kpa"))
    angle = taps(theta, 5)
    assert rmse_of_ridge(angle, force) == pytest.approx(26.3, rel=0.03)
    both = np.hstack([angle, taps(lowpass(p_o, 0.01), 3)])
    assert rmse_of_ridge(both, force) == pytest.approx(23.1, rel=0.03)


def test_antagonistic_pair_is_a_clean_recording_in_newtons(imported):
    log, found = imported(PNEUSIM)
    assert len(log.channels["time_s"]) == 5606
    assert found["samples"] == 28027
    assert found["clock"]["mean_hz"] == pytest.approx(1000.0)
    assert found["clock"]["gaps"] == found["identical"] == []
    assert all(not channel["held_samples"] for channel in found["channels"].values())
    assert log.attributes["notes"]["p_exp_kpa"] == "not in kPa: motor force F [N]"
    assert log.channels["p_o_kpa"].min() == pytest.approx(359.7, abs=0.5)


def test_command_of_the_bellows_arm_moves_half_of_the_time(imported):
    log, found = imported(BYU)
    assert found["clock"]["mean_hz"] == pytest.approx(99.98, abs=0.01)
    assert len(log.channels["time_s"]) == 15653
    command = found["channels"]["p_exp_command_kpa"]
    assert command["new_values_hz"] == pytest.approx(50.7, abs=0.1)
    assert command["held_samples"] is None
    assert log.channels["theta_deg"].max() == pytest.approx(np.rad2deg(0.8372), abs=0.05)
    # another joint's pressure is no chamber that this joint squeezes
    assert found["sealed"]["slope_kpa_per_min"] is None


#: Settings that leave of the readout report what shows that it works.
FEW = {"grids": {"epsilon": [0.01], "readout_taps": [1, 3]}}


@pytest.mark.slow
@pytest.mark.filterwarnings("ignore:fuzzy c-means did not converge")
@pytest.mark.parametrize(("source", "unit"), [(PNEUSIM, "N"), (BYU, "% of its scale")])
def test_one_command_goes_from_the_file_to_a_report(source, unit, tmp_path, recordings):
    if not source.exists():
        pytest.skip(f"{source.parent.name} is not in a folder shared/datasets beside the project")
    map_file = ROOT / f"config/maps/{source.parent.name}.yaml"
    (tmp_path / "few.yaml").write_text(yaml.safe_dump(FEW))
    asked = ["readout", str(source), "--map", str(map_file), "--out", str(tmp_path / "out")]
    assert main([*asked, "--config", str(tmp_path / "few.yaml"), "--workers", "1"]) == 0
    table = pd.read_csv(tmp_path / "out/readout/readout.csv")
    assert set(table["unit"]) == {unit}
    assert len(table) == 2 * (1 + 2 * 3)
    assert f"Test [{unit}]" in (tmp_path / "out/report.md").read_text()
    if source == PNEUSIM:
        # as much as a ridge by other hands: 26.3 N without, 23.1 N with p1
        own = table[(table["split"] == "shuffled") & (table["n_u"] == 3)].set_index("readout")
        assert own.loc[["none", "p_o"], "test_rmse"].between(20.0, 32.0).all()
    name, page = source.parent.name, (ROOT / "docs/chamber.md").read_text(encoding="utf-8")
    report = read_json(tmp_path / "out/readout/competitors.json")
    assert recordings.row(f"`{name}`", report) in page.splitlines(), "make recordings"
