import json
from dataclasses import asdict
from pathlib import Path

import pytest
import yaml

from fprc.artifacts import read_json
from fprc.cli import main
from fprc.commands import calibrate as command
from fprc.config import PUBLISHED, check, from_files, rig_file
from fprc.config.reference import RIG
from fprc.config.rig import Rig
from fprc.yaml_file import read_yaml

CONFIG = Path(__file__).parents[3] / "config"
FILES = [str(CONFIG / name) for name in ("config.yaml", "smoke.yaml")]


#: What is known of a fit.
SUMMARY = {
    "date": "2030-01-02", "software": "fprc 9.8.7", "fit": ["tables"], "seeds": [21],
    "full_seeds": [41], "printed": {}, "residuals": {}, "median_deviation": 0.05,
    "largest_deviation": 0.2, "loss_at_start": 1.0, "evaluations": 9, "parameters": [],
}  # fmt: skip


@pytest.fixture
def fit(monkeypatch):
    """Replace the fit by one that ends at once; ``fit.calls`` are its arguments."""

    def fit_rig(printed, on_rig, **settings):
        fit_rig.calls.append({"printed": printed, "on_rig": asdict(on_rig)} | settings)
        return Rig(drift={"time_s": 3.5}).model_dump(mode="json"), SUMMARY

    fit_rig.calls = []
    monkeypatch.setattr(command, "fit_rig", fit_rig)
    monkeypatch.setattr(command, "fingerprint", lambda *modules: f"code of {modules}")
    return fit_rig


@pytest.fixture
def run(tmp_path, fit):
    """Call the command; return its exit code and the arguments of the fit."""

    def call(*arguments, files=FILES, out="rig.fitted.yaml"):
        fixed = ["--out", str(tmp_path / out), "--published", str(PUBLISHED)]
        return main(["calibrate", *files, *fixed, *arguments]), fit.calls

    return call


def test_fit_is_written_where_it_is_asked_for(run, tmp_path, capsys):
    code, (call,) = run(out="mine.yaml")
    assert code == 0
    assert sorted(path.name for path in tmp_path.iterdir()) == ["mine.json", "mine.yaml"]
    written = yaml.safe_load((tmp_path / "mine.yaml").read_text(encoding="utf-8"))
    assert check(written).rig.drift.time_s == 3.5
    assert read_json(tmp_path / "mine.json") == SUMMARY
    assert call["checkpoint"] == str(tmp_path / "mine.partial.jsonl")
    assert "mine.yaml" in capsys.readouterr().err


def test_fit_takes_its_settings_from_the_files_merged_in_their_order(run, tmp_path):
    mine = tmp_path / "mine.yaml"
    mine.write_text("calibration: {seeds: [5, 6]}\nrig: {drift: {time_s: 2.5}}\n")
    _, (call,) = run(files=[*FILES, str(mine)])
    expected = check(
        {
            "calibration": {
                "seeds": [5, 6],
                "full_seeds": [41],
                "taps": [1, 3],
                "passes": 1,
                "rounds": 1,
                "first": {"fit": [], "rounds": 1},
            }
        }
    ).model_dump(mode="json")
    assert call["calibration"] == expected["calibration"]
    on_rig, judgement = call["on_rig"], call["judgement"]
    assert on_rig["signals"]["sweep"]["duration_s"] == 20.0
    assert judgement["models"]["esn"]["r"] == 60
    assert on_rig["rig"]["drift"]["time_s"] == 2.5
    fitted = yaml.safe_load(rig_file(RIG).read_text(encoding="utf-8"))["rig"]
    assert on_rig["rig"]["bending"]["preload_kpa"] == fitted["bending"]["preload_kpa"]
    assert (judgement["folds"], judgement["split"]) == (5, "shuffled")
    assert (on_rig["target"], on_rig["control"]) == ("command", expected["control"])
    smoke = from_files(FILES).model_dump(mode="json")
    assert (call["grids"], call["tracking"]) == (smoke["grids"], smoke["tracking"])
    assert call["tracking"]["references"]["sweep"]["duration_s"] == 4.0
    assert json.dumps(call)  # plain values, as the key of the checkpoint needs them


def test_without_files_the_configuration_of_the_project_is_taken(fit, tmp_path, monkeypatch):
    (tmp_path / "config").symlink_to(CONFIG)
    out = tmp_path / "out.yaml"
    monkeypatch.chdir(tmp_path)
    assert main(["calibrate", "--out", str(out)]) == 0
    (call,) = fit.calls
    assert call["printed"] == read_yaml(PUBLISHED)
    expected = from_files(["config/config.yaml"]).model_dump(mode="json")
    assert call["on_rig"]["rig"] == expected["rig"]
    began = expected["fitted"]
    noted = read_yaml(out)["fitted"]
    assert noted["start"] == list(dict.fromkeys([*began["to"], *began["start"]])) != began["to"]
    assert noted["seeds"] == sorted({*began["seeds"], 21, 41})
    assert call["judgement"]["models"] == expected["models"]


def test_report_that_no_fit_wrote_is_kept(run, tmp_path, capsys):
    (tmp_path / "mine.json").write_text("{}")
    assert run(out="mine.yaml") == (1, [])
    assert "mine.json: exists and was not made by this command" in capsys.readouterr().err
    assert (tmp_path / "mine.json").read_text() == "{}"


def test_models_that_learn_while_they_run_are_not_fitted_to_print(tmp_path, capsys):
    (tmp_path / "mine.yaml").write_text("control: {feedforward: {adapt: true}}\n")
    out = tmp_path / "fitted.yaml"
    assert main(["calibrate", *FILES, str(tmp_path / "mine.yaml"), "--out", str(out)]) == 1
    assert "control.feedforward.adapt" in capsys.readouterr().err
    assert [path.name for path in tmp_path.iterdir()] == ["mine.yaml"]
