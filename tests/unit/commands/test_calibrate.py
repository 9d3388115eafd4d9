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

    def fit_rig(printed, on_rig, calibration, **settings):
        fit_rig.calls.append(
            {"printed": printed, "on_rig": on_rig.model_dump(mode="json")}
            | {"calibration": calibration, **settings}
        )
        return "rig: {drift: {time_s: 3.5}}"

    fit_rig.calls = []
    monkeypatch.setattr(command, "fit_rig", fit_rig)
    return fit_rig


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
    assert (call["name"], read_yaml(out)) == ("out", {"rig": {"drift": {"time_s": 3.5}}})
    assert "out.yaml" in capsys.readouterr().err
