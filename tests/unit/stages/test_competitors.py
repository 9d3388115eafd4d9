"""FPRC and its competitors on a recording, from file to table."""

import numpy as np
import pytest

from fprc.artifacts import read_json
from fprc.config import Settings
from fprc.stages.competitors import compare_competitors, tabulate_competitors
from fprc.tables.text import read_markdown

pytestmark = pytest.mark.slow


@pytest.fixture(scope="module")
def logs(write_data):
    """Training data of 20 s and test data of 5 s."""
    return write_data(sweep=4000, complex=1000)


@pytest.fixture
def compare(logs, tmp_path):
    """Compare the models and return the report's path."""

    def call(nodes=5, **more):
        models = Settings().models.model_dump(mode="json")
        models["fprc"] |= {"n_c": 2}
        models["esn"] |= {"r": nodes}
        judgement = {"models": models, "folds": 5, "split": "blocked", "seed": 1, "purge_s": 0.5}
        compare_competitors(
            *logs,
            str(tmp_path / "competitors.json"),
            judgement=judgement,
            workers=1,
            checkpoint=str(tmp_path / "partial.jsonl"),
            version="v",
            **more,
        )
        return str(tmp_path / "competitors.json")

    return call


def test_stopped_comparison_goes_on_and_is_tabulated(compare, tmp_path):
    seen = []

    def stop(done, total):
        seen.append((done, total))
        if done == 4:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        compare(progress=stop)
    report = read_json(compare(progress=stop))
    assert seen == [(done, 9) for done in range(1, 10)]
    assert report["block_s"] == pytest.approx([2.0] * 10, rel=1e-3)
    # a purge of 100 samples on both sides of eight blocks, on one side of two
    assert report["overlap"] == pytest.approx(np.mean([400 / 3500] * 2 + [400 / 3400] * 8))
    assert [row["blocks"] for row in report["verdicts"]] == [10, 10, 10]
    tabulate_competitors(
        str(tmp_path / "competitors.json"), str(tmp_path / "c.csv"), str(tmp_path / "c.md")
    )
    note, page = read_markdown((tmp_path / "c.md").read_text(encoding="utf-8"))
    assert "10 blocks of 2 s of the training data" in note
    assert list(page.columns) == ["Model", "Blocks [kPa]", "Test [kPa]"]
    assert len(page) == 9
