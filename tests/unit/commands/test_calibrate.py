from pathlib import Path

import pytest

from fprc.cli import main
from fprc.commands import calibrate as command
from fprc.config import PUBLISHED, from_files
from fprc.given import read_yaml

CONFIG = Path(__file__).parents[3] / "config"
FILES = [str(CONFIG / name) for name in ("config.yaml", "smoke.yaml")]


@pytest.fixture
def fit(monkeypatch):
    """Replace the fit by one that ends at once; ``fit.calls`` are its arguments."""

    class Fit:
        calls: list = []

        def __init__(self, printed, on_rig, calibration, pool, **settings):
            found = {"printed": printed, "on_rig": on_rig.model_dump(mode="json")}
            self.calls.append(found | {"calibration": calibration, **settings})

        def rig_file(self, name):
            return f"rig: {{drift: {{time_s: 3.5}}, name: {name}}}"

    monkeypatch.setattr(command, "Fit", Fit)
    return Fit


def test_fit_is_written_where_it_is_asked_for_with_settings_of_the_merged_files(
    fit, tmp_path, capsys
):
    mine = tmp_path / "mine.yaml"
    mine.write_text("calibration: {seed: 5}\nmodels: {n_y: 4}\n")
    out = tmp_path / "out.yaml"
    assert main(["calibrate", *FILES, str(mine), "--out", str(out)]) == 0
    (call,) = fit.calls
    smoke = from_files([*FILES, mine]).model_dump(mode="json")
    assert (call["calibration"], call["tracking"]) == (smoke["calibration"], smoke["tracking"])
    assert (call["calibration"]["seed"], call["calibration"]["members"]) == (5, 4)
    assert call["on_rig"]["signals"] == smoke["experiments"]
    assert call["validation"]["models"]["n_y"] == 4
    assert call["printed"] == read_yaml(PUBLISHED)
    assert sorted(path.name for path in tmp_path.iterdir()) == ["mine.yaml", "out.yaml"]
    assert read_yaml(out)["rig"] == {"drift": {"time_s": 3.5}, "name": "out"}
    assert "out.yaml" in capsys.readouterr().err
