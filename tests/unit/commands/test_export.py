import hashlib
import importlib
import json
import re
import shutil
import subprocess
from pathlib import Path

import numpy as np
import pytest

from fprc.cli import main
from fprc.models import FPRC, save_model

pytestmark = pytest.mark.slow

DOCS = Path(__file__).parents[3] / "docs"

#: What the example of docs/deploy.md takes from Arduino.
ARDUINO = """
#include <math.h>
#include <stdint.h>
#define PI 3.1415926535897932
#define constrain(x, low, high) ((x) < (low) ? (low) : (x) > (high) ? (high) : (x))
enum { A0 };
int analogRead(int pin);
void analogWrite(int pin, int value);
unsigned long micros();
"""


@pytest.fixture
def model(tmp_path):
    X = np.random.default_rng(1).normal(100.0, 10.0, (200, 2))
    path = tmp_path / "model.h5"
    save_model(FPRC(n_c=2, random_state=1).fit(X, X[:, 0]), path)
    return path


@pytest.fixture
def header(tmp_path):
    return tmp_path / "fprc_model.h"


def test_header_names_its_model_file(model, header):
    assert main(["export", str(model), "--c", str(header)]) == 0
    text = header.read_text()
    assert hashlib.sha256(model.read_bytes()).hexdigest() in text
    assert "typedef double fprc_model_real;" in text


@pytest.mark.parametrize("precision", [[], ["-DFPRC_MODEL_FLOAT"]], ids=["double", "float"])
def test_documented_program_compiles(precision, model, header, tmp_path):
    if shutil.which("c++") is None:
        pytest.skip("no C++ compiler, c++")
    blocks = re.findall(r"```cpp\n(.*?)```", (DOCS / "deploy.md").read_text(), re.DOTALL)
    (program,) = [block for block in blocks if "setup()" in block]
    (tmp_path / "program.cpp").write_text(ARDUINO + program)
    main(["export", str(model), "--c", str(header)])
    command = ["c++", "-std=c++11", "-Wall", "-Wextra", "-Werror", "-I.", "-fsyntax-only"]
    subprocess.run([*command, *precision, "program.cpp"], cwd=tmp_path, check=True)


def test_class_of_your_own_is_exported_with_its_configuration(
    header, tmp_path, monkeypatch, capsys
):
    page = (DOCS / "extending.md").read_text(encoding="utf-8")
    (tmp_path / "mine_to_export.py").write_text(re.search(r"```python\n(.*?)```", page, re.S)[1])
    others = {"mine": {"estimator": "mine_to_export.RidgeOnTaps", "inputs": ["theta_deg"]}}
    (tmp_path / "mine.yaml").write_text(json.dumps({"models": {"others": others}}))
    monkeypatch.chdir(tmp_path)
    monkeypatch.syspath_prepend(tmp_path)
    cls = importlib.import_module("mine_to_export").RidgeOnTaps
    X = np.random.default_rng(1).normal(100.0, 10.0, (200, 1))
    save_model(cls().fit(X, X[:, 0]), "mine.h5", [cls])
    assert main(["export", "mine.h5", "--c", str(header)]) == 1
    assert "--config" in capsys.readouterr().err
    assert main(["export", "mine.h5", "--c", str(header), "--config", "mine.yaml"]) == 0
    assert "fprc_model_step" in header.read_text()
    for given, wrong in (([], "--config"), (["--config", "mine.yaml"], "none.h5")):
        assert main(["predict", "mine.h5", "none.h5", *given, "--out", "p.csv"]) == 1
        assert wrong in capsys.readouterr().err


@pytest.mark.parametrize(("trained", "rate_hz"), [(False, 200.0), (True, 100.0)])
def test_model_that_learns_needs_its_training_and_its_rate(
    trained, rate_hz, header, tmp_path, monkeypatch, capsys
):
    monkeypatch.chdir(tmp_path)
    X = np.random.default_rng(1).normal(100.0, 10.0, (200, 2))
    model = FPRC(n_c=2, random_state=1).fit(X, X[:, 0])
    if trained:
        model.remember(X)
    model.sample_rate_hz_ = rate_hz
    save_model(model, "mine.h5")
    command = ["export", "mine.h5", "--c", str(header), "--learn"]
    assert main(command) == 1
    assert ("100 Hz" if trained else "mine.h5") in capsys.readouterr().err
    assert not header.exists()
    own = "control: {sample_rate_hz: 100, feedforward: {kpa_per_deg: 3.25}}"
    (tmp_path / "mine.yaml").write_text(own)
    if trained:
        assert main([*command, "--config", "mine.yaml"]) == 0
        assert "#define FPRC_MODEL_LEARNS" in header.read_text()
        assert "fprc_model_kpa_per_deg = 3.25;" in header.read_text()
