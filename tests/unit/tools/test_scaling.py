"""The measurements of `make scaling` and its page."""

import shutil
from pathlib import Path

import pytest

from fprc.artifacts import write_json
from fprc.benchmark.cost import plan_ensemble
from fprc.errors import EvaluationError
from fprc.stages.documents import update_scaling_page

ROOT = Path(__file__).parents[2]

pytestmark = pytest.mark.slow


@pytest.mark.parametrize("alone", [False, True])
def test_plan_is_of_the_whole_ensemble_or_of_one_job(monkeypatch, alone):
    monkeypatch.chdir(ROOT)
    spent = plan_ensemble(7, alone=alone)
    assert spent["jobs"] == 7
    assert spent["cpu_s"] > 0.1
    assert 20 < spent["peak_mb"] < 2000


def test_plan_that_failed_is_no_measurement(monkeypatch):
    monkeypatch.chdir(ROOT)
    with pytest.raises(EvaluationError, match="(?s)did not plan 0 of 0 jobs: .*ensemble.rigs"):
        plan_ensemble(0)


def test_page_is_written_from_the_measurements(tmp_path):
    page = tmp_path / "scaling.md"
    shutil.copy(ROOT / "docs/scaling.md", page)
    planned = [{"jobs": n, "cpu_s": n, "wall_s": n, "peak_mb": n} for n in (1, 77)]
    measured = {
        name: {"cpu_s": 1.25, "measured": 3, "bytes": 10} for name in ("rig", "cell", "loop")
    }
    scale = {"cpu": "some processor", "start": {"cpu_s": 2}, "chunk": 5} | measured
    write_json(tmp_path / "scale.json", scale | {"dag": planned, "alone": planned})
    update_scaling_page(str(tmp_path / "scale.json"), page=str(page))
    text = page.read_text()
    assert "Measured on some processor." in text
    assert "| 77" in text
    assert text.count("1.25") == 3
