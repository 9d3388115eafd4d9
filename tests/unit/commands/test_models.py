import re
import shlex
from pathlib import Path

import numpy as np
import pytest
import yaml
from pydantic import validate_call

from fprc.cli import main
from fprc.config import from_files
from fprc.logs import read_columns
from fprc.models import load_model
from fprc.models.storage import packed
from fprc.plan import validation
from fprc.stages.models import judge

pytestmark = pytest.mark.slow

FEW = {
    "experiments": {"sweep": {"duration_s": 12}, "complex": {"duration_s": 12}},
    "models": {"n_y": 2, "fprc": {"n_c": 2}, "esn": {"r": 5}},
    "evaluation": {"folds": 2},
    "seed": 3,
}


@pytest.fixture(scope="module")
def few(tmp_path_factory):
    path = tmp_path_factory.mktemp("few") / "few.yaml"
    path.write_text(yaml.safe_dump(FEW))
    return str(path)


@pytest.fixture(scope="module")
def settings(few):
    return from_files([few]).model_dump(mode="json")


@pytest.fixture(scope="module")
def by_rule(make_data, settings, tmp_path_factory):
    """Raw log and data of both experiments, as the workflow's stages write them."""
    folder = tmp_path_factory.mktemp("raw")
    return {name: make_data(folder, name, settings, 3) for name in ("sweep", "complex")}


@pytest.fixture(scope="module")
def recorded_by_rule(by_rule):
    return {name: Path(raw) for name, (raw, _) in by_rule.items()}


@pytest.fixture(scope="module")
def prepared(by_rule):
    return [data for _, data in by_rule.values()]


@pytest.fixture
def inside(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    return tmp_path


def run(*words):
    return main([str(word) for word in words])


def test_simulated_log_is_that_of_the_workflow(recorded_by_rule, few, inside):
    assert run("simulate", "complex", "--config", few, "--out", "mine.h5") == 0
    assert (inside / "mine.h5").read_bytes() == recorded_by_rule["complex"].read_bytes()


@pytest.mark.parametrize("name", ["fprc", "esn", "fuzzy_linear"])
def test_model_and_prediction_are_those_of_the_workflow(
    name, recorded_by_rule, prepared, few, settings, inside
):
    raw = recorded_by_rule
    made = [[f"{kind}{i}" for i in range(2)] for kind in ("errors", "model", "fit", "prediction")]
    validate_call(judge)(*prepared, *made, name=name, validation=validation(settings, name))

    train = ("train", raw["sweep"], "--model", name, "--config", few, "--out", "mine.h5")
    assert run(*train) == 0
    assert (inside / "mine.h5").read_bytes() == (inside / "model0").read_bytes()
    assert load_model("mine.h5").sample_rate_hz_ == pytest.approx(200.0)

    assert run("predict", "mine.h5", raw["complex"], "--config", few, "--out", "out.csv") == 0
    columns = ("time_s", "theta_deg", *["p_o_kpa"] * (name == "fprc"), "p_target_kpa", "p_ff_kpa")
    assert tuple((inside / "out.csv").read_text().split("\n", 1)[0].split(",")) == columns
    table = dict(zip(columns, np.loadtxt("out.csv", delimiter=",", skiprows=1).T, strict=True))
    theirs = read_columns("prediction0", ("time_s", "p_target_kpa", "p_ff_kpa")).channels
    for key, values in theirs.items():
        np.testing.assert_array_equal(table[key], values)


def test_logs_of_the_same_name_train_together(
    recorded_by_rule, make_data, few, settings, inside, tmp_path_factory
):
    """Neither takes the place of the other."""
    other, _ = make_data(tmp_path_factory.mktemp("other"), "sweep", settings, 4)
    logs = [recorded_by_rule["sweep"], Path(other)]
    X = np.transpose(list(read_columns(other, ("theta_deg", "p_o_kpa")).channels.values()))
    outputs = []
    for some in (logs, logs[:1], logs[1:]):
        assert run("train", *some, "--config", few, "--out", f"{len(outputs)}.h5") == 0
        outputs.append(load_model(f"{len(outputs)}.h5").predict(X))
    assert all(np.abs(outputs[0] - alone).max() > 0.1 for alone in outputs[1:])


@pytest.mark.parametrize(
    ("words", "problem"),
    [
        (["train", "LOG", "LOG", "--out", "m.h5"], "given twice"),
        (["train", "DATA", "--out", "m.h5"], "is preprocessed; give the raw log"),
        (["train", "LOG", "--model", "fpcr", "--out", "m.h5"], "use esn, fprc or fuzzy_linear"),
        (["train", "MODEL", "--out", "m.h5"], "is no raw log"),
        (["predict", "precious.h5", "LOG", "--out", "p.csv"], "precious.h5: holds no model"),
        (["predict", "LOG", "LOG", "--out", "p.csv"], "holds no model"),
        (["predict", "none.h5", "LOG", "--out", "p.txt"], "must end in .csv"),
    ],
)
def test_wrong_request_is_refused_and_leaves_no_file(
    words, problem, recorded_by_rule, prepared, inside, few, capsys
):
    (inside / "precious.h5").write_text("precious")
    Path(few).with_name("model.h5").write_bytes(packed("{}", {}))
    given = recorded_by_rule["sweep"], prepared[0], Path(few).with_name("model.h5")
    logs = dict(zip(("LOG", "DATA", "MODEL"), given, strict=True))
    assert run(*(logs.get(word, word) for word in words)) == 1
    assert problem in capsys.readouterr().err
    assert [path.name for path in inside.iterdir()] == ["precious.h5"]
    assert (inside / "precious.h5").read_text() == "precious"


def test_commands_of_the_page_print_what_it_says(tmp_path, monkeypatch, capsys):
    page = Path(__file__).parents[3] / "docs/commands.md"
    (console,) = re.findall(r"```console\n(.*?)```", page.read_text(encoding="utf-8"), re.DOTALL)
    commands = [command.partition("\n") for command in console.split("$ ")[1:]]
    assert [line.split()[1] for line, _, _ in commands] == [
        "simulate", "simulate", "log", "train", "predict", "export"
    ]  # fmt: skip
    monkeypatch.chdir(tmp_path)
    for line, _, output in commands:
        program, *words = shlex.split(line)
        assert program == "fprc"
        assert main(words) == 0
        assert capsys.readouterr().out == output
    made = {path.name for path in tmp_path.iterdir()}
    assert made == {"sweep.h5", "complex.h5", "model.h5", "predicted.csv", "fprc_model.h"}
