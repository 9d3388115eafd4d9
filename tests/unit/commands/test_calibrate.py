import json
from pathlib import Path

import pytest
import yaml
from joblib import cpu_count

from fprc.artifacts import write_json
from fprc.cli import main
from fprc.commands import calibrate as command
from fprc.config import PUBLISHED, Settings, check, from_files, rig_file
from fprc.config.reference import RIG
from fprc.errors import SimulationError
from fprc.studies.calibration.rig_file import WRITTEN

CONFIG = Path(__file__).parents[3] / "config"
FILES = [str(CONFIG / name) for name in ("config.yaml", "smoke.yaml")]


@pytest.fixture(autouse=True)
def at_home(monkeypatch):
    """The working directory of the project, below which its rigs are."""
    monkeypatch.chdir(CONFIG.parent)


@pytest.fixture
def fit(monkeypatch):
    """Replace the fit by one that writes its files at once; ``fit.calls`` are its arguments."""

    def calibrate(published, fitted, report, **settings):
        files = {"published": published, "fitted": fitted, "report": report}
        calibrate.calls.append(files | settings)
        if calibrate.failure is not None:
            raise calibrate.failure
        Path(fitted).write_text(f"# {WRITTEN}\nrig: {{drift: {{time_s: 3.5}}}}\n", encoding="utf-8")
        write_json(report, {"fit": [], "check_loss": 1.0})

    calibrate.calls, calibrate.failure = [], None
    monkeypatch.setattr(command, "calibrate", calibrate)
    monkeypatch.setattr(command, "fingerprint", lambda *modules: f"code of {modules}")
    return calibrate


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
    assert call["report"] == str(tmp_path / "mine.json")
    assert call["checkpoint"] == str(tmp_path / "mine.partial.jsonl")
    assert capsys.readouterr().err == ""


def test_fit_takes_its_settings_from_the_files_merged_in_their_order(run, tmp_path):
    mine = tmp_path / "mine.yaml"
    mine.write_text("calibration: {seeds: [5, 6]}\nrig: {drift: {time_s: 2.5}}\n")
    _, (call,) = run(files=[*FILES, str(mine)])
    expected = check(
        {
            "calibration": {
                "seeds": [5, 6],
                "taps": [1, 3],
                "generations": [1],
                "first": {"generations": 1},
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
    assert call["tracking"]["references"]["sweep"]["duration_s"] == 8.0
    assert json.dumps(call)  # plain values, as the key of the checkpoint needs them


def test_without_files_the_configuration_of_the_project_is_taken(fit, tmp_path, monkeypatch):
    (tmp_path / "config").symlink_to(CONFIG)
    out = tmp_path / "out.yaml"
    monkeypatch.chdir(tmp_path)
    assert main(["calibrate", "--out", str(out)]) == 0
    (call,) = fit.calls
    assert call["published"] == str(PUBLISHED)
    expected = from_files(["config/config.yaml"]).model_dump(mode="json")
    assert call["on_rig"]["rig"] == expected["rig"]
    assert call["judgement"]["models"] == expected["models"]


@pytest.mark.parametrize(("arguments", "minutes"), [([], 120.0), (["--minutes", "2.5"], 2.5)])
def test_time_limit_is_that_of_the_command_or_else_of_the_configuration(run, arguments, minutes):
    _, (call,) = run(*arguments)
    assert call["calibration"]["minutes"] == minutes


def test_processes_are_as_many_as_asked_for_or_else_one_a_processor(run):
    run()
    _, (default, asked) = run("--workers", "3")
    assert default["workers"] == cpu_count()
    assert asked["workers"] == 3


@pytest.mark.parametrize("minutes", ["0", "-1", "nan"])
def test_time_limit_that_is_not_above_0_is_an_error(run, capsys, minutes):
    code, calls = run(f"--minutes={minutes}")
    assert (code, calls) == (1, [])
    assert f"calibration.minutes = {float(minutes)}: must be" in capsys.readouterr().err


@pytest.mark.parametrize(
    "arguments", [["--minutes", "soon"], ["--workers", "two"], ["--minutes"], ["--nonsense"]]
)
def test_argument_that_makes_no_sense_is_answered_with_the_usage(run, fit, capsys, arguments):
    with pytest.raises(SystemExit) as caught:
        run(*arguments)
    assert caught.value.code == 2
    assert "usage: fprc" in capsys.readouterr().err
    assert fit.calls == []


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("calibration: {stride: 0}\nrig: {drift: {time_s: 0.5}}", "2 errors"),
        ("calibration: {genrations: [3]}", "did you mean calibration.generations?"),
        ("- a list", "must hold keys and values"),
        ("rig: [", "cannot be read as YAML"),
    ],
)
def test_errors_of_the_configuration_go_to_stderr_without_a_traceback(
    run, tmp_path, capsys, text, message
):
    path = tmp_path / "mine.yaml"
    path.write_text(text)
    code, calls = run(files=[*FILES, str(path)])
    assert (code, calls) == (1, [])
    streams = capsys.readouterr()
    assert streams.out == ""
    assert streams.err.startswith("error: ")
    assert message in streams.err
    assert "Traceback" not in streams.err


def test_absent_configuration_is_an_error(run, tmp_path, capsys):
    code, calls = run(files=[str(tmp_path / "none.yaml")])
    assert (code, calls) == (1, [])
    assert str(tmp_path / "none.yaml") in capsys.readouterr().err


def test_failure_of_the_fit_is_reported_without_a_traceback(run, fit, capsys):
    fit.failure = SimulationError("the bending angle left its physical range")
    assert run()[0] == 1
    assert capsys.readouterr().err == "error: the bending angle left its physical range\n"


def test_paths_that_are_no_parameters_are_reported_together(run, tmp_path, capsys):
    path = tmp_path / "mine.yaml"
    free = [*Settings().calibration.ranges, "a.b", "c.d"]
    path.write_text(f"calibration: {{free: {json.dumps(free)}}}\n")
    code, calls = run(files=[*FILES, str(path)])
    assert (code, calls) == (1, [])
    printed = capsys.readouterr().err
    assert "calibration.free: a.b is not a number of the rig" in printed
    assert "calibration.free: c.d " in printed


def test_absent_published_numbers_are_an_error(tmp_path, capsys, monkeypatch):
    monkeypatch.setattr(command, "fingerprint", lambda *modules: "")
    published = str(tmp_path / "none.yaml")
    arguments = ["--out", str(tmp_path / "out.yaml"), "--published", published]
    assert main(["calibrate", *FILES, *arguments]) == 1
    assert published in capsys.readouterr().err


def test_fit_that_is_stopped_by_hand_says_that_it_can_go_on(run, fit, capsys):
    fit.failure = KeyboardInterrupt()
    assert run()[0] == 130
    assert capsys.readouterr().err == "stopped; finished results are kept\n"


def test_library_that_is_not_installed_is_named_with_the_remedy(run, fit, capsys):
    fit.failure = ModuleNotFoundError("No module named 'joblib'")
    assert run()[0] == 1
    printed = capsys.readouterr().err
    assert "No module named 'joblib'" in printed
    assert "fprc[workflow]" in printed


@pytest.mark.parametrize("name", ["rig.json", "rig", "rig.yml", "my rig.yaml", ".yaml", "a:b.yaml"])
def test_parameter_file_that_cannot_name_a_rig_is_an_error(run, capsys, name):
    """The report beside it has the same name, and the configuration names the rig by it."""
    assert run(out=name) == (1, [])
    assert name in capsys.readouterr().err


@pytest.mark.parametrize("name", ["dry.yaml", "my-rig_2.0.yaml"])
def test_name_of_the_parameter_file_is_one_that_a_configuration_takes(run, name):
    assert run(out=name)[0] == 0
    assert check({"fitted": {"name": Path(name).stem}})


@pytest.mark.parametrize("workers", ["0", "-1", "1001", "9" * 400])
def test_number_of_processes_that_no_computer_runs_is_an_error(run, workers):
    code, calls = run(f"--workers={workers}")
    assert (code, calls) == (1, [])


@pytest.mark.parametrize("minutes", ["1e-6", "1e9"])
def test_time_limit_outside_of_that_of_the_configuration_is_an_error(run, minutes):
    code, calls = run(f"--minutes={minutes}")
    assert (code, calls) == (1, [])


@pytest.mark.parametrize("name", ["mine.yaml", "mine.json"])
def test_file_that_no_fit_wrote_is_kept(run, tmp_path, capsys, name):
    (tmp_path / name).write_text("seed: 1\n")
    code, calls = run(out="mine.yaml")
    assert (code, calls) == (1, [])
    assert f"{name}: exists and was not made by this command" in capsys.readouterr().err
    assert (tmp_path / name).read_text() == "seed: 1\n"
