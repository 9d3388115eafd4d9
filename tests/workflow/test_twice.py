"""A second cold build: one core, another folder, time zone, locale and hash seed."""

import json
import math
import shutil
import time

import h5py
import numpy as np
import pandas as pd
import pytest
from PIL import Image

from fprc.fingerprint import _closure
from fprc.provenance import write_digests
from tools import twice

pytestmark = pytest.mark.slow


def test_second_build_gives_the_same_bytes(smoked, rebuilt):
    first, second = (project.folder / "results/smoke" for project in (smoked[0], rebuilt[0]))
    before = {name: path.read_bytes() for name, path in twice.files(second).items()}
    twice.give_measurements(first, second)
    done = rebuilt[0].smoke("all")
    assert done.returncode == 0, done.stdout
    ours, theirs = twice.files(first), twice.files(second)
    after = {name: path.read_bytes() for name, path in theirs.items()}
    assert before != after, "times that were measured anew were the same"
    assert twice.differences(ours, theirs) == []
    assert {"report.html", "claims.json", "figures/fig10_settings.pdf"} <= ours.keys()


def test_every_module_that_ran_is_in_the_fingerprint_of_its_rule(rebuilt):
    asked, ran = {}, {}
    for path in rebuilt[1].glob("*.txt"):
        for line in path.read_text(encoding="utf-8").splitlines():
            kind, rule, what = line.split(" ", 2)
            if kind == "asked":
                asked[rule] = json.loads(what)
            else:
                ran.setdefault(rule, set()).add(what)
    assert len(ran) >= 15
    missing = {(rule, *asked[rule]): names - _closure(asked[rule]) for rule, names in ran.items()}
    assert {rule: names for rule, names in missing.items() if names} == {}


@pytest.fixture
def written(tmp_path):
    """Write one result of each kind into a folder; numbers times ``factor``."""

    def write(name, factor=1.0, **texts):
        folder = tmp_path / name
        for part in ("predictions", "tables", "replicates/command", "figures", "timing"):
            (folder / part).mkdir(parents=True, exist_ok=True)
        with h5py.File(folder / "predictions/sweep_esn_test.h5", "w") as file:
            file["p_ff_kpa"] = np.array([1e-9, 100.0, np.nan]) * factor
            file["count"] = np.arange(3)
        table = {"model": ["ESN", texts.get("model", "FPRC")], "rmse_kpa": [10.0, 20 * factor]}
        pd.DataFrame(table).to_csv(folder / "tables/table2.csv", index=False)
        control = {"seed": 1, "runs": [{"rmse_deg": [0.5, 4.0 * factor], "reference": "sine"}]}
        (folder / "replicates/command/control_101.json").write_text(json.dumps(control))
        (folder / "claims.json").write_text(json.dumps({"verdict": texts.get("verdict", "yes")}))
        pixels = np.zeros((30, 40), np.uint8)
        pixels[: texts.get("rows", 0)] = 200
        Image.fromarray(pixels).save(folder / "figures/fig01.png")
        # the JSON beside a picture has hashes and is not compared
        (folder / "figures/fig01.json").write_text(json.dumps({"commit": texts.get("commit", "a")}))
        for name in ("times", "times_over_n_c", "steps"):
            (folder / f"timing/{name}.json").write_text(str(time.monotonic()))
            write_digests([str(folder / f"timing/{name}.json")], folder)
        return folder

    return write


def test_builds_are_compared_by_their_numbers(written):
    first = twice.files(written("one"))
    shown, largest = twice.digits(first, twice.files(written("two", 1 + 1e-6, commit="b")))
    assert largest == pytest.approx(1e-6)
    apart = [line.split()[-1] for line in shown.splitlines()[2:]]
    assert apart == ["0.0e+00", "0.0e+00", "1.0e-06", "1.0e-06", "1.0e-06"]
    same = [line.split()[-2] for line in shown.splitlines()[2:]]
    assert same == ["1", "1", "0", "0", "0"]
    assert twice.digits(first, first)[1] == 0.0


@pytest.mark.parametrize("change", [{"verdict": "no"}, {"model": "other"}, {"factor": np.nan}])
def test_other_results_are_infinitely_apart(written, change):
    first, second = written("one"), written("two", **change)
    assert twice.digits(*map(twice.files, (first, second)))[1] == math.inf


@pytest.mark.parametrize(
    ("arguments", "factor", "code"),
    [
        (["--smoke"], 1.0, 0),
        (["--smoke"], 1 + 1e-9, 1),
        (["--smoke", "--processors"], 1 + 1e-9, 0),
        (["--smoke", "--processors"], 1.1, 1),
    ],
)
def test_exit_code_says_whether_builds_agree(written, monkeypatch, arguments, factor, code):
    begun = []

    def build(folder, circumstances, *options):
        assert options == ("--configfile", "config/smoke.yaml")
        assert (folder / "workflow/Snakefile").exists()
        if folder not in begun:
            begun.append(folder)
            found = written(f"build {len(begun)}", factor if len(begun) == 2 else 1.0)
            shutil.copytree(found, folder / "results/smoke")

    monkeypatch.setattr(twice, "build", build)
    monkeypatch.setattr("sys.argv", ["twice.py", *arguments])
    assert twice.main() == code
    assert len(begun) == (3 if "--processors" in arguments else 2)
